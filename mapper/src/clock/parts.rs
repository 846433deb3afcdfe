//! The parts of a memory: processes that fade exponentially.

/// The number of parts.
pub(super) const PARTS: usize = 9;
/// The time constants of the fastest and of the slowest part, s: one minute and 45 days. Each part is four times as slow as
/// the one before.
pub(super) const FASTEST_S: f64 = 60.0;
const SLOWEST_S: f64 = FASTEST_S * 65_536.0;

/// A value for each part.
pub(super) type Parts = [f64; PARTS];

/// The shares of the parts before any look: about the same for each time constant.
pub(super) const PRIOR: Parts = [0.10, 0.10, 0.12, 0.15, 0.12, 0.08, 0.08, 0.10, 0.15];

/// The factors by which the parts fade in a time: each is the fourth power of that of the next part.
pub(super) fn fading(elapsed_s: f64) -> Parts {
    let mut fading = [libm::exp(-elapsed_s / SLOWEST_S); PARTS];
    for part in (0..PARTS - 1).rev() {
        let square = fading[part + 1] * fading[part + 1];
        fading[part] = square * square;
    }
    fading
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fade_with_their_time_constants() {
        for elapsed_s in [0.0, 0.1, 60.0, 3600.0, 1e6, f64::INFINITY] {
            for (part, found) in fading(elapsed_s).into_iter().enumerate() {
                let expected = (-elapsed_s / (FASTEST_S * 4f64.powi(part as i32))).exp();
                assert!(
                    (found - expected).abs() < 1e-10,
                    "part {part}, {elapsed_s} s: {found}, not {expected}"
                );
            }
        }
    }
}
