use super::quantile::rank;
use std::collections::BTreeMap;

/// How often each value from 0 to `MAX` occurred, for quantiles in bounded memory. Values are rounded to `1 / STEPS`.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct Counts<const STEPS: u32, const MAX: u32>(BTreeMap<u64, usize>);

impl<const STEPS: u32, const MAX: u32> Counts<STEPS, MAX> {
    /// Adds a value; a value beyond a limit counts as the limit.
    pub(super) fn add(&mut self, value: f64) {
        let value = value.clamp(0.0, f64::from(MAX));
        *self.0.entry((value * f64::from(STEPS)).round() as u64).or_default() += 1;
    }

    /// The number of values.
    pub(super) fn count(&self) -> usize {
        self.0.values().sum()
    }

    /// The value that this share of the values does not exceed; `None` without a value.
    pub(super) fn quantile(&self, share: f64) -> Option<f64> {
        self.quantile_with(0, share)
    }

    /// The same for these values and `infinite` others that are larger than all of them; `None` if it is one of the others.
    pub(super) fn quantile_with(&self, infinite: usize, share: f64) -> Option<f64> {
        let rank = rank(share, self.count() + infinite);
        let mut up_to = 0;
        let reaches_rank = |&(_, count): &(_, &usize)| {
            up_to += count;
            up_to > rank
        };
        self.0.iter().find(reaches_rank).map(|(&value, _)| value as f64 / f64::from(STEPS))
    }
}

#[cfg(test)]
impl<const STEPS: u32, const MAX: u32> Counts<STEPS, MAX> {
    /// The number of different values.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}
