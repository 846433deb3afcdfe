use super::legs::Legs;
use crate::physics::rays::Beams;
use crate::physics::snapshot::{Values, value};
use crate::physics::spec::{Repeat, RobotSpec, WaypointsSpec};
use interfaces::{LaserReading, Twist};
use nalgebra::Point2;

/// A waypoint counts as reached within this distance, m.
const ARRIVED_M: f64 = 0.02;
/// The free space that is kept beside the body, m: less than the distance that the legs are known to keep from
/// walls.
const SIDE_MARGIN_M: f64 = 0.03;

/// Drives straight from point to point by odometry, turns in place at the points, and waits while the laser
/// measures an obstacle in the way.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Waypoints {
    spec: WaypointsSpec,
    legs: Legs,
    /// The index of the next point; `None` after the last one.
    next: Option<usize>,
    is_returning: bool,
}

impl Waypoints {
    pub(super) fn new(spec: WaypointsSpec, robot: &RobotSpec, step_s: f64, beams: &Beams) -> Self {
        let legs = Legs::new(robot, spec.speed_mps, spec.clearance_m, step_s, beams);
        Self { spec, legs, next: Some(0), is_returning: false }
    }

    /// The index of the point after `point`.
    fn after(&mut self, point: usize) -> Option<usize> {
        let last = self.spec.points.len() - 1;
        match self.spec.repeat {
            Repeat::Once => (point < last).then_some(point + 1),
            Repeat::Loop => Some(if point < last { point + 1 } else { 0 }),
            Repeat::BackAndForth => {
                self.is_returning = if self.is_returning { point > 0 } else { point == last };
                Some(if self.is_returning { point.saturating_sub(1) } else { (point + 1).min(last) })
            }
        }
    }

    /// The velocity until the next reading.
    pub(super) fn decide(&mut self, reading: &LaserReading) -> Twist {
        let at = Point2::from(reading.pose.translation.vector);
        // At most one round: if all points are within reach, the robot has nothing to do.
        for _ in 0..self.spec.points.len() {
            let Some(next) = self.next.filter(|next| *next < self.spec.points.len()) else { break };
            let leg = self.spec.points[next] - at;
            let remaining_m = leg.norm();
            if remaining_m >= ARRIVED_M {
                return self.legs.drive(reading, &(leg / remaining_m), remaining_m, |legs, lean| {
                    let open_m = legs.radius_m + SIDE_MARGIN_M;
                    let points = legs.points(reading, lean);
                    let ahead = points.filter(|point| point.x > 0.0 && point.y.abs() < open_m);
                    (ahead.fold(f64::INFINITY, |gap_m, point| gap_m.min(legs.gap_m(&point))), 0.0)
                });
            }
            self.next = self.after(next);
        }
        Twist::STOP
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        let mut values = vec![value(&mut self.next), value(&mut self.is_returning)];
        values.extend(self.legs.values());
        values
    }
}
