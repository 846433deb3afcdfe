//! Times and rates in words.

use survey::PlaceRates;

/// With fewer changes, or where the ends of the interval are farther apart than this factor, a single figure says too much.
const FEW: u32 = 3;
const WIDE: f64 = 10.0;

/// How often something changes at a place with this number of changes, in words: the estimate, or the range where little
/// was seen.
pub fn how_often(changes: u32, rates: &PlaceRates) -> String {
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
pub fn range(rates: &PlaceRates) -> String {
    let time = |rate: Option<f64>| rate.filter(|rate| *rate > 0.0).map(|rate| length_of(3600.0 / rate));
    let [slow, fast] = rates.cycles_per_hour_90.map(time);
    match (fast, slow) {
        (Some(fast), Some(slow)) => format!("{fast} to {slow}"),
        (Some(fast), None) => format!("{fast} or more"),
        (None, Some(slow)) => format!("{slow} or less"),
        (None, None) => "an unknown time".to_owned(),
    }
}

/// Names in a row; of many, the first and the last.
pub fn list(names: &[String]) -> String {
    match names {
        [first, .., last] if names.len() > 4 => format!("{first}, …, {last} ({} logs)", names.len()),
        few => few.join(", "),
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
pub fn length_of(time_s: f64) -> String {
    match time_s {
        time if time < 90.0 => format!("{time:.0} s"),
        time if time < 5400.0 => format!("{:.0} min", time / 60.0),
        time if time < 172_800.0 => format!("{} h", short(time / 3600.0)),
        time => format!("{} days", short(time / 86_400.0)),
    }
}

/// A time in seconds since the epoch (1970-01-01), as date and time of day in UTC.
pub fn date(time_s: f64) -> String {
    const DAY_S: i64 = 86_400;
    let time_s = time_s.floor() as i64;
    let (days, second) = (time_s.div_euclid(DAY_S), time_s.rem_euclid(DAY_S));
    // Years begin in March, so that the leap day is the last one; 400 years have 146,097 days (Richards 2013).
    let days = days + 719_468;
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day_of_year = day - (365 * year + year / 4 - year / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = era * 400 + year + i64::from(month <= 2);
    format!("{year}-{month:02}-{day:02} {:02}:{:02} UTC", second / 3600, second / 60 % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_in_the_unit_that_a_person_would_choose() {
        let texts = [5.0, 89.0, 90.0, 5399.0, 5400.0, 170_000.0, 172_800.0].map(length_of);
        assert_eq!(texts, ["5 s", "89 s", "2 min", "90 min", "1.5 h", "47 h", "2.0 days"]);
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        let dates = [0.0, 951_782_399.9, 951_868_800.0, 1_709_164_800.0, 4_107_542_399.0].map(date);
        let expected = [
            "1970-01-01 00:00 UTC",
            "2000-02-28 23:59 UTC",
            "2000-03-01 00:00 UTC",
            "2024-02-29 00:00 UTC",
            "2100-02-28 23:59 UTC",
        ];
        assert_eq!(dates, expected);
    }
}
