use super::snapshot::{Played, Tape, Torn};
use interfaces::Twist;
use nalgebra::Isometry2;

/// A velocity in a robot's own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Forwards, m/s.
    pub forward_mps: f64,
    /// To the left, m/s; only an omni drive has any.
    pub left_mps: f64,
    /// Counter-clockwise, rad/s.
    pub turn_radps: f64,
}

impl Velocity {
    /// Standing still.
    pub const STOP: Self = Self { forward_mps: 0.0, left_mps: 0.0, turn_radps: 0.0 };

    /// The same without what goes to the left.
    pub fn twist(&self) -> Twist {
        Twist { linear_mps: self.forward_mps, angular_radps: self.turn_radps }
    }
}

impl From<Twist> for Velocity {
    fn from(twist: Twist) -> Self {
        Self { forward_mps: twist.linear_mps, left_mps: 0.0, turn_radps: twist.angular_radps }
    }
}

/// An acceleration in a robot's own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Acceleration {
    /// Forwards, m/s².
    pub forward_mps2: f64,
    /// To the left, m/s²; only an omni drive has any.
    pub left_mps2: f64,
    /// Counter-clockwise, rad/s².
    pub turn_radps2: f64,
}

/// What a robot is told to do, until it is told something else. Whatever it is, the bounds of the
/// robot's velocity and acceleration hold; not a number stops it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// To move at this velocity.
    Velocity(Velocity),
    /// To change its velocity at this rate.
    Acceleration(Acceleration),
    /// To go straight to this pose by its odometry, and stop there to within 0.01 m and 0.01 rad. It
    /// looks at nothing on its way. A car comes to within 0.05 m, in whatever heading.
    GoTo(Isometry2<f64>),
}

impl Command {
    /// To stand still.
    pub const STOP: Self = Self::Velocity(Velocity::STOP);

    /// Writes or reads it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        let mut kind = match self {
            Self::Velocity(_) => 0,
            Self::Acceleration(_) => 1,
            Self::GoTo(_) => 2,
        };
        let mut numbers = match self {
            Self::Velocity(v) => [v.forward_mps, v.left_mps, v.turn_radps],
            Self::Acceleration(a) => [a.forward_mps2, a.left_mps2, a.turn_radps2],
            Self::GoTo(_) => [0.0; 3],
        };
        let mut goal = if let Self::GoTo(goal) = self { *goal } else { Isometry2::identity() };
        tape.u32(&mut kind)?;
        numbers.iter_mut().try_for_each(|number| tape.f64(number))?;
        tape.pose(&mut goal)?;
        let [forward, left, turn] = numbers;
        *self = match kind {
            0 => Self::Velocity(Velocity { forward_mps: forward, left_mps: left, turn_radps: turn }),
            1 => {
                Self::Acceleration(Acceleration { forward_mps2: forward, left_mps2: left, turn_radps2: turn })
            }
            2 => Self::GoTo(goal),
            _ => return Err(Torn),
        };
        Ok(())
    }
}

impl From<Twist> for Command {
    fn from(twist: Twist) -> Self {
        Self::Velocity(twist.into())
    }
}

impl From<Velocity> for Command {
    fn from(velocity: Velocity) -> Self {
        Self::Velocity(velocity)
    }
}

impl From<Acceleration> for Command {
    fn from(acceleration: Acceleration) -> Self {
        Self::Acceleration(acceleration)
    }
}

impl Velocity {
    /// Writes or reads it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.f64(&mut self.forward_mps)?;
        tape.f64(&mut self.left_mps)?;
        tape.f64(&mut self.turn_radps)
    }
}
