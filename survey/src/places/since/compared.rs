/// Passages at one place, before the session and in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Compared {
    /// Whether nothing passed before, in no spot of the place: a place that was divided anew is not new.
    pub(super) is_first: bool,
    pub(super) passages: [u32; 2],
    /// The time in view, s.
    pub(super) observed_s: [f64; 2],
}

/// Passages come there and back.
const PER_PAIR: f64 = 2.0;
/// A smaller factor between two rates is of no interest.
const MIN_FACTOR: f64 = 1.5;

impl Compared {
    /// Whether there is more per hour in the session than before.
    pub(super) fn is_more(&self) -> bool {
        let [before, since] = self.passages.map(f64::from);
        since * self.observed_s[0] > before * self.observed_s[1]
    }

    /// The probability of a difference at least as large, if both rates are the same: twice that of one side.
    pub(super) fn p_value(&self) -> f64 {
        let [before, since] = self.passages.map(|passages| (f64::from(passages) / PER_PAIR).round() as u32);
        let total_s = self.observed_s[0] + self.observed_s[1];
        let share = self.observed_s[1] / total_s;
        if total_s <= 0.0 || share <= 0.0 || share >= 1.0 || before + since == 0 || !self.is_large() {
            return 1.0;
        }
        let all = before + since;
        let range = if self.is_more() { since..=all } else { 0..=since };
        let side: f64 = range.map(|count| libm::exp(log_binomial(count, all, share))).sum();
        (2.0 * side).min(1.0)
    }

    fn is_large(&self) -> bool {
        let [before, since] = self.passages.map(|passages| f64::from(passages) + 0.5);
        let factor = (since / self.observed_s[1]) / (before / self.observed_s[0]);
        !(1.0 / MIN_FACTOR..MIN_FACTOR).contains(&factor)
    }
}

/// The logarithm of the probability of `count` of `all` independent draws with this probability each.
fn log_binomial(count: u32, all: u32, probability: f64) -> f64 {
    let factorial = |number: u32| libm::lgamma(f64::from(number) + 1.0);
    factorial(all) - factorial(count) - factorial(all - count)
        + f64::from(count) * libm::log(probability)
        + f64::from(all - count) * libm::log1p(-probability)
}

/// Which of these tests find something, if at most this share of the findings may be wrong.
pub(super) fn significant(p_values: &[f64], share: f64) -> Vec<bool> {
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let limit = |rank: usize| share * (rank + 1) as f64 / sorted.len() as f64;
    let last = (0..sorted.len()).rev().find(|rank| sorted[*rank] <= limit(*rank));
    let largest = last.map_or(-1.0, |rank| sorted[rank]);
    p_values.iter().map(|p_value| *p_value <= largest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(passages: [u32; 2], minutes: [f64; 2]) -> Compared {
        Compared { is_first: false, passages, observed_s: minutes.map(|minutes| 60.0 * minutes) }
    }

    #[test]
    fn more_in_the_same_time_is_livelier_and_a_few_are_chance() {
        let lively = compared([10, 60], [60.0, 60.0]);
        assert!(lively.p_value() < 1e-3 && lively.is_more(), "{}", lively.p_value());
        let quiet = compared([60, 0], [60.0, 60.0]);
        assert!(quiet.p_value() < 1e-6 && !quiet.is_more(), "{}", quiet.p_value());
        // Twice as many in twice the time, three more, and nothing at all.
        for same in
            [compared([20, 40], [60.0, 120.0]), compared([1, 4], [60.0, 60.0]), compared([0, 0], [9.0, 9.0])]
        {
            assert!(same.p_value() > 0.1, "{same:?}: {}", same.p_value());
        }
        assert_eq!(compared([0, 9], [0.0, 60.0]).p_value(), 1.0);
    }

    /// With 10 heads of 10 throws of a coin.
    #[test]
    fn probabilities_are_those_of_the_binomial_distribution() {
        let all_heads = compared([0, 20], [60.0, 60.0]).p_value();
        assert!((all_heads - 2.0 / 1024.0).abs() < 1e-12, "{all_heads}");
        let sum: f64 = (0..=17).map(|count| libm::exp(log_binomial(count, 17, 0.3))).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn of_many_tests_a_small_share_of_the_findings_is_wrong() {
        assert_eq!(significant(&[0.001, 0.8, 0.02, 0.5], 0.05), [true, false, true, false]);
        assert_eq!(significant(&[0.04, 0.9, 0.9], 0.05), [false; 3]);
        assert_eq!(significant(&[], 0.05), [false; 0]);
    }
}
