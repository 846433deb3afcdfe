use super::*;
use interfaces::{Purpose, RandomStream};
use std::f64::consts::TAU;

const NOISE_M: f64 = 0.01;

/// A reading of 360 beams all around.
fn reading(range_m: impl FnMut(f64) -> f64) -> LaserReading {
    let angles = (0..360).map(|beam| -TAU / 2.0 + TAU / 360.0 * f64::from(beam));
    LaserReading {
        scan: Scan {
            angle_min_rad: -TAU / 2.0,
            angle_increment_rad: TAU / 360.0,
            range_min_m: 0.1,
            range_max_m: 10.0,
            ranges_m: angles.map(range_m).map(|range_m| range_m as f32).collect(),
            ..Scan::default()
        },
        ..LaserReading::default()
    }
}

fn points(reading: &LaserReading, grazing: bool) -> Vec<ScanPoint> {
    ScanPoints::default().of(reading, |_| 1.0, &PointRules { noise_m: NOISE_M, grazing })
}

#[test]
fn beams_along_a_corridor_lie_on_its_walls() {
    let (half_m, mut noise) = (0.7, RandomStream::new(300, Purpose::LaserNoise(0)));
    let corridor = reading(|angle: f64| half_m / angle.sin().abs() + NOISE_M * noise.normal());
    let far = |grazing| points(&corridor, grazing).into_iter().filter(|point| point.at.x.abs() > 3.0);
    assert_eq!(far(false).count(), 0);
    let far: Vec<ScanPoint> = far(true).collect();
    assert!(far.len() >= 20, "{}", far.len());
    for point in far {
        let wall_m = -half_m * point.normal.y.signum();
        let incidence = half_m / point.at.coords.norm();
        assert!((point.noise_share - incidence).abs() < 0.02, "{point:?}");
        assert!((point.at.y - wall_m).abs() < 5.0 * NOISE_M * point.noise_share, "{point:?}");
        assert!(point.normal.x.abs() < 0.03, "{point:?}");
    }
}

#[test]
fn end_points_that_are_far_apart_are_rarely_on_one_surface() {
    let mut noise = RandomStream::new(301, Purpose::LaserNoise(0));
    let scattered = reading(|_| noise.uniform(2.0..9.0));
    let [all, without] = [true, false].map(|grazing| points(&scattered, grazing).len());
    assert!(all <= without + 2, "{all} points, {without} without beams that graze");
}
