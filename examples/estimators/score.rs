//! How far off an estimate is.

/// Errors are cut at a factor of ten either way.
const MOST: f64 = std::f64::consts::LN_10;

/// The mass of the credible intervals that are tried.
pub(crate) const MASS: f64 = 0.9;

/// |ln(estimate / truth)|, cut; no estimate counts as the cut.
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

    /// Adds the mean of another, if it has one.
    pub(crate) fn add_mean(&mut self, other: &Self) {
        if other.count > 0 {
            self.add(other.mean());
        }
    }

    /// Adds 1 or 0: the mean is a share.
    pub(crate) fn add_if(&mut self, holds: bool) {
        self.add(f64::from(u8::from(holds)));
    }

    /// NaN of nothing.
    pub(crate) fn mean(&self) -> f64 {
        self.sum / f64::from(self.count)
    }
}
