//! The odometry of a robot, with wheels that slip, and displacements.

use crate::physics::drives::Velocity;
use crate::physics::snapshot::{self, value};
use crate::physics::spec::{DisplacementSpec, OdometryError, RobotSpec};
use interfaces::{RandomStream, Twist, Values, pose, rotation, values, wrap_rad};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::PI;

/// The pose of a robot by odometry: the sum of its measured motions since the start.
#[derive(Clone, Debug)]
pub(super) struct Odometry {
    error: OdometryError,
    /// Whether the wheels roll in every direction, not only forward and backward.
    is_omni: bool,
    noise: RandomStream,
    pub(super) pose: Isometry2<f64>,
    /// The heading of `pose`, rad, without the rounding of repeated rotation.
    heading_rad: f64,
}

impl Odometry {
    /// Odometry starts at the true pose.
    pub(super) fn new(robot: &RobotSpec, noise: RandomStream, start: Isometry2<f64>) -> Self {
        Self {
            error: robot.odometry,
            is_omni: robot.drive.is_omni(),
            noise,
            pose: start,
            heading_rad: interfaces::heading_rad(&start),
        }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.noise), snapshot::pose(&mut self.pose), value(&mut self.heading_rad)]
    }

    /// Starts again at a true pose.
    pub(super) fn restart(&mut self, at: Isometry2<f64>) {
        self.pose = at;
        self.heading_rad = interfaces::heading_rad(&at);
    }

    /// The measured velocity at a true velocity.
    pub(super) fn twist(&self, velocity: &Twist) -> Twist {
        let OdometryError { distance_gain, turn_gain, turn_radpm, .. } = self.error;
        Twist {
            linear_mps: velocity.linear_mps * (1.0 + distance_gain),
            angular_radps: velocity.angular_radps * (1.0 + turn_gain) + velocity.linear_mps * turn_radpm,
        }
    }

    /// Changes the pose, although the robot did not move.
    pub(super) fn jump(&mut self, jumps: &mut Displacements) {
        let (at, heading_rad) = jumps.draw(&self.pose.translation.vector.into(), self.heading_rad);
        self.heading_rad = wrap_rad(heading_rad);
        self.pose = pose(at.x, at.y, self.heading_rad);
    }

    /// Measures the motion from pose `before` to pose `after` in one physics step, and in addition wheels that slip at
    /// the velocity `slipping`.
    pub(super) fn update(
        &mut self,
        before: &Isometry2<f64>,
        after: &Isometry2<f64>,
        slipping: &Velocity,
        step_s: f64,
    ) {
        if self.error.is_exact() {
            self.pose = *after;
            return;
        }
        let OdometryError { distance_gain, turn_gain, turn_radpm, distance_noise_m, turn_noise_rad, .. } =
            self.error;
        let turn_rad = wrap_rad(interfaces::heading_rad(after) - interfaces::heading_rad(before));
        let moved = rotation(-interfaces::heading_rad(before) - turn_rad / 2.0)
            * (after.translation.vector - before.translation.vector);
        // Of the wheels, not of the robot. Without slip not a bit changes.
        let turn_rad = turn_rad + slipping.turn_radps * step_s;
        let moved = moved + Vector2::new(slipping.forward_mps, slipping.left_mps) * step_s;
        let distance_m = moved.norm();
        // A random walk: the variance grows with the distance, whatever the length of the steps.
        let noise_m = distance_noise_m * distance_m.sqrt() * self.noise.normal();
        let swerve_rad = turn_noise_rad * turn_rad.abs().sqrt() * self.noise.normal();
        // The noise acts in the direction in which the wheels roll.
        let along = if self.is_omni && distance_m > 0.0 { moved / distance_m } else { Vector2::x() };
        let measured = moved * (1.0 + distance_gain) + along * noise_m;
        let measured_turn_rad = turn_rad * (1.0 + turn_gain) + moved.x * turn_radpm + swerve_rad;
        let at =
            self.pose.translation.vector + rotation(self.heading_rad + measured_turn_rad / 2.0) * measured;
        self.heading_rad = wrap_rad(self.heading_rad + measured_turn_rad);
        self.pose = pose(at.x, at.y, self.heading_rad);
    }
}

/// Displacements that are due at random times.
#[derive(Clone)]
pub(crate) struct Displacements {
    spec: DisplacementSpec,
    random: RandomStream,
    /// The time of the next displacement, s.
    next_s: f64,
}

impl Displacements {
    /// The first displacement is a random time after the start.
    pub(super) fn new(spec: DisplacementSpec, mut random: RandomStream) -> Self {
        let next_s = random.exponential(spec.every_s);
        Self { spec, random, next_s }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        values![self.random, self.next_s]
    }

    /// The time of the next displacement, s.
    pub(crate) fn next_s(&self) -> f64 {
        self.next_s
    }

    /// Whether a displacement is due at a time (s). The next one is then a random time later.
    pub(crate) fn is_due(&mut self, time_s: f64) -> bool {
        let is_due = time_s >= self.next_s;
        if is_due {
            // From now on, and not from the time at which it was due: never twice in one step.
            self.next_s = time_s + self.random.exponential(self.spec.every_s);
        }
        is_due
    }

    /// A random place (m) and heading (rad) that differ from the given ones by a displacement.
    pub(crate) fn draw(&mut self, from: &Point2<f64>, heading_rad: f64) -> (Point2<f64>, f64) {
        let DisplacementSpec { distance_m, turn_rad, .. } = self.spec;
        let direction_rad = self.random.uniform(-PI..PI);
        // The square root makes it uniform in the disc.
        let away_m = distance_m * self.random.uniform(0.0..1.0).sqrt();
        let turn_rad = self.random.uniform(-turn_rad..turn_rad);
        (from + rotation(direction_rad) * Vector2::x() * away_m, heading_rad + turn_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::spec::{BehaviorSpec, DriveKind};
    use interfaces::Purpose;

    /// The standard deviation of where a robot believes it is after 1 m in a direction, m: along the way
    /// and across.
    fn spread_m(kind: &str, towards: Vector2<f64>) -> [f64; 2] {
        let mut robot = RobotSpec::new("a", pose(1.0, 1.0, 0.0), BehaviorSpec::Standing);
        robot.odometry.distance_noise_m = 0.1;
        if kind == "omni" {
            robot.drive.kind = DriveKind::Omni { max_left_mps: 0.5, max_left_acceleration_mps2: 1.0 };
        }
        let errors = (0..4000).map(|seed| {
            let noise = RandomStream::new(seed, Purpose::OdometryNoise(0));
            let mut odometry = Odometry::new(&robot, noise, Isometry2::identity());
            for step in 0..10 {
                let at = |step: i32| Isometry2::new(towards * f64::from(step) * 0.1, 0.0);
                odometry.update(&at(step), &at(step + 1), &Velocity::STOP, 0.05);
            }
            let error = odometry.pose.translation.vector - towards;
            [error.dot(&towards), error.perp(&towards)]
        });
        let squares = errors.fold([0.0; 2], |sum, error| [0, 1].map(|i| sum[i] + error[i] * error[i]));
        squares.map(|sum: f64| (sum / 4000.0).sqrt())
    }

    #[test]
    fn wheels_slip_in_the_direction_of_motion() {
        let aslant = Vector2::new(-0.6, 0.8);
        for (kind, towards) in [
            ("diff", Vector2::x()),
            ("diff", -Vector2::x()),
            ("omni", Vector2::x()),
            ("omni", -Vector2::y()),
            ("omni", aslant),
        ] {
            let [along_m, across_m] = spread_m(kind, towards);
            // Of 4000, the deviation of the deviation is about 1 %.
            assert!(
                (along_m - 0.1).abs() < 0.005 && across_m < 1e-9,
                "{kind}, {towards}: {along_m}, {across_m}"
            );
        }
    }
}
