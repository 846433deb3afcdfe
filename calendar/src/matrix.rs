/// The number of phases: each of the two states with a short and with a long stay.
pub const PHASES: usize = 4;

/// A matrix over the phases of a [`Habit`](super::Habit): rates of transitions, or their probabilities in a time.
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
pub(super) fn exponential(rates: &Matrix, time_s: f64) -> Matrix {
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
