//! Times and rates in words.

use survey::PlaceRates;

/// With fewer changes, or where the ends of the interval are farther apart than this factor, a single figure says too much.
const FEW: u32 = 3;
const WIDE: f64 = 10.0;

/// How often something changes at a place with this number of changes, in words: the estimate, or the range where little
/// was seen.
pub(crate) fn how_often(changes: u32, rates: &PlaceRates) -> String {
    let [low, high] = rates.cycles_per_hour_90.map(Option::unwrap_or_default);
    match rates.cycles_per_hour {
        // Few observations: the estimate is mostly the prior.
        rate if rate <= 0.0 || changes < FEW || high > WIDE * low => {
            format!("once in {}", range(rates))
        }
        rate => format!("once in {}", length_of(3600.0 / rate)),
    }
}

/// The range of the time of one cycle that contains the true one with 90 % probability, in words.
pub(crate) fn range(rates: &PlaceRates) -> String {
    let time = |rate: Option<f64>| rate.filter(|rate| *rate > 0.0).map(|rate| length_of(3600.0 / rate));
    let [slow, fast] = rates.cycles_per_hour_90.map(time);
    match (fast, slow) {
        (Some(fast), Some(slow)) => format!("{fast} to {slow}"),
        (Some(fast), None) => format!("{fast} or more"),
        (None, Some(slow)) => format!("{slow} or less"),
        (None, None) => "an unknown time".to_owned(),
    }
}

/// A number with two digits that matter.
fn short(value: f64) -> String {
    match value {
        value if value >= 10.0 => format!("{value:.0}"),
        value if value >= 1.0 => format!("{value:.1}"),
        value => format!("{value:.2}"),
    }
}

/// A length of time in words.
pub(crate) fn length_of(time_s: f64) -> String {
    match time_s {
        time if time < 90.0 => format!("{time:.0} s"),
        time if time < 5400.0 => format!("{:.0} min", time / 60.0),
        time if time < 172_800.0 => format!("{} h", short(time / 3600.0)),
        time => format!("{} days", short(time / 86_400.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_in_the_unit_that_a_person_would_choose() {
        let texts = [5.0, 89.0, 90.0, 5399.0, 5400.0, 170_000.0, 172_800.0].map(length_of);
        assert_eq!(texts, ["5 s", "89 s", "2 min", "90 min", "1.5 h", "47 h", "2.0 days"]);
    }
}
