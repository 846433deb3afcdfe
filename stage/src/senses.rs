//! The sensors of a robot.

use super::tree::Entity;
use super::{Bounds, Drive, StageRobot, StageSensor};
use crate::world::Builder;
use nalgebra::Isometry2;
use sim::physics::OdometryError;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A sensor of Stage, where the file says nothing.
const DEFAULT_SENSOR_RANGE_M: [f64; 2] = [0.0, 5.0];
const DEFAULT_SENSOR_FOV_RAD: f64 = 0.1;
/// The defaults of a `laser` of older Stage files.
const DEFAULT_LASER_RANGE_M: [f64; 2] = [0.0, 8.0];
const DEFAULT_LASER_SAMPLES: f64 = 180.0;
/// The time between two updates of a model of Stage, ms.
const DEFAULT_INTERVAL_MS: f64 = 100.0;
const MAX_INTERVAL_MS: f64 = 100_000.0;
/// The maximum number of samples of a sensor.
const MAX_SAMPLES: f64 = 10_000.0;
/// The narrowest and the widest cone of a sonar here, rad.
const CONE_RAD: [f64; 2] = [PI / 180.0, PI];

impl Builder<'_, '_> {
    /// Adds the sensors of an entity, whose pose in the world is `at`, to a robot.
    pub(super) fn sense(&mut self, entity: &Entity, at: &Isometry2<f64>, robot: &mut StageRobot) {
        let mount = robot.pose.inverse() * (at * self.pose(entity, "origin"));
        let sensors = match entity.kind.as_str() {
            "laser" => self.old_laser(entity, mount).into_iter().collect(),
            _ => self.ranger(entity, &mount),
        };
        let (lasers, sonars): (Vec<_>, Vec<_>) = sensors.into_iter().partition(|sensor| sensor.beams > 1);
        robot.lasers.extend(lasers);
        robot.sonars.extend(sonars);
    }

    /// The sensors of a `ranger` at `at` on its robot.
    fn ranger(&mut self, ranger: &Entity, at: &Isometry2<f64>) -> Vec<StageSensor> {
        let interval_ms = self.interval_ms(ranger);
        let parts = || ranger.parts.iter().filter(|part| part.kind == "sensor");
        if parts().next().is_none() {
            let help = "in Stage, too, it sees nothing";
            self.sources.warning(ranger.place, "this ranger has no `sensor`", help);
        }
        let sensors = parts().filter_map(|part| {
            let mount = at * self.pose(part, "pose");
            self.size_m(part, 0.02);
            let range_m = self.lengths_m(part, "range", 2);
            let range_m = range_m.map_or(DEFAULT_SENSOR_RANGE_M, |range_m| [range_m[0], range_m[1]]);
            self.sensor(part, mount, (1.0, DEFAULT_SENSOR_FOV_RAD), range_m, interval_ms)
        });
        let sensors: Vec<StageSensor> = sensors.collect();
        if sensors.iter().any(|sensor| sensor.beams == 1) {
            let help =
                "here it is a cone as wide as its `fov` (1° to 180°), and the nearest thing in it counts";
            self.sources.warning(ranger.place, "in Stage a sensor of one sample is a single ray", help);
        }
        sensors
    }

    /// The laser of a `laser`, as older files have it.
    fn old_laser(&mut self, laser: &Entity, mount: Isometry2<f64>) -> Option<StageSensor> {
        let interval_ms = self.interval_ms(laser);
        let [min_m, max_m] = DEFAULT_LASER_RANGE_M;
        let min_m = self.length_m(laser, "range_min").unwrap_or(min_m);
        let max_m = self.length_m(laser, "range_max").unwrap_or(max_m);
        self.sensor(laser, mount, (DEFAULT_LASER_SAMPLES, PI), [min_m, max_m], interval_ms)
    }

    /// A laser or a sonar, with defaults for its samples and its field of view (rad).
    fn sensor(
        &mut self,
        entity: &Entity,
        mount: Isometry2<f64>,
        (samples, fov_rad): (f64, f64),
        [range_min_m, range_max_m]: [f64; 2],
        interval_ms: u32,
    ) -> Option<StageSensor> {
        let mut beams = self.number(entity, "samples", 1.0..=MAX_SAMPLES).unwrap_or(samples) as usize;
        let mut fov_rad = self.fov_rad(entity).unwrap_or(fov_rad);
        let (noise_std_m, at) = (self.noise_std_m(entity), entity.place);
        if !(0.0 <= range_min_m && range_min_m < range_max_m) {
            let help = "the least range must be 0 or more, and smaller than the greatest";
            self.sources.error(at, "a laser sees nothing", help);
            return None;
        }
        if beams < 2 {
            fov_rad = fov_rad.clamp(CONE_RAD[0], CONE_RAD[1]);
        } else if fov_rad > TAU - 1e-6 {
            let help = "Stage's first and last beam are one: here it is left out the second time, and the others have \
                        Stage's angles";
            self.sources.warning(at, "a laser sees all around", help);
            (beams, fov_rad) = ((beams - 1).max(2), fov_rad.min(TAU));
        }
        let place = self.sources.name(at);
        let range_m = [range_min_m, range_max_m];
        Some(StageSensor { place, mount, beams, fov_rad, range_m, interval_ms, noise_std_m, at })
    }

    fn fov_rad(&mut self, entity: &Entity) -> Option<f64> {
        let max = TAU / self.angle_rad + 1e-6;
        self.number(entity, "fov", 0.0..=max).map(|fov| fov * self.angle_rad)
    }

    /// The time between two measurements, ms: Stage updates a sensor in the first of its steps that is not too
    /// early.
    fn interval_ms(&mut self, entity: &Entity) -> u32 {
        let given_ms = self.number(entity, "update_interval", 1.0..=MAX_INTERVAL_MS);
        let given_ms = given_ms.unwrap_or(DEFAULT_INTERVAL_MS) as u32;
        let step_ms = self.interval_sim_ms;
        let interval_ms = given_ms.next_multiple_of(step_ms).min(MAX_INTERVAL_MS as u32);
        if interval_ms != given_ms {
            let what = format!("every {given_ms} ms is no multiple of Stage's step, which is {step_ms} ms");
            let help = "see `interval_sim` and `update_interval`";
            let help = format!("in Stage, too, this sensor senses every {interval_ms} ms; {help}");
            self.sources.warning(entity.place_of("update_interval"), what, help);
        }
        interval_ms
    }

    /// `[constant proportional angle]`: Stage adds an even spread over ±1 times each.
    fn noise_std_m(&mut self, entity: &Entity) -> f64 {
        let Some((numbers, place)) = self.numbers(entity, "noise", 3..=3) else {
            return 0.0;
        };
        if numbers[1] != 0.0 || numbers[2] != 0.0 {
            let help = "only the first number, the same at every range, is heeded";
            self.sources.warning(place, "noise that grows with the range, or of the angle", help);
        }
        if numbers[0] != 0.0 {
            let help = "here it is normal, of the same standard deviation: the number times 0.577";
            self.sources.warning(place, "Stage's noise is spread evenly", help);
        }
        numbers[0].abs() * self.length_m * INVERSE_ROOT_3
    }
}

// How a robot drives, and what it measures of that.

/// Stage's bounds, where the file gives none: 1 m/s and a quarter turn per second.
const DEFAULT_VELOCITY: Bounds = Bounds { x: [-1.0, 1.0], y: [-1.0, 1.0], turn: [-FRAC_PI_2, FRAC_PI_2] };
/// Stage draws the errors of an odometry without `odom_error` evenly from ±0.015 along and ±0.025 in turn;
/// this is their standard deviation.
const DEFAULT_ODOM_ERROR: [f64; 2] = [0.015 * INVERSE_ROOT_3, 0.025 * INVERSE_ROOT_3];
/// 1/√3: the standard deviation of an even spread over ±1.
const INVERSE_ROOT_3: f64 = 0.577_350_269_189_625_8;

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
