use super::pace::{HEADING_GAIN, Pace};
use crate::physics::rays::Beams;
use crate::physics::snapshot::{Played, Tape, Torn};
use crate::physics::spec::{Repeat, RobotSpec, WaypointsSpec};
use interfaces::{LaserReading, Twist};
use nalgebra::{Point2, UnitComplex, Vector2};

/// A waypoint counts as reached this near, m.
const ARRIVED_M: f64 = 0.02;
/// A thing is in the way if less than this is left beside it at the waypoint, m.
const END_MARGIN_M: f64 = 0.03;
/// The robot turns in place beyond the first angle off its way, and drives again within the
/// second, rad.
const TURN_BEYOND_RAD: f64 = 0.5;
const TURNED_RAD: f64 = 0.03;
/// Free space kept beside the body, m: less than what the way is known to keep from walls.
const SIDE_MARGIN_M: f64 = 0.03;
/// Once stopped, so much more space must be free to go on, m.
const HYSTERESIS_M: f64 = 0.05;

/// A mind that drives straight from point to point by odometry, turns in place where the way
/// bends, and waits while its laser shows something in its way.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Waypoints {
    spec: WaypointsSpec,
    radius_m: f64,
    beams: Vec<Vector2<f64>>,
    pace: Pace,
    /// The point it is on its way to; `None` at the end of all.
    next: Option<usize>,
    is_back: bool,
    turning: bool,
    blocked: bool,
}

impl Waypoints {
    pub(super) fn new(spec: WaypointsSpec, robot: &RobotSpec, step_s: f64, beams: &Beams) -> Self {
        Self {
            radius_m: robot.radius_m,
            beams: super::in_robot_frame(robot, beams),
            pace: Pace::new(robot, spec.speed_mps, step_s),
            spec,
            next: Some(0),
            is_back: false,
            turning: false,
            blocked: false,
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.option(&mut self.next, || 0, Tape::usize)?;
        if self.next.is_some_and(|next| next >= self.spec.points.len()) {
            return Err(Torn);
        }
        [&mut self.is_back, &mut self.turning, &mut self.blocked]
            .into_iter()
            .try_for_each(|flag| tape.bool(flag))
    }

    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        let at = Point2::from(reading.pose.translation.vector);
        // At most once around: where all points are within reach, there is nothing to do.
        for _ in 0..self.spec.points.len() {
            let Some(next) = self.next else { return Twist::STOP };
            let way = self.spec.points[next] - at;
            let remaining_m = way.norm();
            if remaining_m >= ARRIVED_M {
                return self.drive(reading, &(way / remaining_m), remaining_m);
            }
            self.next = self.after(next);
        }
        Twist::STOP
    }

    /// The point after one that was reached.
    fn after(&mut self, point: usize) -> Option<usize> {
        let last = self.spec.points.len() - 1;
        match self.spec.repeat {
            Repeat::Once => (point < last).then_some(point + 1),
            Repeat::Loop => Some(if point < last { point + 1 } else { 0 }),
            Repeat::BackAndForth => {
                self.is_back = if self.is_back { point > 0 } else { point == last };
                Some(if self.is_back { point.saturating_sub(1) } else { (point + 1).min(last) })
            }
        }
    }

    fn drive(&mut self, reading: &LaserReading, along: &Vector2<f64>, remaining_m: f64) -> Twist {
        // The robot's heading as seen from its way, and with it everything that it sees.
        let way = UnitComplex::from_cos_sin_unchecked(along.x, along.y);
        let lean = way.inverse() * reading.pose.rotation;
        let lean_rad = libm::atan2(lean.im, lean.re);
        self.turning = lean_rad.abs() > if self.turning { TURNED_RAD } else { TURN_BEYOND_RAD };
        if self.turning {
            return Twist { linear_mps: 0.0, angular_radps: self.pace.turn_radps(-lean_rad) };
        }
        let hysteresis_m = if self.blocked { HYSTERESIS_M } else { 0.0 };
        let needed_m = self.spec.clearance_m + self.pace.stopping_m + hysteresis_m;
        // What lies behind the waypoint is not in the way.
        self.blocked = self.gap_m(reading, &lean) < needed_m.min(remaining_m + END_MARGIN_M);
        if self.blocked {
            return Twist::STOP;
        }
        Twist { linear_mps: self.pace.approach_mps(remaining_m), angular_radps: -HEADING_GAIN * lean_rad }
    }

    /// How far the body could go on its way before it touches something that the laser sees, m.
    fn gap_m(&self, reading: &LaserReading, lean: &UnitComplex<f64>) -> f64 {
        let mount = reading.mount.translation.vector;
        let open_m = self.radius_m + SIDE_MARGIN_M;
        let mut gap_m = f64::INFINITY;
        for (range_m, beam) in reading.scan.ranges_m.iter().zip(&self.beams) {
            if !range_m.is_finite() {
                continue;
            }
            let point = lean * (mount + beam * f64::from(*range_m));
            if point.x > 0.0 && point.y.abs() < open_m {
                let nose_m = (self.radius_m * self.radius_m - point.y * point.y).max(0.0).sqrt();
                gap_m = gap_m.min(point.x - nose_m);
            }
        }
        gap_m
    }
}
