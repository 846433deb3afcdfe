use crate::physics::snapshot::{Values, pose, value};
use crate::physics::spec::RobotSpec;
use nalgebra::Isometry2;

/// How long a robot waits for a free way, s.
const PATIENCE_S: f64 = 5.0;
/// A robot that has moved this far, m, or turned this far, rad, does not wait; a slow robot needs to reach only a
/// share of the distance or angle that its limits allow in this time.
const MOVED_M: f64 = 0.05;
const TURNED_RAD: f64 = 0.2;
const SHARE: f64 = 0.2;

/// Notices that a robot does not get ahead, for whatever reason.
#[derive(Clone, Debug)]
pub(super) struct Patience {
    readings: u32,
    period_s: f64,
    moved_m: f64,
    /// The cosine of the angle that counts as a turn.
    turned_cos: f64,
    /// The pose from which the robot has not got ahead, and the number of readings since.
    from: Isometry2<f64>,
    waited: u32,
}

impl Patience {
    /// The patience of `robot` that drives at `speed_mps`.
    pub(super) fn new(robot: &RobotSpec, speed_mps: f64, step_s: f64) -> Self {
        let turned_rad = TURNED_RAD.min(SHARE * robot.drive.max_angular_radps * PATIENCE_S);
        Self {
            turned_cos: libm::cos(turned_rad),
            ..Self::with_place(robot, speed_mps, step_s, PATIENCE_S, MOVED_M)
        }
    }

    /// The patience for a time, s, with a robot that does not leave a place of the radius `place_m`, whether it turns
    /// or not.
    pub(super) fn with_place(
        robot: &RobotSpec,
        speed_mps: f64,
        step_s: f64,
        patience_s: f64,
        place_m: f64,
    ) -> Self {
        let period_s = robot.laser.period_steps as f64 * step_s;
        Self {
            readings: (patience_s / period_s).ceil() as u32,
            period_s,
            moved_m: place_m.min(SHARE * speed_mps * patience_s),
            turned_cos: f64::NEG_INFINITY,
            from: robot.pose,
            waited: 0,
        }
    }

    /// Shortens the wait that has begun anew to a time, s.
    pub(super) fn wait_again(&mut self, patience_s: f64) {
        self.waited = self.readings.saturating_sub((patience_s / self.period_s).ceil() as u32);
    }

    /// Whether the robot has waited too long at its pose. It then begins to wait anew.
    pub(super) fn is_over(&mut self, pose: &Isometry2<f64>) -> bool {
        let moved_m = (pose.translation.vector - self.from.translation.vector).norm();
        let turned = self.from.rotation.inverse() * pose.rotation;
        if moved_m > self.moved_m || turned.re < self.turned_cos {
            self.from = *pose;
            self.waited = 0;
        }
        self.waited += 1;
        let is_over = self.waited > self.readings;
        if is_over {
            self.waited = 0;
        }
        is_over
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![pose(&mut self.from), value(&mut self.waited)]
    }
}
