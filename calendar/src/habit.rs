use crate::hours::Hours;
use crate::matrix::{Matrix, PHASES, exponential};

/// A law over the phases: free for a short stay, free for a long one, blocked for a short stay, blocked for a long one.
/// The phase is not visible, only the state is.
pub type Phases = [f64; PHASES];

/// The probability of the state "blocked".
pub fn blocked_probability(phases: &Phases) -> f64 {
    phases[2] + phases[3]
}

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

    /// Whether all stays are exponential, so that the state alone tells the future.
    pub fn is_two_state(&self) -> bool {
        self.active.iter().chain(&self.quiet).all(|stays| stays.long_share == 0.0)
    }

    /// The mean time of a cycle (free and blocked), s, averaged over the rates in active and in quiet hours.
    pub fn cycle_s(&self) -> f64 {
        let share = self.hours.active_share();
        let rate_hz = |stays: &[Stays; 2]| (stays[0].mean_s() + stays[1].mean_s()).recip();
        (share * rate_hz(&self.active) + (1.0 - share) * rate_hz(&self.quiet)).recip()
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

    /// The probabilities of the transitions in `time_s`, during which the place is active or quiet all the time.
    pub fn transitions(&self, is_active: bool, time_s: f64) -> Matrix {
        let rates = std::array::from_fn(|phase| {
            let rate_hz = self.end_rate_hz(phase, is_active);
            let other = 1 - phase / 2;
            let long = self.stays(is_active)[other].long_share;
            let mut row = [0.0; PHASES];
            row[phase] = -rate_hz;
            row[2 * other] = rate_hz * (1.0 - long);
            row[2 * other + 1] = rate_hz * long;
            row
        });
        exponential(&rates, time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::advanced;

    #[test]
    fn a_chain_is_the_closed_form() {
        let (free_s, blocked_s) = (300.0, 100.0);
        let sum_hz = 1.0 / free_s + 1.0 / blocked_s;
        for time_s in [1.0_f64, 10.0, 500.0, 1e5] {
            let transitions = Habit::chain(free_s, blocked_s).transitions(true, time_s);
            let after = blocked_probability(&advanced(&[1.0, 0.0, 0.0, 0.0], &transitions));
            let expected = (1.0 / free_s) / sum_hz * (1.0 - (-sum_hz * time_s).exp());
            assert!((after - expected).abs() < 1e-12, "{time_s}: {after} {expected}");
        }
    }

    #[test]
    fn transitions_compose() {
        let stays = [
            Stays { short_s: 60.0, long_s: 4000.0, long_share: 0.2 },
            Stays { short_s: 9.0, long_s: 900.0, long_share: 0.7 },
        ];
        let habit = Habit { active: stays, ..Habit::chain(1.0, 1.0) };
        let [once, twice] = [170.0, 340.0].map(|time_s| habit.transitions(true, time_s));
        let law = [0.1, 0.2, 0.3, 0.4];
        let (left, right) = (advanced(&advanced(&law, &once), &once), advanced(&law, &twice));
        assert!(left.iter().zip(right).all(|(left, right)| (left - right).abs() < 1e-12));
        assert!((right.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
