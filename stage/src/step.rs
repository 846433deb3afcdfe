//! The physics step of a world that does not say one.

use super::place::Place;
use super::sources::Sources;
use super::{Drive, StageRobot};

/// No physics step is longer, ms.
const LONGEST_MS: f64 = 50.0;
/// The interval of the laser that a robot without one is given, ms.
const GIVEN_INTERVAL_MS: u32 = 100;
/// Nor shorter.
const SHORTEST_MS: f64 = 1.0;

/// A step that is not too long for any robot, and of which the intervals of all sensors are
/// multiples, s.
pub(super) fn step_s(
    sources: &mut Sources<'_>,
    longest_ms: Option<f64>,
    robots: &[StageRobot],
) -> Option<f64> {
    let common_ms = robots.iter().flat_map(intervals_ms).reduce(common_divisor).map_or(LONGEST_MS, f64::from);
    let mut longest_ms = longest_ms.unwrap_or(LONGEST_MS).min(LONGEST_MS);
    for robot in robots {
        let fastest = |bounds: &[f64; 2]| bounds[1].max(-bounds[0]);
        let sideways_mps = if robot.drive == Drive::Omni { fastest(&robot.velocity.y) } else { 0.0 };
        let fastest_mps = libm::hypot(fastest(&robot.velocity.x), sideways_mps);
        // No robot goes farther than its inner radius in a step, so that none can pass through another.
        longest_ms = longest_ms.min(0.999 * 1000.0 * robot.inner_m() / fastest_mps);
    }
    let step_ms = common_ms / (common_ms / longest_ms).ceil().max(1.0);
    if step_ms >= SHORTEST_MS {
        return Some(step_ms / 1000.0);
    }
    let place = Place { file: 0, start: 0, end: 0 };
    let help = "a step may not be shorter than 1 ms, a robot may not go farther than its radius in it, and \
                sensors sense at whole numbers of steps";
    sources.error(place, "no physics step suits this world", "", help);
    None
}

/// How often a robot's sensors sense; one without a laser is given one, ms.
fn intervals_ms(robot: &StageRobot) -> impl Iterator<Item = u32> {
    let lasers = robot.lasers.iter().map(|laser| laser.interval_ms);
    let sonars = robot.sonars.iter().map(|sonar| sonar.interval_ms);
    let finder = robot.fiducial.iter().map(|finder| finder.interval_ms);
    let given = robot.lasers.is_empty().then_some(GIVEN_INTERVAL_MS);
    lasers.chain(sonars).chain(finder).chain(given)
}

fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}
