//! How a robot drives, and what it measures of that.

use super::builder::Builder;
use super::tree::Entity;
use super::{Bounds, Drive};
use sim::physics::OdometryError;
use std::f64::consts::FRAC_PI_2;

/// Stage's bounds, where the file gives none: 1 m/s and a quarter turn per second.
const DEFAULT_VELOCITY: Bounds = Bounds { x: [-1.0, 1.0], y: [-1.0, 1.0], turn: [-FRAC_PI_2, FRAC_PI_2] };
/// Stage draws the errors of an odometry without `odom_error` evenly from ±0.015 along and ±0.025 in turn;
/// this is their standard deviation.
const DEFAULT_ODOM_ERROR: [f64; 2] = [0.015 * INVERSE_ROOT_3, 0.025 * INVERSE_ROOT_3];
/// 1/√3: the standard deviation of an even spread over ±1.
pub(super) const INVERSE_ROOT_3: f64 = 0.577_350_269_189_625_8;

impl Builder<'_, '_> {
    /// How a robot drives, the bounds of its velocity and of its acceleration, and how its odometry errs.
    pub(super) fn motion(&mut self, robot: &Entity) -> (Drive, Bounds, Option<Bounds>, OdometryError) {
        let wheelbase_m = self.number(robot, "wheelbase", 0.001..=100.0).unwrap_or(1.0) * self.length_m;
        let drives =
            [("diff", Drive::Differential), ("omni", Drive::Omni), ("car", Drive::Car { wheelbase_m })];
        let key = ("drive", "drive", "it is `diff`, `omni` or `car`");
        let drive = self.choice(robot, key, &drives).unwrap_or(Drive::Differential);
        let (what, help) = ("the robot moves at the start", "here every robot starts at rest");
        self.warn_unless_zero(robot, "velocity", what, help);
        let velocity = self.bounds(robot, "velocity_bounds").unwrap_or(DEFAULT_VELOCITY);
        let acceleration = self.bounds(robot, "acceleration_bounds");
        if acceleration.is_some() {
            let place = robot.place_of("acceleration_bounds");
            let help = "Stage heeds them only when accelerations are commanded, not when velocities are; without them a robot reaches every velocity at once";
            self.sources.warning(place, "`acceleration_bounds` always hold here", help);
        }
        (drive, velocity, acceleration, self.odometry(robot, drive == Drive::Omni))
    }

    /// Warns of a pose or velocity that is not zero.
    fn warn_unless_zero(&mut self, robot: &Entity, name: &str, what: &str, help: &str) {
        if let Some((numbers, place)) = self.numbers(robot, name, 3..=4)
            && numbers.iter().any(|number| *number != 0.0)
        {
            self.sources.warning(place, what, help);
        }
    }

    /// `[xmin xmax ymin ymax zmin zmax amin amax]`.
    fn bounds(&mut self, robot: &Entity, name: &str) -> Option<Bounds> {
        let (numbers, place) = self.numbers(robot, name, 8..=8)?;
        let pair = |i: usize, unit: f64| [numbers[i] * unit, numbers[i + 1] * unit];
        let bounds =
            Bounds { x: pair(0, self.length_m), y: pair(2, self.length_m), turn: pair(6, self.angle_rad) };
        if [bounds.x, bounds.y, bounds.turn].iter().any(|[least, most]| *least > 0.0 || *most < 0.0) {
            let what = format!("`{name}` do not allow to stand still");
            self.sources.error(place, what, "each least value is 0 or less, each greatest 0 or more");
            return None;
        }
        Some(bounds)
    }

    fn odometry(&mut self, robot: &Entity, is_omni: bool) -> OdometryError {
        let key = ("localization", "localization", "it is `gps` or `odom`");
        let is_exact = self.choice(robot, key, &[("gps", true), ("odom", false)]).unwrap_or(true);
        let help = "here all poses are in the frame of the world that runs, which is that of the file moved \
                    to the lower left corner of what is there";
        let what = "the localization has an origin of its own";
        self.warn_unless_zero(robot, "localization_origin", what, help);
        let given = self.numbers(robot, "odom_error", 3..=4);
        if is_exact {
            return OdometryError::default();
        }
        let [distance_gain, turn_gain] = match given {
            Some((numbers, place)) if numbers.len() == 4 => {
                let help = "it is 0.05 for 5 %, as Stage's manual has it; Stage 4.3 itself takes it for degrees, and errs 57 times less";
                if numbers[3] != 0.0 {
                    self.sources.warning(place, "the error of the turn is a proportion", help);
                }
                if is_omni && numbers[1] != numbers[0] {
                    let what = "the odometry errs by another share sideways than along";
                    self.sources.warning(place, what, "here the first number, that along, is for both");
                }
                [numbers[0], numbers[3]]
            }
            Some((_, place)) => {
                self.sources.error(place, "`odom_error` has 3 numbers", "it takes 4: x, y, z and turn");
                [0.0, 0.0]
            }
            None => {
                let help = "Stage draws the errors anew for every run; here they are its typical ones: 0.9 % along, 1.4 % in turn";
                let place = robot.place_of("localization");
                self.sources.warning(place, "the odometry has no `odom_error`", help);
                DEFAULT_ODOM_ERROR
            }
        };
        OdometryError { distance_gain, turn_gain, ..OdometryError::default() }
    }
}
