//! Beams with a width, against rapier's rays across the beam.

use super::caster::cluttered;
use super::oracle::{Place, uniform};
use super::*;
use interfaces::pose;
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

const WIDTH_RAD: f64 = 0.01;
/// The number of rays of the reference.
const RAYS: usize = 80;

#[test]
fn a_wide_beam_measures_the_mean_of_two_surfaces_or_what_its_middle_hits() {
    let place = Place::new(cluttered());
    let ray = LaserSpec { noise_std_m: 0.0, ..place.spec.robots[0].laser };
    let wide = LaserSpec { beam_width_rad: WIDTH_RAD, ..ray };
    let mut stream = ChaCha8Rng::seed_from_u64(8);
    let (mut beams, mut veils) = (0, 0);
    while beams < 100_000 {
        let at = Point2::new(uniform(&mut stream, 0.1..11.9), uniform(&mut stream, 0.1..11.9));
        if !place.is_free(&at, 0) {
            continue;
        }
        let at = pose(at.x, at.y, uniform(&mut stream, -4.0..4.0));
        let [rays, mixed] = [&ray, &wide].map(|laser| place.scan(laser, &at));
        for (beam, (middle_m, range_m)) in rays.ranges_m.iter().zip(&mixed.ranges_m).enumerate() {
            beams += 1;
            let angle_rad =
                |ray: usize| WIDTH_RAD * ((ray as f64 + 0.5) / RAYS as f64 - 0.5) + rays.angle_rad(beam);
            let across: Vec<f64> = (0..RAYS).map(|ray| place.rapier_m(&at, angle_rad(ray))).collect();
            let (near_m, far_m) = (
                across.iter().fold(f64::INFINITY, |a, b| a.min(*b)),
                across.iter().fold(0.0, |a: f64, b| a.max(*b)),
            );
            if far_m == f64::INFINITY {
                continue; // One of the eight rays can go there, or none.
            }
            if far_m - near_m < 0.3 {
                // One surface, or a small step: the mean across it. The largest difference of these 100,000 beams is 0.062 m.
                assert!((range_m - middle_m).abs() < 0.07, "{range_m} {middle_m}");
                continue;
            }
            let mean_m = across.iter().sum::<f64>() / RAYS as f64;
            let share = across.iter().filter(|range_m| **range_m < (near_m + far_m) / 2.0).count() as f64
                / RAYS as f64;
            let error_m = (f64::from(*range_m) - mean_m).abs();
            // Eight rays know a share to an eighth.
            match share {
                0.37..0.63 => assert!(error_m < (far_m - near_m) / 7.0, "{share} {range_m} {mean_m}"),
                0.13..0.87 => {}
                // At most one of the eight rays hits the other side. If none does, and the side of the middle has a step of
                // its own, the range is the mean across that step: at most 0.26 of the step off, and 0.18 m in these
                // 100,000 beams (1 of 80 rays ends at 2.30 m, the others at 5.7 to 6.5 m). Equal to the range of the
                // middle, as this test had it once, the range need not be.
                _ => {
                    let is_near = |range_m: f64| range_m < (near_m + far_m) / 2.0;
                    let is_beside = |range_m: &&f64| is_near(**range_m) == is_near(f64::from(*middle_m));
                    let (low_m, high_m) =
                        across.iter().filter(is_beside).fold((far_m, near_m), |(low_m, high_m), range_m| {
                            (low_m.min(*range_m), high_m.max(*range_m))
                        });
                    let off_m = f64::from((range_m - middle_m).abs());
                    assert!(off_m <= 0.27 * (high_m - low_m) + 1e-6, "{share}: {range_m} {middle_m}");
                }
            }
            veils += usize::from(range_m != middle_m);
        }
    }
    assert!(veils > 500, "{veils} veils");
}
