use super::pace::{HEADING_GAIN, Pace};
use crate::physics::rays::Beams;
use crate::physics::snapshot::{Values, value};
use crate::physics::spec::RobotSpec;
use interfaces::{LaserReading, Twist};
use nalgebra::{UnitComplex, Vector2};

/// The robot turns in place if its heading differs from the leg by more than the first angle, and drives again if
/// the difference is below the second angle, rad.
const TURN_BEYOND_RAD: f64 = 0.5;
const TURNED_RAD: f64 = 0.03;
/// An obstacle is in the way if less than this space is left between it and the robot at the end of the leg, m.
const END_MARGIN_M: f64 = 0.03;
/// After a stop, this much additional space must be free before the robot continues, m: this avoids stop-and-go at
/// the limit.
const HYSTERESIS_M: f64 = 0.05;

/// Drives along straight legs by odometry: the robot turns in place if the next leg has another direction, and
/// stops while the laser measures an obstacle ahead.
#[derive(Clone, Debug)]
pub(super) struct Legs {
    pub(super) radius_m: f64,
    clearance_m: f64,
    /// The unit vectors of the beams of the laser in the frame of the robot.
    beams: Vec<Vector2<f64>>,
    pace: Pace,
    turning: bool,
    blocked: bool,
}

impl Legs {
    pub(super) fn new(
        robot: &RobotSpec,
        speed_mps: f64,
        clearance_m: f64,
        step_s: f64,
        beams: &Beams,
    ) -> Self {
        Self {
            radius_m: robot.radius_m,
            clearance_m,
            beams: super::in_robot_frame(robot, beams),
            pace: Pace::new(robot, speed_mps, step_s),
            turning: false,
            blocked: false,
        }
    }

    /// The unit vectors of the beams of the laser in the frame of the robot.
    pub(super) fn beams(&self) -> &[Vector2<f64>] {
        &self.beams
    }

    /// Whether something was in the way at the last reading.
    pub(super) fn is_blocked(&self) -> bool {
        self.blocked
    }

    /// The free distance ahead, m, below which the robot stops.
    pub(super) fn needed_m(&self) -> f64 {
        self.clearance_m + self.pace.stopping_m
    }

    /// Starts a new leg with a turn in place, to the exact direction of the leg.
    pub(super) fn start_turning(&mut self) {
        (self.turning, self.blocked) = (true, false);
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.turning), value(&mut self.blocked)]
    }

    /// The velocity on the leg in the direction of the unit vector `along`, `remaining_m` before its end. `look`
    /// receives the rotation from the frame of the robot to the frame of the leg, and returns the free distance
    /// ahead, m, and the heading to steer to, rad from the direction of the leg.
    pub(super) fn drive(
        &mut self,
        reading: &LaserReading,
        along: &Vector2<f64>,
        remaining_m: f64,
        look: impl FnOnce(&Self, &UnitComplex<f64>) -> (f64, f64),
    ) -> Twist {
        let lean = UnitComplex::from_cos_sin_unchecked(along.x, along.y).inverse() * reading.pose.rotation;
        let lean_rad = libm::atan2(lean.im, lean.re);
        self.turning = lean_rad.abs() > if self.turning { TURNED_RAD } else { TURN_BEYOND_RAD };
        if self.turning {
            return Twist { linear_mps: 0.0, angular_radps: self.pace.turn_radps(-lean_rad) };
        }
        let (gap_m, heading_rad) = look(self, &lean);
        let hysteresis_m = if self.blocked { HYSTERESIS_M } else { 0.0 };
        let needed_m = self.needed_m() + hysteresis_m;
        // A body behind the end of the leg is not in the way.
        self.blocked = gap_m < needed_m.min(remaining_m + END_MARGIN_M);
        if self.blocked {
            return Twist::STOP;
        }
        Twist {
            linear_mps: self.pace.approach_mps(remaining_m),
            angular_radps: HEADING_GAIN * (heading_rad - lean_rad),
        }
    }

    /// The end points of the beams, in the frame of the leg, m.
    pub(super) fn points(
        &self,
        reading: &LaserReading,
        lean: &UnitComplex<f64>,
    ) -> impl Iterator<Item = Vector2<f64>> {
        let mount = reading.mount.translation.vector;
        let ranges_m = reading.scan.ranges_m.iter().zip(&self.beams);
        let points = ranges_m.filter(|(range_m, _)| range_m.is_finite());
        points.map(move |(range_m, beam)| lean * (mount + beam * f64::from(*range_m)))
    }

    /// The distance that the round body can drive along the leg, m, with a free space at both sides.
    pub(super) fn free_m(&self, reading: &LaserReading, lean: &UnitComplex<f64>, side_margin_m: f64) -> f64 {
        let open_m = self.radius_m + side_margin_m;
        let ahead = self.points(reading, lean).filter(|point| point.x > 0.0 && point.y.abs() < open_m);
        ahead.fold(f64::INFINITY, |free_m, point| free_m.min(self.gap_m(&point)))
    }

    /// The distance that the round body can drive before it touches a point ahead, m.
    pub(super) fn gap_m(&self, point: &Vector2<f64>) -> f64 {
        let nose_m = (self.radius_m * self.radius_m - point.y * point.y).max(0.0).sqrt();
        point.x - nose_m
    }
}
