//! What a log says about its laser: its pose on the robot, its field of view and its range.

use interfaces::Spread;
use nalgebra::Isometry2;
use std::f64::consts::{PI, TAU};

/// The maximum range of a laser without a parameter, m: a SICK LMS 200 reports failures as 81.83 m and above.
pub(super) const MAX_RANGE_M: f64 = 80.0;
/// A laser is nearer to the center of its robot than this, m.
pub(super) const MAX_OFFSET_M: f64 = 10.0;
/// The fields of view by the number of readings as CARMEN knows them (`carmen_laser_guess_fov`), degrees. With an even number, the
/// last reading is left out.
const FIELDS_DEG: [([usize; 4], f64); 2] = [([180, 181, 360, 361], 180.0), ([400, 401, 400, 401], 100.0)];
/// Below these, an angle of a parameter is in rad: logs have both. No laser has so small a field of view in degrees, and none has
/// beams that are so far apart in rad.
const MAX_FOV_RAD: f64 = TAU + 0.01;
const MAX_RESOLUTION_RAD: f64 = 0.05;
const MIN_RESOLUTION_RAD: f64 = 1e-4;

/// What is known about the laser.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Geometry {
    /// m ahead, m to the left, rad to the left.
    ahead_m: f64,
    left_m: f64,
    turn_rad: f64,
    fov_rad: Option<f64>,
    resolution_rad: Option<f64>,
    /// The maximum range that a parameter states, m, and whether beams measure less than this: known at the end.
    pub(super) stated_max_m: Option<f64>,
    pub(super) is_max_sure: bool,
    /// Whether ranges from 80 m on are numbers for failures, whatever maximum is stated.
    pub(super) has_codes: bool,
    /// The pose of the laser on the robot, by the two poses of ROBOTLASER1 lines.
    pub(super) robotlaser_mount: Option<Isometry2<f64>>,
}

impl Geometry {
    /// Takes a parameter of the front laser over. Others are left out, and so are invalid values.
    pub(super) fn set(&mut self, name: &str, value: f64) {
        let is_offset = value.abs() < MAX_OFFSET_M;
        let fov_deg = if value <= MAX_FOV_RAD { value.to_degrees() } else { value };
        // 3.14159 is 180°.
        let fov_rad = ((fov_deg * 100.0).round() / 100.0).to_radians();
        let resolution_rad = if value < MAX_RESOLUTION_RAD { value } else { value.to_radians() };
        match name {
            "robot_frontlaser_offset" if is_offset => self.ahead_m = value,
            "robot_frontlaser_side_offset" if is_offset => self.left_m = value,
            "robot_frontlaser_angular_offset" if value.abs() <= TAU => self.turn_rad = value,
            "robot_front_laser_max" | "laser_front_laser_max" if value > 0.1 => {
                self.stated_max_m = Some(value)
            }
            "laser_front_laser_fov" if value > 0.0 && fov_rad <= MAX_FOV_RAD => self.fov_rad = Some(fov_rad),
            "laser_front_laser_resolution" if resolution_rad > MIN_RESOLUTION_RAD && resolution_rad < 1.0 => {
                self.resolution_rad = Some(resolution_rad);
            }
            _ => {}
        }
    }

    /// Ranges of FLASER lines from here on are no measurements, m. A stated maximum range below 80 m counts only if no range is
    /// beyond it.
    pub(super) fn range_max_m(&self) -> f64 {
        let is_sure = |max_m: &f64| self.is_max_sure || *max_m > MAX_RANGE_M;
        self.limited_m(self.stated_max_m.filter(is_sure).unwrap_or(MAX_RANGE_M))
    }

    /// The pose of the laser on the robot, by parameters.
    pub(super) fn mount(&self) -> Isometry2<f64> {
        interfaces::pose(self.ahead_m, self.left_m, self.turn_rad)
    }

    /// The maximum range of a laser with this stated one, m.
    pub(super) fn limited_m(&self, stated_m: f64) -> f64 {
        if self.has_codes { stated_m.min(MAX_RANGE_M) } else { stated_m }
    }

    /// The field of view of a FLASER line with this number of readings, rad, and the angle between them; and whether it is known.
    ///
    /// A stated field of view that contradicts the stated resolution is that of another setting of the laser: then the number of
    /// readings counts.
    pub(super) fn field(&self, count: usize) -> (f64, f64, bool) {
        let steps = (if count.is_multiple_of(2) { count } else { count - 1 }).max(1) as f64;
        let guess = FIELDS_DEG.iter().find(|(counts, _)| counts.contains(&count));
        let guess_rad = guess.map(|(_, fov_deg)| fov_deg.to_radians());
        let by_resolution_rad = self.resolution_rad.map(|resolution_rad| resolution_rad * steps);
        let is_near = |fov_rad: f64, other_rad: f64| (fov_rad - other_rad).abs() * steps <= 2.0 * fov_rad;
        let fov_rad = match (self.fov_rad, by_resolution_rad) {
            (Some(fov_rad), None) => Some(fov_rad),
            (Some(fov_rad), Some(other_rad)) if is_near(fov_rad, other_rad) => Some(fov_rad),
            (fov_rad, other_rad) => guess_rad.or(fov_rad).or(other_rad),
        };
        let is_known = fov_rad.is_some_and(|fov_rad| fov_rad <= MAX_FOV_RAD);
        let fov_rad = fov_rad.filter(|_| is_known).unwrap_or(PI);
        (fov_rad, fov_rad / steps, is_known)
    }
}

/// The poses of the laser on the robot that ROBOTLASER1 lines contain.
#[derive(Debug, Default)]
pub(super) struct Mounts {
    first: Option<Isometry2<f64>>,
    changes: bool,
}

/// Poses of the laser on the robot are the same within this, m and rad: logs have rounded poses.
const SAME_MOUNT: Spread = Spread::of_motion(0.01);

impl Mounts {
    pub(super) fn add(&mut self, mount: &Isometry2<f64>) {
        let first = *self.first.get_or_insert(*mount);
        self.changes |= !SAME_MOUNT.contains(&first.inv_mul(mount));
    }

    /// The pose of the laser on the robot, if there is one: in corrected logs, the pose of the laser is that of another estimation,
    /// and is not fixed to that of the robot. Logs that write the same pose twice do not say it.
    pub(super) fn fixed(&self) -> Option<Isometry2<f64>> {
        let is_mount = |mount: &Isometry2<f64>| {
            !self.changes && !SAME_MOUNT.contains(mount) && mount.translation.vector.norm() < MAX_OFFSET_M
        };
        self.first.filter(is_mount)
    }
}
