use super::Chassis;
use super::escape::Escape;
use super::legs::{NARROW_SHARE, Pace};
use crate::physics::spec::WanderSpec;
use interfaces::{LaserReading, RandomStream, Twist, Values, values};
use nalgebra::Vector2;
use std::ops::Range;

/// The width that must be free ahead, as a multiple of the width of the body.
const WIDTH: f64 = 1.1;
/// After a stop, this much additional space must be free before the robot continues, m.
const HYSTERESIS_M: f64 = 0.1;
/// Shares of the maximum turn rate: for a turn in place, and for the sharpest curve.
const TURN_SHARE: f64 = 0.5;
const CURVE_SHARE: f64 = 0.15;
/// In a narrow place: the width that must be free, as a multiple of the width of the body, the clearance, m, and the
/// additional space after a stop, m.
const NARROW_WIDTH: f64 = 1.02;
const NARROW_CLEARANCE_M: f64 = 0.02;
const NARROW_HYSTERESIS_M: f64 = 0.03;
/// The number of scans for which a curve lasts.
const CURVE_SCANS: Range<f64> = 10.0..50.0;

/// Drives without a goal: forward in long random curves. If an obstacle is too near ahead, the robot turns in place
/// toward the side with more space, until the way is free. If it is not free in any direction, the robot turns and
/// drives slowly, and keeps less space, until there is more. If it does not leave its place for long, it escapes.
#[derive(Clone, Debug)]
pub(crate) struct Wander {
    spec: WanderSpec,
    max_turn_radps: f64,
    wide: Space,
    narrow: Space,
    period_s: f64,
    /// The number of scans in which the robot has turned in place by a full turn.
    full_turn_scans: u32,
    random: RandomStream,
    /// The rate of the turn in place, rad/s, while the way is blocked.
    turning: Option<f64>,
    curve_radps: f64,
    scans_left: u32,
    /// The number of scans for which the robot has turned in place.
    turned_scans: u32,
    is_narrow: bool,
    escape: Escape,
}

/// The ranges at which a robot stops (below the first value on any beam) and continues (above the second value).
/// 0 for beams that do not point ahead.
#[derive(Clone, Debug)]
struct Space {
    stop_m: Vec<f32>,
    go_m: Vec<f32>,
}

impl Space {
    /// Whether the way is blocked for a robot that drives, or for one that stopped.
    fn is_blocked(&self, ranges_m: &[f32], has_stopped: bool) -> bool {
        let free_m = if has_stopped { &self.go_m } else { &self.stop_m };
        // No early exit: comparing several beams at once is faster. Too close (−∞) is below any bound.
        ranges_m.iter().zip(free_m).fold(false, |any, (range, free)| any | (range < free))
    }
}

impl Wander {
    pub(super) fn new(spec: WanderSpec, chassis: Chassis, random: RandomStream) -> Self {
        let robot = chassis.robot;
        // A laser outside of the body is treated as if it were on the border of the body: obstacles ahead then seem
        // nearer.
        let mount = robot.laser.mount.translation.vector.cap_magnitude(robot.radius_m);
        let escape = Escape::new(chassis, spec.speed_mps);
        let beams = chassis.beam_directions();
        let table = |width: f64, free_m: f64| {
            let lengths_m =
                beams.iter().map(|beam| length_within_m(&mount, beam, robot.radius_m, width, free_m));
            lengths_m.map(|length_m| length_m as f32).collect()
        };
        let space = |speed_mps: f64, width: f64, clearance_m: f64, hysteresis_m: f64| {
            let needed_m = clearance_m + Pace::new(chassis, speed_mps).stopping_m;
            Space { stop_m: table(width, needed_m), go_m: table(width, needed_m + hysteresis_m) }
        };
        let narrow_mps = NARROW_SHARE * spec.speed_mps;
        let period_s = chassis.period_s();
        let turn_rad = TURN_SHARE * robot.drive.max_angular_radps * period_s;
        Self {
            spec,
            max_turn_radps: robot.drive.max_angular_radps,
            wide: space(spec.speed_mps, WIDTH, spec.clearance_m, HYSTERESIS_M),
            narrow: space(narrow_mps, NARROW_WIDTH, NARROW_CLEARANCE_M, NARROW_HYSTERESIS_M),
            period_s,
            full_turn_scans: (std::f64::consts::TAU / turn_rad).ceil() as u32,
            escape,
            random,
            turning: None,
            curve_radps: 0.0,
            scans_left: 0,
            turned_scans: 0,
            is_narrow: false,
        }
    }

    /// The number of scans, at least one, in a random time of the range, s.
    pub(super) fn scans(&mut self, times_s: Range<f64>) -> u32 {
        (self.random.uniform(times_s) / self.period_s).ceil() as u32
    }

    /// The present curve, rad/s; a new one after some scans.
    fn curve(&mut self) -> f64 {
        if self.scans_left == 0 {
            self.scans_left = self.random.uniform(CURVE_SCANS) as u32;
            self.curve_radps = self.random.uniform(-1.0..1.0) * self.max_turn_radps * CURVE_SHARE;
        }
        self.scans_left -= 1;
        self.curve_radps
    }

    /// +1: there is more space on the left; −1: on the right. Random where there is little difference.
    fn open_side(&mut self, reading: &LaserReading) -> f64 {
        let max_m = reading.scan.range_max_m as f32;
        let mut more_left_m = 0.0;
        let beams = reading.scan.ranges_m.iter().zip(&self.escape.legs.beams);
        // A beam that was lost (NaN) says nothing.
        for (range_m, beam) in beams.filter(|(range_m, beam)| beam.x > 0.0 && !range_m.is_nan()) {
            let range_m = range_m.clamp(0.0, max_m);
            more_left_m += if beam.y > 0.0 { range_m } else { -range_m };
        }
        let undecided = self.random.uniform(-1.0..1.0) * f64::from(max_m);
        1.0_f64.copysign(f64::from(more_left_m) + undecided)
    }

    /// The velocity until the next reading.
    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        self.escape(reading).unwrap_or_else(|| self.roam(reading))
    }

    /// The velocity until the next reading, if the robot is escaping. To be called once for each reading.
    pub(super) fn escape(&mut self, reading: &LaserReading) -> Option<Twist> {
        self.escape.drive(reading, &mut self.random)
    }

    /// The velocity until the next reading without an escape.
    pub(super) fn roam(&mut self, reading: &LaserReading) -> Twist {
        let ranges_m = &reading.scan.ranges_m;
        self.is_narrow = self.is_narrow && self.wide.is_blocked(ranges_m, true);
        let (space, share) = if self.is_narrow { (&self.narrow, NARROW_SHARE) } else { (&self.wide, 1.0) };
        if !space.is_blocked(ranges_m, self.turning.is_some()) {
            self.turning = None;
            self.turned_scans = 0;
            return Twist { linear_mps: share * self.spec.speed_mps, angular_radps: share * self.curve() };
        }
        let turn_radps = match self.turning {
            Some(turn) => turn,
            None => self.open_side(reading) * self.max_turn_radps * TURN_SHARE,
        };
        self.turning = Some(turn_radps);
        self.turned_scans = self.turned_scans.saturating_add(1);
        self.is_narrow |= self.turned_scans > self.full_turn_scans;
        Twist { linear_mps: 0.0, angular_radps: share * turn_radps }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        let Self { random, turning, curve_radps, scans_left, turned_scans, is_narrow, escape, .. } = self;
        values![*random, *turning, *curve_radps, *scans_left, *turned_scans, *is_narrow; escape]
    }
}

/// The length of a beam within the space that a body of `radius_m` fills while it drives `free_m` ahead, m, if it
/// needs `width` times its width; 0 if the beam does not point ahead.
fn length_within_m(mount: &Vector2<f64>, beam: &Vector2<f64>, radius_m: f64, width: f64, free_m: f64) -> f64 {
    if beam.x <= 0.0 {
        return 0.0;
    }
    let side_m = if beam.y == 0.0 {
        f64::INFINITY
    } else {
        (width * radius_m - mount.y * beam.y.signum()) / beam.y.abs()
    };
    // Through the round front: the farther root of |mount + t·beam − front| = radius.
    let to_front = Vector2::new(free_m, 0.0) - mount;
    let b = to_front.dot(beam);
    let root2 = b * b - to_front.norm_squared() + radius_m * radius_m;
    let front_m = if root2 > 0.0 { b + root2.sqrt() } else { f64::INFINITY };
    side_m.min(front_m.max(0.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_space_ahead_is_the_body_moved_on() {
        let middle = Vector2::zeros();
        let beam = |degrees: f64| {
            let (y, x) = libm::sincos(degrees.to_radians());
            Vector2::new(x, y)
        };
        assert!((length_within_m(&middle, &beam(0.0), 0.2, WIDTH, 0.5) - 0.7).abs() < 1e-12);
        let aside_m = 0.22 / libm::sin(80_f64.to_radians());
        assert!((length_within_m(&middle, &beam(80.0), 0.2, WIDTH, 0.5) - aside_m).abs() < 1e-12);
        assert_eq!(length_within_m(&middle, &beam(120.0), 0.2, WIDTH, 0.5), 0.0);
        // The body touches the point where a beam ends exactly when it has driven that far.
        for degrees in [-60.0, -20.0, 3.0, 15.0, 40.0] {
            let mount = Vector2::new(0.1, 0.05);
            let end = mount + beam(degrees) * length_within_m(&mount, &beam(degrees), 0.2, WIDTH, 0.5);
            let at_front = (end - Vector2::new(0.5, 0.0)).norm();
            assert!((at_front - 0.2).abs() < 1e-9 || (end.y.abs() - 0.22).abs() < 1e-9, "{degrees}: {end}");
        }
    }
}
