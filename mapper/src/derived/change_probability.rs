/// Equation 2 of the paper: the probability that a cell changed since it was last observed,
/// P(E > 0) = 1 − e^(−λ) with λ = (t_now − t_last)/T = `elapsed` · `rate`.
///
/// The paper prints t_last − t_init in the equation; the text of the paper defines λ as here.
#[inline]
pub(super) fn change_probability(elapsed: f64, rate: f64) -> f64 {
    // The function is summed over thousands of cells at every reading: `exp` takes half the time of `expm1`, and
    // its error of 1e-16 is far below the error of any rate.
    1.0 - libm::exp(-elapsed * rate)
}
