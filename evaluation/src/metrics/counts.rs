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

    /// The value that this share of the values does not exceed; `None` without a value.
    pub(super) fn quantile(&self, share: f64) -> Option<f64> {
        let rank = rank(share, self.0.values().sum());
        let mut up_to = 0;
        let reaches_rank = |&(_, count): &(_, &usize)| {
            up_to += count;
            up_to > rank
        };
        self.0.iter().find(reaches_rank).map(|(&value, _)| value as f64 / f64::from(STEPS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_counts_are_those_of_the_list_in_little_memory() {
        let mut counts = Counts::<1_000_000, 3600>::default();
        assert_eq!(counts.quantile(0.5), None);
        let mut values: Vec<f64> =
            (0..1001).map(|number: u32| 0.1 * f64::from(number * number % 97)).collect();
        values.iter().for_each(|&value| counts.add(value));
        values.sort_unstable_by(f64::total_cmp);
        for (share, rank) in [(0.0, 0), (0.5, 500), (0.95, 950), (1.0, 1000)] {
            assert!((counts.quantile(share).unwrap() - values[rank]).abs() < 1e-9, "{share}");
        }
        (0..100_000).for_each(|value| counts.add(f64::from(value)));
        assert!(counts.0.len() <= 3700 && counts.quantile(1.0) == Some(3600.0));
    }
}
