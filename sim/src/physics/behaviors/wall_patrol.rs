use super::Chassis;
use super::legs::{LegScan, Legs};
use crate::physics::spec::PatrolSpec;
use interfaces::{LaserReading, Twist, Values, values};
use nalgebra::{Point2, Vector2};

/// The end of a leg counts as reached at this distance, m.
const ARRIVED_M: f64 = 0.01;
/// Points nearer to the expected wall than this belong to the wall, m.
const WALL_SLACK_M: f64 = 0.1;
/// The free space that is kept on the open side, m.
const SIDE_MARGIN_M: f64 = 0.05;
/// Steering toward the distance of the wall, rad per m, and its bound, rad.
const LATERAL_GAIN: f64 = 2.0;
const MAX_LEAN_RAD: f64 = 0.25;

/// The behavior of the dummy robot (paper, section 5): the robot drives back and forth between two points, keeps
/// its distance to the wall by laser and its heading by odometry, turns in place at the ends, and stops while
/// anything else is in its way.
#[derive(Clone, Debug)]
pub(crate) struct WallPatrol {
    spec: PatrolSpec,
    legs: Legs,
    /// Whether the robot drives toward `to`; otherwise toward `from`.
    outbound: bool,
}

impl WallPatrol {
    pub(super) fn new(spec: PatrolSpec, chassis: Chassis) -> Self {
        let legs = Legs::new(chassis, spec.speed_mps, spec.clearance_m);
        Self { spec, legs, outbound: true }
    }

    /// The direction of the present leg, and the remaining distance, m.
    fn leg(&self, at: &Point2<f64>) -> (Vector2<f64>, f64) {
        let PatrolSpec { from, to, .. } = self.spec;
        let (start, goal) = if self.outbound { (from, to) } else { (to, from) };
        let along = (goal - start).normalize();
        (along, along.dot(&(goal - at)))
    }

    /// The velocity until the next reading.
    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        let at = Point2::from(reading.pose.translation.vector);
        let (mut along, mut remaining_m) = self.leg(&at);
        if remaining_m < ARRIVED_M {
            self.outbound = !self.outbound;
            (along, remaining_m) = self.leg(&at);
        }
        // +1: the wall is on the left of the leg; −1: on the right.
        let side = if self.spec.wall_on_left == self.outbound { 1.0 } else { -1.0 };
        self.legs.drive(reading, &along, remaining_m, |legs, scan| {
            let (wall_m, gap_m) = wall_and_gap_m(&self.spec, side, legs, scan, remaining_m);
            let too_far_m = wall_m.map_or(0.0, |wall_m| wall_m - self.spec.wall_distance_m);
            (gap_m, side * (LATERAL_GAIN * too_far_m).clamp(-MAX_LEAN_RAD, MAX_LEAN_RAD))
        })
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        values![self.outbound; self.legs]
    }
}

/// Divides the points of a scan into the wall beside the robot and bodies ahead: the distance to the wall, m, if the
/// laser sees the wall, and the free distance ahead, m. What is too close measures no wall. The leg ends `end_m` ahead.
fn wall_and_gap_m(
    spec: &PatrolSpec,
    side: f64,
    legs: &Legs,
    scan: &LegScan,
    end_m: f64,
) -> (Option<f64>, f64) {
    let (wall_m, open_m) = (spec.wall_distance_m, legs.radius_m + SIDE_MARGIN_M);
    let walled_m = open_m.min(wall_m - PatrolSpec::WALL_RELIEF_M);
    let (mut sum_m, mut count, mut gap_m) = (0.0, 0.0, f64::INFINITY);
    let measured = legs.points(scan).map(|point| (point, true));
    let too_close = legs.too_close(scan, end_m).map(|point| (point, false));
    for (point, is_measured) in measured.chain(too_close) {
        let toward_wall_m = point.y * side;
        let is_wall = (toward_wall_m - wall_m).abs() < WALL_SLACK_M && point.x.abs() < 2.0 * legs.radius_m;
        if is_measured && is_wall {
            sum_m += toward_wall_m;
            count += 1.0;
        }
        if point.x > 0.0 && toward_wall_m < walled_m && toward_wall_m > -open_m {
            gap_m = gap_m.min(legs.gap_m(&point));
        }
    }
    ((count > 0.0).then(|| sum_m / count), gap_m)
}
