/// The longest patrol on one charge, steps: half an hour.
const FULL_STEPS: f64 = 180.0;

/// For what share of the time a robot can be on patrol: its battery lasts for half an hour, and charges accordingly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duty {
    share: f64,
}

impl Duty {
    /// A robot that need not charge.
    pub const ALWAYS: Self = Self { share: 1.0 };

    /// A share of the time, above 0; from 1 on the robot need not charge.
    pub fn share(share: f64) -> Self {
        Self { share: share.clamp(1e-6, 1.0) }
    }

    /// Whether the robot need not charge.
    pub fn is_always(self) -> bool {
        self.share >= 1.0
    }

    /// The charge of a full battery, in steps of driving and looking.
    pub fn full_steps(self) -> f64 {
        if self.is_always() { f64::INFINITY } else { FULL_STEPS }
    }

    /// What a step at the dock charges, in steps of driving and looking.
    pub fn charge_per_step(self) -> f64 {
        if self.is_always() { 0.0 } else { self.share / (1.0 - self.share) }
    }

    /// The mean time between two steps of patrol, steps.
    pub fn spread(self) -> f64 {
        self.share.recip()
    }
}
