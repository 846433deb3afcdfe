use crate::physics::command::{Command, Velocity};
use crate::physics::drives::Drive;
use crate::physics::snapshot::{Values, value};
use nalgebra::Isometry2;

/// The wheels of a robot. While a contact changes the velocity of the robot, they slip: they turn like wheels that no
/// contact stops. They move nothing, but the odometry measures them.
#[derive(Clone)]
pub(super) struct Wheels {
    /// From 0 to 1, see [`crate::physics::OdometryError::slip`].
    slip: f64,
    /// A drive that follows the commands without contacts.
    free: Drive,
    /// What the odometry measures in addition to the velocity of the robot.
    slipping: Velocity,
}

impl Wheels {
    pub(super) fn new(slip: f64, drive: Drive) -> Self {
        Self { slip, free: drive, slipping: Velocity::STOP }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        let mut values = self.free.values();
        values.push(value(&mut self.slipping));
        values
    }

    /// Starts a step with a command; `drive` is the drive of the robot before the step, `at` the pose by odometry.
    pub(super) fn start_step(&mut self, drive: &Drive, command: &Command, at: &Isometry2<f64>, step_s: f64) {
        if self.slip == 0.0 {
            return;
        }
        if !drive.is_stalled() {
            self.free = *drive;
        }
        self.free.step(command, at, step_s);
    }

    /// Ends a step; `drive` is the drive of the robot after it, `solved` the velocity of the robot after contacts.
    pub(super) fn end_step(&mut self, drive: &Drive, solved: &Velocity) {
        self.slipping = Velocity::STOP;
        if self.slip > 0.0 && drive.is_stalled() {
            let (free, slip) = (self.free.velocity(), self.slip);
            self.slipping = Velocity {
                forward_mps: slip * (free.forward_mps - solved.forward_mps),
                left_mps: slip * (free.left_mps - solved.left_mps),
                turn_radps: slip * (free.turn_radps - solved.turn_radps),
            };
        }
    }

    /// What the odometry measures in addition to the velocity of the robot.
    pub(super) fn slipping(&self) -> &Velocity {
        &self.slipping
    }
}
