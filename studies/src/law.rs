//! The law of a habit: the probabilities of its phases over time.

use calendar::{Habit, PHASES, SLOT_S, Stays};

/// A law over the phases: free for a short stay, free for a long one, blocked for a short stay, blocked for a long one.
/// The phase is not visible, only the state is.
pub type Phases = [f64; PHASES];

/// The probability of the state "blocked".
pub fn blocked_probability(phases: &Phases) -> f64 {
    phases[2] + phases[3]
}

/// A matrix over the phases of a [`Habit`]: rates of transitions, or their probabilities in a time.
pub type Matrix = [[f64; PHASES]; PHASES];

/// The law of the phases after the time of `transitions`.
#[inline]
pub fn advanced(law: &[f64; PHASES], transitions: &Matrix) -> [f64; PHASES] {
    let mut after = [0.0; PHASES];
    for (share, row) in law.iter().zip(transitions) {
        after.iter_mut().zip(row).for_each(|(after, probability)| *after += share * probability);
    }
    after
}

/// The transitions in one time, then another one.
pub fn product(left: &Matrix, right: &Matrix) -> Matrix {
    left.map(|row| advanced(&row, right))
}

/// The exponential of a generator matrix times `time_s`: scaling and squaring of a Taylor series.
fn exponential(rates: &Matrix, time_s: f64) -> Matrix {
    let norm = rates.iter().flatten().fold(0.0_f64, |norm, rate| norm.max((rate * time_s).abs()));
    let squarings = (0..64).find(|power| norm <= 2.0_f64.powi(power - 6)).unwrap_or(64);
    let scaled = rates.map(|row| row.map(|rate| rate * time_s * 2.0_f64.powi(-squarings)));
    let identity: Matrix =
        std::array::from_fn(|row| std::array::from_fn(|at| f64::from(u8::from(row == at))));
    // Terms fall by 1/16 at least (four entries of at most 2⁻⁶): the tenth is below the precision of f64.
    let mut sum = (1..=10).rev().fold(identity, |sum, term| {
        let mut next = product(&scaled, &sum);
        for (row, values) in next.iter_mut().enumerate() {
            values.iter_mut().for_each(|value| *value /= f64::from(term));
            values[row] += 1.0;
        }
        next
    });
    for _ in 0..squarings {
        sum = product(&sum, &sum);
    }
    sum
}

/// What follows from a habit.
pub trait Law {
    /// The mean time of a cycle (free and blocked), s, averaged over the rates in active and in quiet hours.
    fn cycle_s(&self) -> f64;

    /// The probabilities of the transitions in `time_s`, during which the place is active or quiet all the time.
    fn transitions(&self, is_active: bool, time_s: f64) -> Matrix;
}

impl Law for Habit {
    fn cycle_s(&self) -> f64 {
        let half_hours = (0..336).filter(|slot| self.hours.is_active(f64::from(*slot) * SLOT_S));
        let share = half_hours.count() as f64 / 336.0;
        let rate_hz = |stays: &[Stays; 2]| (stays[0].mean_s() + stays[1].mean_s()).recip();
        (share * rate_hz(&self.active) + (1.0 - share) * rate_hz(&self.quiet)).recip()
    }

    fn transitions(&self, is_active: bool, time_s: f64) -> Matrix {
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
    use calendar::Stays;

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
