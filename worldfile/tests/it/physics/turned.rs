//! Worlds in frames that are turned by any angle, as a localized robot has them: rounding separates what lies on one line, and no
//! order of walls may depend on which two of them are compared.

use super::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::PathBuf;
use worldfile::physics::{parse_world, parse_world_with};
use worldfile::shipped;

/// A world without walls.
const EMPTY: &str = r#"name = "turned"

[[robot]]
name = "curious"
radius_m = 0.1
pose_m = [3.75, 3.75]

[robot.drive]
max_linear_mps = 0.5
max_angular_degps = 90.0
max_linear_acceleration_mps2 = 1.0
max_angular_acceleration_degps2 = 360.0

[robot.laser]
beams = 180
range_max_m = 10.0
rate_hz = 10.0

[robot.behavior]
kind = "driven"

[map]
size_m = [20.0, 20.0]
cell_m = 0.05

"#;

/// Random numbers from 0 to 1.
struct Random(ChaCha8Rng);

impl Random {
    fn next(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() * bound as f64) as usize
    }
}

/// The robot senses and drives in the world, in frames at some angles.
fn runs_at_any_angle(spec: &WorldSpec, angles: usize, random: &mut Random) {
    for _ in 0..angles {
        let heading_rad = 2.0 * PI * random.next() - PI;
        let Some((turned, _)) = spec.around_robot(heading_rad) else { continue };
        let mut world = PhysicsWorld::new(&turned, 1);
        for _ in 0..3 {
            world.act(&Twist { linear_mps: 0.2, angular_radps: 0.5 });
            let reading = world.sense();
            assert!(reading.scan.ranges_m.iter().all(|range_m| *range_m >= 0.0), "{heading_rad}");
        }
    }
}

#[test]
fn shipped_and_generated_worlds_run_at_any_angle() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(1));
    let shipped = shipped::PHYSICS.iter().map(|(name, _)| (*name).to_owned());
    let kinds = ["house", "office", "rooms", "rooms-day", "calendar-office"];
    let generated = kinds.iter().flat_map(|kind| (1..3).map(move |seed| format!("{kind}-{seed}")));
    for name in shipped.chain(generated) {
        runs_at_any_angle(&shipped::load(&name).unwrap(), 5, &mut random);
    }
}

/// Walls that begin at one corner, whose lines differ little.
#[test]
fn walls_on_nearly_one_line_run_at_any_angle() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(2));
    for _ in 0..20 {
        let mut text = EMPTY.to_owned();
        for wall in 0..40 {
            let high = [2.1 + 0.37 * f64::from(wall), 2.54 - 0.011 * f64::from(wall) * random.next()];
            text += &format!("[[wall]]\nmin_m = [2.0, 2.0]\nmax_m = [{:.4}, {:.4}]\n", high[0], high[1]);
        }
        runs_at_any_angle(&parse_world("walls", &text).unwrap(), 3, &mut random);
    }
}

/// Floor plans of many small walls, as maps of real robots are.
#[test]
fn floor_plans_run_at_any_angle() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(3));
    for _ in 0..12 {
        let side = 150;
        let mut pixels = vec![254_u8; side * side];
        for _ in 0..120 {
            let (x, y) = (random.below(side), random.below(side));
            let (width, height) =
                if random.below(2) == 0 { (40, 1 + random.below(2)) } else { (1 + random.below(2), 40) };
            for row in y..(y + height).min(side) {
                (x..(x + width).min(side))
                    .filter(|_| random.below(12) > 0)
                    .for_each(|x| pixels[row * side + x] = 0);
            }
        }
        let middle = side / 2;
        for row in middle - 8..middle + 8 {
            pixels[row * side + middle - 8..][..16].fill(254);
        }
        let header = format!("P5 {side} {side} 255\n");
        let files = BTreeMap::from([(PathBuf::from("plan.pgm"), [header.as_bytes(), &pixels].concat())]);
        let text = format!("{EMPTY}[[floor_plan]]\nimage = \"plan.pgm\"\npixel_m = 0.05\n");
        let spec = parse_world_with("plan", &text, &files).unwrap();
        runs_at_any_angle(&spec, 3, &mut random);
    }
}
