//! What a log says about its laser: its pose on the robot, its field of view and its range.

use nalgebra::Isometry2;
use std::f64::consts::{PI, TAU};

/// The largest range of a laser, m: the lasers of such logs do not measure farther, and report failures as 81.83 m and above.
pub(super) const MAX_RANGE_M: f64 = 80.0;
/// A laser is nearer to the center of its robot than this, m.
pub(super) const MAX_OFFSET_M: f64 = 10.0;
/// The fields of view by the number of readings as CARMEN knows them (`carmen_laser_guess_fov`), degrees. With an even number, the
/// last reading is left out.
const FIELDS_DEG: [([usize; 4], f64); 2] = [([180, 181, 360, 361], 180.0), ([400, 401, 400, 401], 100.0)];
/// Below this, a field of view is in rad: logs have both, and no laser has so small a field of view in degrees.
const MAX_FOV_RAD: f64 = TAU + 0.01;

/// A parameter of the front laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Param {
    /// The pose of the laser on the robot: m ahead, m to the left, rad to the left.
    Ahead(f64),
    Left(f64),
    Turn(f64),
    /// m
    MaxRange(f64),
    /// rad
    Fov(f64),
}

impl Param {
    /// A parameter by its name; `None` if it is another one, or if its value is invalid.
    pub(super) fn of(name: &str, value: f64) -> Option<Self> {
        let is_offset = value.abs() < MAX_OFFSET_M;
        let fov_deg = if value <= MAX_FOV_RAD { value.to_degrees() } else { value };
        // 3.14159 is 180°.
        let fov_rad = ((fov_deg * 100.0).round() / 100.0).to_radians();
        match name {
            "robot_frontlaser_offset" if is_offset => Some(Self::Ahead(value)),
            "robot_frontlaser_side_offset" if is_offset => Some(Self::Left(value)),
            "robot_frontlaser_angular_offset" if value.abs() <= TAU => Some(Self::Turn(value)),
            "robot_front_laser_max" | "laser_front_laser_max" if value > 0.1 => Some(Self::MaxRange(value)),
            "laser_front_laser_fov" if value > 0.0 && fov_rad <= MAX_FOV_RAD => Some(Self::Fov(fov_rad)),
            _ => None,
        }
    }
}

/// What is known about the laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Geometry {
    /// m ahead, m to the left, rad to the left.
    ahead_m: f64,
    left_m: f64,
    turn_rad: f64,
    fov_rad: Option<f64>,
    /// Ranges of FLASER lines from here on are no measurements, m.
    pub(super) range_max_m: f64,
    /// The pose of the laser on the robot, by the two poses of ROBOTLASER1 lines.
    pub(super) robotlaser_mount: Option<Isometry2<f64>>,
}

impl Default for Geometry {
    fn default() -> Self {
        Self {
            ahead_m: 0.0,
            left_m: 0.0,
            turn_rad: 0.0,
            fov_rad: None,
            range_max_m: MAX_RANGE_M,
            robotlaser_mount: None,
        }
    }
}

impl Geometry {
    /// Takes a parameter over. A stated maximum range counts only if no range is beyond it, which is known at the end.
    pub(super) fn set(&mut self, param: Param) {
        match param {
            Param::Ahead(ahead_m) => self.ahead_m = ahead_m,
            Param::Left(left_m) => self.left_m = left_m,
            Param::Turn(turn_rad) => self.turn_rad = turn_rad,
            Param::MaxRange(_) => {}
            Param::Fov(fov_rad) => self.fov_rad = Some(fov_rad),
        }
    }

    /// The pose of the laser on the robot, by parameters.
    pub(super) fn mount(&self) -> Isometry2<f64> {
        interfaces::pose(self.ahead_m, self.left_m, self.turn_rad)
    }

    /// The field of view of a FLASER line with this number of readings, rad, and the angle between them; and whether it is known.
    pub(super) fn field(&self, count: usize) -> (f64, f64, bool) {
        let steps = (if count.is_multiple_of(2) { count } else { count - 1 }).max(1) as f64;
        let guess = FIELDS_DEG.iter().find(|(counts, _)| counts.contains(&count));
        let known_rad = self.fov_rad.or(guess.map(|(_, fov_deg)| fov_deg.to_radians()));
        let fov_rad = known_rad.unwrap_or(PI);
        (fov_rad, fov_rad / steps, known_rad.is_some())
    }
}

/// The poses of the laser on the robot that ROBOTLASER1 lines contain.
#[derive(Debug, Default)]
pub(super) struct Mounts {
    first: Option<Isometry2<f64>>,
    changes: bool,
}

/// Poses of the laser on the robot are the same within this, m and rad: logs have rounded poses.
const SAME_MOUNT: f64 = 0.01;

impl Mounts {
    pub(super) fn add(&mut self, mount: &Isometry2<f64>) {
        let first = *self.first.get_or_insert(*mount);
        self.changes |= is_apart(&first, mount);
    }

    /// The pose of the laser on the robot, if there is one: in corrected logs, the pose of the laser is that of another estimation,
    /// and is not fixed to that of the robot. Logs that write the same pose twice do not say it.
    pub(super) fn fixed(&self) -> Option<Isometry2<f64>> {
        let is_mount = |mount: &Isometry2<f64>| {
            !self.changes
                && is_apart(mount, &Isometry2::identity())
                && mount.translation.vector.norm() < MAX_OFFSET_M
        };
        self.first.filter(is_mount)
    }
}

fn is_apart(a: &Isometry2<f64>, b: &Isometry2<f64>) -> bool {
    let step = a.inv_mul(b);
    step.translation.vector.norm() > SAME_MOUNT || interfaces::heading_rad(&step).abs() > SAME_MOUNT
}
