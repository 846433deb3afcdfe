use super::pace::{HEADING_GAIN, Pace};
use crate::physics::rays::Beams;
use crate::physics::snapshot::{Played, Tape};
use crate::physics::spec::{PatrolSpec, RobotSpec};
use interfaces::{LaserReading, Twist};
use nalgebra::{Point2, UnitComplex, Vector2};

/// The end of the way counts as reached this far before it, m.
const ARRIVED_M: f64 = 0.01;
/// A thing is in the way if less than this is left beside it at the end of the way, m.
const END_MARGIN_M: f64 = 0.03;
/// The robot turns in place beyond the first angle off its way, and drives again within the
/// second, rad.
const TURN_BEYOND_RAD: f64 = 0.5;
const TURNED_RAD: f64 = 0.03;
/// End points this near to where the wall should be are the wall, m.
const WALL_SLACK_M: f64 = 0.1;
/// Things that stand out from the wall by more than this are in the way, m.
const WALL_RELIEF_M: f64 = PatrolSpec::WALL_RELIEF_M;
/// Free space kept on the open side, m.
const SIDE_MARGIN_M: f64 = 0.05;
/// Once stopped, so much more space must be free to go on, m: no stop and go at the limit.
const HYSTERESIS_M: f64 = 0.05;
/// Steering towards the wall's distance, rad per m, and its bound, rad.
const LATERAL_GAIN: f64 = 2.0;
const MAX_LEAN_RAD: f64 = 0.25;

/// The dummy robot's mind (paper, section 5): it goes back and forth between two points, keeps its
/// distance to the wall beside it by laser and its heading by odometry, turns in place at the
/// ends, and stops for anything else in its way until that is gone.
#[derive(Clone, Debug)]
pub(in crate::physics) struct WallPatrol {
    spec: PatrolSpec,
    radius_m: f64,
    /// The unit vectors of the laser's beams in the robot's frame.
    beams: Vec<Vector2<f64>>,
    pace: Pace,
    /// Whether it is on its way to `to`; else to `from`.
    outbound: bool,
    turning: bool,
    blocked: bool,
}

impl WallPatrol {
    /// The mind of `robot`, whose laser has `beams` in its own frame.
    pub(super) fn new(spec: PatrolSpec, robot: &RobotSpec, step_s: f64, beams: &Beams) -> Self {
        Self {
            spec,
            radius_m: robot.radius_m,
            beams: super::in_robot_frame(robot, beams),
            pace: Pace::new(robot, spec.speed_mps, step_s),
            outbound: true,
            turning: false,
            blocked: false,
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        [&mut self.outbound, &mut self.turning, &mut self.blocked]
            .into_iter()
            .try_for_each(|flag| tape.bool(flag))
    }

    /// What to do until the next reading.
    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        let at = Point2::from(reading.pose.translation.vector);
        let (mut along, mut remaining_m) = self.leg(&at);
        if remaining_m < ARRIVED_M {
            self.outbound = !self.outbound;
            (along, remaining_m) = self.leg(&at);
        }
        // The robot's heading as seen from its way, and with it everything that it sees.
        let way = UnitComplex::from_cos_sin_unchecked(along.x, along.y);
        let lean = way.inverse() * reading.pose.rotation;
        let lean_rad = libm::atan2(lean.im, lean.re);
        self.turning = lean_rad.abs() > if self.turning { TURNED_RAD } else { TURN_BEYOND_RAD };
        if self.turning {
            return Twist { linear_mps: 0.0, angular_radps: self.pace.turn_radps(-lean_rad) };
        }
        let Sight { wall_m, gap_m } = self.look(reading, &lean);
        let needed_m =
            self.spec.clearance_m + self.pace.stopping_m + if self.blocked { HYSTERESIS_M } else { 0.0 };
        // What lies behind the end of the way is not in the way.
        self.blocked = gap_m < needed_m.min(remaining_m + END_MARGIN_M);
        let linear_mps = if self.blocked { 0.0 } else { self.pace.approach_mps(remaining_m) };
        let too_far_m = wall_m.map_or(0.0, |wall_m| wall_m - self.spec.wall_distance_m);
        let wanted_rad = self.wall_side() * (LATERAL_GAIN * too_far_m).clamp(-MAX_LEAN_RAD, MAX_LEAN_RAD);
        let angular_radps = if self.blocked { 0.0 } else { HEADING_GAIN * (wanted_rad - lean_rad) };
        Twist { linear_mps, angular_radps }
    }

    /// The direction of the present leg, and what remains of it, m.
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

    /// Sorts what the laser sees into the wall beside and things ahead; `lean` turns the robot's
    /// frame into the way's.
    fn look(&self, reading: &LaserReading, lean: &UnitComplex<f64>) -> Sight {
        let wall_m = self.spec.wall_distance_m;
        let side = self.wall_side();
        let open_m = self.radius_m + SIDE_MARGIN_M;
        let walled_m = open_m.min(wall_m - WALL_RELIEF_M);
        let mount = reading.mount.translation.vector;
        let (mut sum_m, mut count, mut gap_m) = (0.0, 0.0, f64::INFINITY);
        for (range_m, beam) in reading.scan.ranges_m.iter().zip(&self.beams) {
            if !range_m.is_finite() {
                continue;
            }
            let point = lean * (mount + beam * f64::from(*range_m));
            let toward_wall_m = point.y * side;
            if (toward_wall_m - wall_m).abs() < WALL_SLACK_M && point.x.abs() < 2.0 * self.radius_m {
                sum_m += toward_wall_m;
                count += 1.0;
            }
            if point.x > 0.0 && toward_wall_m < walled_m && toward_wall_m > -open_m {
                // How far the round body can go before it touches the point.
                let nose_m = (self.radius_m * self.radius_m - point.y * point.y).max(0.0).sqrt();
                gap_m = gap_m.min(point.x - nose_m);
            }
        }
        Sight { wall_m: (count > 0.0).then(|| sum_m / count), gap_m }
    }
}

/// What matters of a scan.
struct Sight {
    /// The distance from the robot's middle to the wall, m, if it is seen.
    wall_m: Option<f64>,
    /// The free way ahead of the robot's body, m.
    gap_m: f64,
}
