use super::snapshot::{Played, Tape};
use super::spec::DriveLimits;
use geometry::Twist;

/// A solved velocity this far off the wanted one means that something is in the way, m/s or rad/s:
/// well above the rounding of the physics.
const HELD_BACK: f64 = 1e-4;

/// A diff drive's motors: they follow a command as fast as they may, and never faster.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drive {
    limits: DriveLimits,
    /// The present velocity.
    velocity: Twist,
    /// Whether contacts held it back in the last step.
    is_stalled: bool,
}

impl Drive {
    /// Standing still.
    pub(super) fn new(limits: DriveLimits) -> Self {
        Self { limits, velocity: Twist::STOP, is_stalled: false }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.twist(&mut self.velocity)?;
        tape.bool(&mut self.is_stalled)
    }

    /// The velocity of the next physics step towards `wanted`. Not a number stops the robot.
    pub(super) fn step(&mut self, wanted: &Twist, step_s: f64) -> Twist {
        let limits = &self.limits;
        let wanted =
            if wanted.linear_mps.is_nan() || wanted.angular_radps.is_nan() { &Twist::STOP } else { wanted };
        let follow = |now: f64, wanted: f64, fastest: f64, gain: f64| {
            let most = gain * step_s;
            now + (wanted.clamp(-fastest, fastest) - now).clamp(-most, most)
        };
        self.velocity = Twist {
            linear_mps: follow(
                self.velocity.linear_mps,
                wanted.linear_mps,
                limits.max_linear_mps,
                limits.max_linear_acceleration_mps2,
            ),
            angular_radps: follow(
                self.velocity.angular_radps,
                wanted.angular_radps,
                limits.max_angular_radps,
                limits.max_angular_acceleration_radps2,
            ),
        };
        self.velocity
    }

    /// Takes over the velocity that the contacts left, so that a robot held by a wall has to speed
    /// up again when it comes free.
    pub(super) fn settle(&mut self, solved: &Twist) -> Twist {
        let settle = |own: &mut f64, solved: f64, fastest: f64| {
            let is_off = (*own - solved).abs() > HELD_BACK;
            if is_off {
                *own = solved.clamp(-fastest, fastest);
            }
            is_off
        };
        let is_held = settle(&mut self.velocity.linear_mps, solved.linear_mps, self.limits.max_linear_mps);
        let is_turned =
            settle(&mut self.velocity.angular_radps, solved.angular_radps, self.limits.max_angular_radps);
        self.is_stalled = is_held || is_turned;
        self.velocity
    }

    /// Whether contacts changed its velocity in the last step.
    pub(super) fn is_stalled(&self) -> bool {
        self.is_stalled
    }
}
