/// The value that a share of the values does not exceed: the smallest value that at least this share does not exceed. `None`
/// without a value.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(rank(share, sorted.len())).copied()
}

/// The position of this value among the sorted values, from 0 on.
pub(super) fn rank(share: f64, count: usize) -> usize {
    ((share * count as f64).ceil() as usize).max(1) - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_is_the_smallest_value_that_the_share_does_not_exceed() {
        assert_eq!(quantile(&[], 0.5), None);
        for count in 1..60_u32 {
            let values: Vec<f64> = (0..count).map(|number| f64::from(number * 7 % 11)).collect();
            for percent in [0, 1, 5, 50, 90, 95, 99, 100] {
                let found = quantile(&values, f64::from(percent) / 100.0).unwrap();
                let up_to = |limit: f64| values.iter().filter(|value| **value <= limit).count() as u32;
                let is_enough = |limit: f64| 100 * up_to(limit) >= percent * count;
                let smallest = values.iter().copied().filter(|value| is_enough(*value)).reduce(f64::min);
                assert_eq!(Some(found), smallest, "{percent} % of {values:?}");
            }
        }
    }
}
