use super::Behavior;
use super::legs::Legs;
use super::pace::HEADING_GAIN;
use crate::physics::rays::Beams;
use crate::physics::snapshot::{Values, value};
use crate::physics::spec::{PatrolSpec, RobotSpec};
use interfaces::{LaserReading, Twist};
use nalgebra::{Point2, UnitComplex, Vector2};

/// The end of a leg counts as reached this far before it, m.
const ARRIVED_M: f64 = 0.01;
/// Points this near to the expected wall belong to the wall, m.
const WALL_SLACK_M: f64 = 0.1;
/// Free space kept on the open side, m.
const SIDE_MARGIN_M: f64 = 0.05;
/// Steering towards the distance of the wall, rad per m, and its bound, rad.
const LATERAL_GAIN: f64 = 2.0;
const MAX_LEAN_RAD: f64 = 0.25;

/// The behavior of the dummy robot (paper, section 5): it drives back and forth between two points, keeps
/// its distance to the wall by laser and its heading by odometry, turns in place at the ends, and stops while
/// anything else is in its way.
#[derive(Clone, Debug)]
pub(super) struct WallPatrol {
    spec: PatrolSpec,
    legs: Legs,
    /// Whether the robot drives towards `to`; otherwise towards `from`.
    outbound: bool,
}

impl WallPatrol {
    pub(super) fn new(spec: PatrolSpec, robot: &RobotSpec, step_s: f64, beams: &Beams) -> Self {
        let legs = Legs::new(robot, spec.speed_mps, spec.clearance_m, step_s, beams);
        Self { spec, legs, outbound: true }
    }

    /// The direction of the present leg, and the remaining distance, m.
    fn leg(&self, at: &Point2<f64>) -> (Vector2<f64>, f64) {
        let PatrolSpec { from, to, .. } = self.spec;
        let (start, goal) = if self.outbound { (from, to) } else { (to, from) };
        let along = (goal - start).normalize();
        (along, along.dot(&(goal - at)))
    }

    /// +1: the wall is on the left of the present leg; −1: on the right.
    fn wall_side(&self) -> f64 {
        if self.spec.wall_on_left == self.outbound { 1.0 } else { -1.0 }
    }

    /// Divides the points of a scan into the wall beside the robot and bodies ahead: the distance to the
    /// wall, m, if the laser sees the wall, and the free distance ahead, m.
    fn wall_and_gap_m(&self, reading: &LaserReading, lean: &UnitComplex<f64>) -> (Option<f64>, f64) {
        let wall_m = self.spec.wall_distance_m;
        let (side, radius_m) = (self.wall_side(), self.legs.radius_m);
        let open_m = radius_m + SIDE_MARGIN_M;
        let walled_m = open_m.min(wall_m - PatrolSpec::WALL_RELIEF_M);
        let (mut sum_m, mut count, mut gap_m) = (0.0, 0.0, f64::INFINITY);
        for point in self.legs.points(reading, lean) {
            let toward_wall_m = point.y * side;
            if (toward_wall_m - wall_m).abs() < WALL_SLACK_M && point.x.abs() < 2.0 * radius_m {
                sum_m += toward_wall_m;
                count += 1.0;
            }
            if point.x > 0.0 && toward_wall_m < walled_m && toward_wall_m > -open_m {
                gap_m = gap_m.min(self.legs.gap_m(&point));
            }
        }
        ((count > 0.0).then(|| sum_m / count), gap_m)
    }
}

impl Behavior for WallPatrol {
    fn decide(&mut self, reading: &LaserReading) -> Twist {
        let at = Point2::from(reading.pose.translation.vector);
        let (mut along, mut remaining_m) = self.leg(&at);
        if remaining_m < ARRIVED_M {
            self.outbound = !self.outbound;
            (along, remaining_m) = self.leg(&at);
        }
        let lean = Legs::lean(reading, &along);
        let lean_rad = libm::atan2(lean.im, lean.re);
        if let Some(turn) = self.legs.turn_in_place(lean_rad) {
            return turn;
        }
        let (wall_m, gap_m) = self.wall_and_gap_m(reading, &lean);
        if self.legs.is_blocked(gap_m, remaining_m) {
            return Twist::STOP;
        }
        let too_far_m = wall_m.map_or(0.0, |wall_m| wall_m - self.spec.wall_distance_m);
        let wanted_rad = self.wall_side() * (LATERAL_GAIN * too_far_m).clamp(-MAX_LEAN_RAD, MAX_LEAN_RAD);
        Twist {
            linear_mps: self.legs.pace.approach_mps(remaining_m),
            angular_radps: HEADING_GAIN * (wanted_rad - lean_rad),
        }
    }

    fn values(&mut self) -> Values<'_> {
        let mut values = vec![value(&mut self.outbound)];
        values.extend(self.legs.values());
        values
    }

    fn boxed(&self) -> Box<dyn Behavior> {
        Box::new(self.clone())
    }
}
