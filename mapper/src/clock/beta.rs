//! The beta distribution, that of a probability about which a number of draws is known.

/// The probability that a beta variable with the parameters a and b is at most x: the regularized incomplete beta function, by
/// its continued fraction (Lentz, 1976; DLMF 8.17.22).
pub(super) fn beta_cdf([a, b]: [f64; 2], x: f64) -> f64 {
    const TERMS: u32 = 400;
    const TINY: f64 = 1e-300;
    if x <= 0.0 || x >= 1.0 {
        return if x <= 0.0 { 0.0 } else { 1.0 };
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        // The fraction converges fast on the other side of the mean.
        return 1.0 - beta_cdf([b, a], 1.0 - x);
    }
    let (mut value, mut c, mut d) = (1.0, 1.0, 0.0);
    for term in 0..TERMS {
        let m = f64::from(term / 2);
        let numerator = match term % 2 {
            _ if term == 0 => 1.0,
            0 => m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            _ => -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        };
        let away = |value: f64| if value.abs() < TINY { TINY } else { value };
        (d, c) = (1.0 / away(1.0 + numerator * d), away(1.0 + numerator / c));
        value *= c * d;
        if (c * d - 1.0).abs() < 1e-10 {
            break;
        }
    }
    let log_beta = libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
    libm::exp(a * libm::log(x) + b * libm::log1p(-x) - log_beta) / a * (value - 1.0)
}

/// The value below which a beta variable is with this probability.
pub(super) fn beta_quantile(parameters: [f64; 2], probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        *(if beta_cdf(parameters, middle) < probability { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distributions_with_a_closed_form_are_found() {
        for x in [0.01, 0.3, 0.5, 0.77, 0.999] {
            for a in [0.02, 0.5, 1.0, 7.0, 300.0] {
                let closed = [
                    ([a, 1.0], libm::pow(x, a)),
                    ([1.0, a], 1.0 - libm::pow(1.0 - x, a)),
                    ([2.0, a], 1.0 - libm::pow(1.0 - x, a) * (1.0 + a * x)),
                ];
                for (parameters, expected) in closed {
                    let found = beta_cdf(parameters, x);
                    assert!(
                        (found - expected).abs() < 1e-8,
                        "{parameters:?} at {x}: {found}, not {expected}"
                    );
                }
            }
        }
        // The arcsine distribution, and the median of a symmetric one.
        assert!((beta_cdf([0.5, 0.5], 0.25) - 1.0 / 3.0).abs() < 1e-9);
        assert!((beta_quantile([4e4, 4e4], 0.5) - 0.5).abs() < 1e-9);
        // Brown, Cai and DasGupta (2001): Jeffreys' interval of 5 of 10.
        let [low, high] = [0.025, 0.975].map(|probability| beta_quantile([5.5; 2], probability));
        assert!((low - 0.224).abs() < 5e-4 && (high - 0.776).abs() < 5e-4, "{low} to {high}");
        assert!((beta_quantile([3.0, 1.0], 0.05) - libm::cbrt(0.05)).abs() < 1e-9);
    }
}
