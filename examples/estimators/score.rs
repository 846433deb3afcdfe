//! The error of an estimate.

/// Errors are limited to a factor of ten in both directions.
const MOST: f64 = std::f64::consts::LN_10;

/// The probability of the credible intervals that are evaluated.
pub(crate) const MASS: f64 = 0.9;

/// |ln(estimate / truth)|, limited; a missing estimate counts as the limit.
pub(crate) fn log_error(estimate: f64, truth: f64) -> f64 {
    if estimate > 0.0 { (estimate / truth).ln().abs().min(MOST) } else { MOST }
}

/// A running mean.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mean {
    sum: f64,
    count: u32,
}

impl Mean {
    pub(crate) fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    /// Adds the mean of another `Mean`, if it has one.
    pub(crate) fn add_mean(&mut self, other: &Self) {
        if other.count > 0 {
            self.add(other.mean());
        }
    }

    /// Adds 1 or 0: the mean is a share.
    pub(crate) fn add_if(&mut self, holds: bool) {
        self.add(f64::from(u8::from(holds)));
    }

    /// The mean; NaN without values.
    pub(crate) fn mean(&self) -> f64 {
        self.sum / f64::from(self.count)
    }
}
