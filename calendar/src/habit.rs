use crate::hours::Hours;

/// The number of phases of a habit: free for a short stay, free for a long one, blocked for a short stay, blocked for a long
/// one. The phase is not visible, only the state is.
pub const PHASES: usize = 4;

/// How long a thing stays in one state: a mixture of two exponential distributions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stays {
    /// The mean of short stays, s.
    pub short_s: f64,
    /// The mean of long stays, s.
    pub long_s: f64,
    /// The share of stays that begin as long ones.
    pub long_share: f64,
}

impl Stays {
    /// The mean, s.
    pub fn mean_s(&self) -> f64 {
        self.short_s + self.long_share * (self.long_s - self.short_s)
    }

    /// Exponential stays: the thing is a two-state Markov chain.
    pub const fn of_mean(mean_s: f64) -> Self {
        Self { short_s: mean_s, long_s: mean_s, long_share: 0.0 }
    }
}

/// The habit of a thing: its stays in the states free and blocked, while its place is active and while it is quiet.
///
/// A stay keeps its phase when the place becomes quiet or active, and ends at the rate of its phase at the time.
#[derive(Clone, Debug, PartialEq)]
pub struct Habit {
    /// When the place is active.
    pub hours: Hours,
    /// Stays (free, blocked) while it is active.
    pub active: [Stays; 2],
    /// Stays (free, blocked) while it is quiet.
    pub quiet: [Stays; 2],
}

impl Habit {
    /// A two-state Markov chain with these mean stays (free, blocked), s, at all times.
    pub fn chain(free_s: f64, blocked_s: f64) -> Self {
        let stays = [free_s, blocked_s].map(Stays::of_mean);
        Self { hours: Hours::always(), active: stays, quiet: stays }
    }

    /// The stays (free, blocked) while the place is active or quiet.
    pub fn stays(&self, is_active: bool) -> &[Stays; 2] {
        if is_active { &self.active } else { &self.quiet }
    }

    /// The rate at which a phase ends, 1/s, while the place is active or quiet.
    pub fn end_rate_hz(&self, phase: usize, is_active: bool) -> f64 {
        let stays = &self.stays(is_active)[phase / 2];
        if phase.is_multiple_of(2) { stays.short_s.recip() } else { stays.long_s.recip() }
    }
}
