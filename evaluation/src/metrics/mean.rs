/// A running mean.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct Mean {
    sum: f64,
    pub(super) count: usize,
}

impl Mean {
    pub(super) fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    pub(super) fn add_bool(&mut self, is_true: bool) {
        self.add(f64::from(u8::from(is_true)));
    }

    /// Adds the mean of another `Mean` as one value; adds nothing if the other has no values.
    pub(super) fn add_mean(&mut self, other: &Self) {
        if let Some(mean) = other.get() {
            self.add(mean);
        }
    }

    /// The mean; `None` without values.
    pub(super) fn get(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}
