use super::chance::Gaussian;
use super::snapshot::{Played, Tape};
use super::spec::OdometryError;
use geometry::{Twist, pose, wrap_rad};
use nalgebra::{Isometry2, Vector2};

/// What a robot feels of its own motion, added up since the start.
#[derive(Clone, Debug)]
pub(super) struct Odometry {
    error: OdometryError,
    noise: Gaussian,
    /// Where the robot believes it is.
    pose: Isometry2<f64>,
    /// The same heading, rad, free of rounding by turning.
    heading_rad: f64,
}

impl Odometry {
    /// A robot knows where it starts.
    pub(super) fn new(error: OdometryError, noise: Gaussian, start: Isometry2<f64>) -> Self {
        Self { error, noise, pose: start, heading_rad: geometry::heading_rad(&start) }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        self.noise.play(tape)?;
        tape.pose(&mut self.pose)?;
        tape.f64(&mut self.heading_rad)
    }

    /// It is set down somewhere, and knows where.
    pub(super) fn restart(&mut self, at: Isometry2<f64>) {
        self.pose = at;
        self.heading_rad = geometry::heading_rad(&at);
    }

    pub(super) fn pose(&self) -> &Isometry2<f64> {
        &self.pose
    }

    /// The felt velocity at a true velocity.
    pub(super) fn twist(&self, velocity: &Twist) -> Twist {
        let OdometryError { distance_gain, turn_gain, turn_radpm, .. } = self.error;
        Twist {
            linear_mps: velocity.linear_mps * (1.0 + distance_gain),
            angular_radps: velocity.angular_radps * (1.0 + turn_gain) + velocity.linear_mps * turn_radpm,
        }
    }

    /// Feels the motion from pose `before` to pose `after` in one physics step.
    pub(super) fn feel(&mut self, before: &Isometry2<f64>, after: &Isometry2<f64>) {
        if self.error == OdometryError::default() {
            self.pose = *after;
            return;
        }
        let OdometryError { distance_gain, turn_gain, turn_radpm, distance_noise_m, turn_noise_rad } =
            self.error;
        let turn_rad = wrap_rad(geometry::heading_rad(after) - geometry::heading_rad(before));
        let moved = geometry::rotation(-geometry::heading_rad(before) - turn_rad / 2.0)
            * (after.translation.vector - before.translation.vector);
        let distance_m = moved.norm();
        // A random walk: the variance grows with the way, however it is cut into steps.
        let slip_m = distance_noise_m * distance_m.sqrt() * self.noise.draw();
        let swerve_rad = turn_noise_rad * turn_rad.abs().sqrt() * self.noise.draw();
        let felt = moved * (1.0 + distance_gain) + Vector2::new(slip_m, 0.0);
        let felt_turn_rad = turn_rad * (1.0 + turn_gain) + moved.x * turn_radpm + swerve_rad;
        let at =
            self.pose.translation.vector + geometry::rotation(self.heading_rad + felt_turn_rad / 2.0) * felt;
        self.heading_rad = wrap_rad(self.heading_rad + felt_turn_rad);
        self.pose = pose(at.x, at.y, self.heading_rad);
    }
}
