//! What a robot drives with and what it sees with.

use super::sources::Place;
use super::tree::Thing;
use super::values::{Pose, Reader};
use super::{Bounds, Drive, StageLaser};
use crate::physics::OdometryError;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Stage's bounds, where the file gives none: 1 m/s and a quarter turn per second.
const DEFAULT_VELOCITY: Bounds = Bounds { x: [-1.0, 1.0], y: [-1.0, 1.0], turn: [-FRAC_PI_2, FRAC_PI_2] };
/// Stage draws the errors of an odometry without `odom_error` evenly from ±0.015 along and ±0.025 in turn;
/// this is their standard deviation.
const DEFAULT_ODOM_ERROR: [f64; 2] = [0.015 * INVERSE_ROOT_3, 0.025 * INVERSE_ROOT_3];
/// 1/√3: the standard deviation of an even spread over ±1.
const INVERSE_ROOT_3: f64 = 0.577_350_269_189_625_8;
/// A sensor of Stage, where the file says nothing.
const DEFAULT_SENSOR_RANGE_M: [f64; 2] = [0.0, 5.0];
const DEFAULT_SENSOR_FOV_RAD: f64 = 0.1;
/// The same for an old laser.
const DEFAULT_LASER_RANGE_M: [f64; 2] = [0.0, 8.0];
const DEFAULT_LASER_SAMPLES: f64 = 180.0;
/// Stage updates a model so often, ms.
const DEFAULT_INTERVAL_MS: f64 = 100.0;

/// How a robot moves.
pub(super) struct Motion {
    pub(super) drive: Drive,
    pub(super) velocity: Bounds,
    pub(super) acceleration: Option<Bounds>,
    pub(super) odometry: OdometryError,
}

impl Reader<'_, '_> {
    pub(super) fn motion(&mut self, robot: &Thing) -> Motion {
        let wheelbase_m = self.number(robot, "wheelbase", 0.001..=100.0).unwrap_or(1.0) * self.length_m;
        let drive = match self.text(robot, "drive") {
            None => Drive::Differential,
            Some((drive, place)) => match drive.as_str() {
                "diff" => Drive::Differential,
                "omni" => Drive::Omni,
                "car" => Drive::Car { wheelbase_m },
                _ => {
                    let what = format!("there is no drive `{drive}`");
                    self.sources.error(place, &what, "", "it is `diff`, `omni` or `car`");
                    Drive::Differential
                }
            },
        };
        if let Some((velocity, place)) = self.numbers(robot, "velocity", 3..=4)
            && velocity.iter().any(|value| *value != 0.0)
        {
            self.sources.warning(
                place,
                "the robot moves at the start",
                "",
                "here every robot starts at rest",
            );
        }
        Motion {
            drive,
            velocity: self.bounds(robot, "velocity_bounds").unwrap_or(DEFAULT_VELOCITY),
            acceleration: self.acceleration(robot),
            odometry: self.odometry(robot),
        }
    }

    fn acceleration(&mut self, robot: &Thing) -> Option<Bounds> {
        let bounds = self.bounds(robot, "acceleration_bounds")?;
        let place = robot.properties.get("acceleration_bounds")?.place();
        let help = "Stage heeds them only when accelerations are commanded, not when velocities are; without them a robot reaches every velocity at once";
        self.sources.warning(place, "`acceleration_bounds` always hold here", "", help);
        Some(bounds)
    }

    /// `[xmin xmax ymin ymax zmin zmax amin amax]`.
    fn bounds(&mut self, robot: &Thing, name: &str) -> Option<Bounds> {
        let (numbers, place) = self.numbers(robot, name, 8..=8)?;
        let pair = |i: usize, unit: f64| [numbers[i] * unit, numbers[i + 1] * unit];
        let bounds =
            Bounds { x: pair(0, self.length_m), y: pair(2, self.length_m), turn: pair(6, self.angle_rad) };
        if [bounds.x, bounds.y, bounds.turn].iter().any(|[least, most]| *least > 0.0 || *most < 0.0) {
            let what = format!("`{name}` do not allow to stand still");
            self.sources.error(place, &what, "", "each least value is 0 or less, each greatest 0 or more");
            return None;
        }
        Some(bounds)
    }

    fn odometry(&mut self, robot: &Thing) -> OdometryError {
        let is_exact = match self.text(robot, "localization") {
            None => true,
            Some((kind, place)) => match kind.as_str() {
                "gps" => true,
                "odom" => false,
                _ => {
                    let what = format!("there is no localization `{kind}`");
                    self.sources.error(place, &what, "", "it is `gps` or `odom`");
                    true
                }
            },
        };
        if let Some((origin, place)) = self.numbers(robot, "localization_origin", 3..=4)
            && origin.iter().any(|value| *value != 0.0)
        {
            let help = "robots here report their pose in the frame of the world, as with [0 0 0 0]";
            self.sources.warning(place, "the localization has an origin of its own", "", help);
        }
        let given = self.numbers(robot, "odom_error", 3..=4);
        if is_exact {
            return OdometryError::default();
        }
        let [distance_gain, turn_gain] = match given {
            Some((numbers, place)) if numbers.len() == 4 => {
                let help = "it is 0.05 for 5 %, as Stage's manual has it; Stage 4.3 itself takes it for degrees, and errs 57 times less";
                if numbers[3] != 0.0 {
                    self.sources.warning(place, "the error of the turn is a proportion", "", help);
                }
                [numbers[0], numbers[3]]
            }
            Some((_, place)) => {
                self.sources.error(place, "`odom_error` has 3 numbers", "", "it takes 4: x, y, z and turn");
                [0.0, 0.0]
            }
            None => {
                let place = robot.properties.get("localization").map_or(robot.place, |key| key.place());
                let help = "Stage draws the errors anew for every run; here they are its typical ones: 0.9 % along, 1.4 % in turn";
                self.sources.warning(place, "the odometry has no `odom_error`", "", help);
                DEFAULT_ODOM_ERROR
            }
        };
        OdometryError { distance_gain, turn_gain, ..OdometryError::default() }
    }

    /// The lasers of a `ranger`, which stands `at` as seen from its robot, with their heights, m.
    pub(super) fn ranger(&mut self, ranger: &Thing, at: &Pose) -> Vec<(StageLaser, f64)> {
        let interval_ms = self.interval_ms(ranger);
        let sensors: Vec<&Thing> = ranger.parts.iter().filter(|part| part.kind == "sensor").collect();
        if sensors.is_empty() {
            let help = "in Stage, too, it sees nothing";
            self.sources.warning(ranger.place, "this ranger has no `sensor`", "", help);
        }
        let sensors = sensors.into_iter().filter_map(|sensor| {
            let pose = self.pose(sensor, "pose").unwrap_or(Pose::origin());
            let size_m = self.size(sensor, [0.02; 3]);
            let range_m = match self.numbers(sensor, "range", 2..=2) {
                Some((numbers, _)) => [numbers[0] * self.length_m, numbers[1] * self.length_m],
                None => DEFAULT_SENSOR_RANGE_M,
            };
            let samples = self.number(sensor, "samples", 1.0..=10_000.0).unwrap_or(1.0);
            let fov_rad = self.fov_rad(sensor).unwrap_or(DEFAULT_SENSOR_FOV_RAD);
            let mount = at.then(&pose);
            let laser = self.laser_of(sensor, &mount, samples, fov_rad, range_m, interval_ms)?;
            Some((laser, mount.z_m + size_m[2] / 2.0))
        });
        sensors.collect()
    }

    /// The laser of a `laser`, as older files have it.
    pub(super) fn old_laser(&mut self, laser: &Thing, at: &Pose) -> Option<(StageLaser, f64)> {
        let interval_ms = self.interval_ms(laser);
        let [least, most] = DEFAULT_LASER_RANGE_M;
        let least = self.number(laser, "range_min", 0.0..=1e5).map_or(least, |range| range * self.length_m);
        let most = self.number(laser, "range_max", 0.0..=1e5).map_or(most, |range| range * self.length_m);
        let samples = self.number(laser, "samples", 1.0..=10_000.0).unwrap_or(DEFAULT_LASER_SAMPLES);
        let fov_rad = self.fov_rad(laser).unwrap_or(TAU / 2.0);
        let result = self.laser_of(laser, at, samples, fov_rad, [least, most], interval_ms)?;
        Some((result, at.z_m))
    }

    fn laser_of(
        &mut self,
        thing: &Thing,
        mount: &Pose,
        samples: f64,
        fov_rad: f64,
        [range_min_m, range_max_m]: [f64; 2],
        interval_ms: u32,
    ) -> Option<StageLaser> {
        let noise_std_m = self.noise(thing);
        if !(0.0 <= range_min_m && range_min_m < range_max_m) {
            let help = "the least range must be 0 or more, and smaller than the greatest";
            self.sources.error(thing.place, "a laser sees nothing", "", help);
            return None;
        }
        if samples < 2.0 {
            let help = "a sonar or a single beam is left out; nothing here reads it yet";
            self.sources.warning(thing.place, "a sensor of a single ray", "", help);
            return None;
        }
        if fov_rad > TAU - 1e-6 {
            let help = "Stage's first and last beam are one; here no beam is doubled, and all are 360° / samples apart";
            self.sources.warning(thing.place, "a laser sees all around", "", help);
        }
        Some(StageLaser {
            place: self.sources.name(thing.place),
            mount: mount.flat,
            beams: samples as usize,
            fov_rad: fov_rad.min(TAU),
            range_min_m,
            range_max_m,
            interval_ms,
            noise_std_m,
            at: thing.place,
        })
    }

    fn fov_rad(&mut self, thing: &Thing) -> Option<f64> {
        let most = TAU / self.angle_rad + 1e-6;
        self.number(thing, "fov", 0.0..=most).map(|fov| fov * self.angle_rad)
    }

    fn interval_ms(&mut self, thing: &Thing) -> u32 {
        self.number(thing, "update_interval", 1.0..=100_000.0).unwrap_or(DEFAULT_INTERVAL_MS) as u32
    }

    /// `[constant proportional angle]`: Stage adds an even spread over ±1 times each.
    fn noise(&mut self, thing: &Thing) -> f64 {
        let Some((numbers, place)) = self.numbers(thing, "noise", 3..=3) else {
            return 0.0;
        };
        self.noise_warning(place, &numbers);
        numbers[0].abs() * self.length_m * INVERSE_ROOT_3
    }

    fn noise_warning(&mut self, place: Place, numbers: &[f64]) {
        if numbers[1] != 0.0 || numbers[2] != 0.0 {
            let help = "only the first number, the same at every range, is heeded";
            self.sources.warning(place, "noise that grows with the range, or of the angle", "", help);
        }
        if numbers[0] != 0.0 {
            let help = "here it is normal, of the same standard deviation: the number times 0.577";
            self.sources.warning(place, "Stage's noise is spread evenly", "", help);
        }
    }
}
