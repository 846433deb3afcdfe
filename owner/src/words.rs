//! Times and rates in words.

use interfaces::printable;
use jiff::Timestamp;
use survey::{Place, PlaceRates};

/// Where the ends of the interval are farther apart than this factor, a single figure says too much.
const WIDE: f64 = 10.0;

/// What was seen of something that happens again and again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// How often it happened in view.
    pub times: u32,
    /// The time in view, s.
    pub observed_s: f64,
    /// How often it was found to have changed out of view.
    pub after_gap: u32,
    /// The number of looks with times out of view between them.
    pub looks: u32,
    /// How often it happens per hour, and the ends of the 90 % credible interval.
    pub per_hour: (f64, [f64; 2]),
    /// Whether a full cycle was seen: it happened, was over, and happened again. Less says nothing about how often it happens.
    pub has_cycle: bool,
}

impl Seen {
    /// What was seen of a place.
    pub fn of_place(rates: &PlaceRates) -> Self {
        let [low, high] = rates.cycles_per_hour_90.map(|end| end.unwrap_or(f64::INFINITY));
        let passages = rates.passages_per_hour.zip(rates.passages_per_hour_90);
        Self {
            times: rates.passages,
            observed_s: rates.spot_observed_s,
            after_gap: rates.changes_after_gap,
            looks: rates.looks,
            per_hour: passages.unwrap_or((rates.cycles_per_hour, [low, high])),
            has_cycle: rates.has_cycle(),
        }
    }

    /// Whether most changes were found after a time out of view: what happens in view is two changes.
    pub fn is_after_gap(&self) -> bool {
        self.after_gap > 2 * self.times
    }

    /// How often it happens, in words; `None` unless a full cycle was seen. Where the range is wide, the words say only what was
    /// seen.
    pub fn how_often(&self) -> Option<String> {
        let (per_hour, ends) = self.per_hour;
        let about = format!("about {}", rate(per_hour));
        self.has_cycle.then(|| match (self.is_known(), self.is_after_gap()) {
            (false, _) => self.seen(),
            (true, false) => about,
            (true, true) => format!("{}: {about} ({})", self.seen(), range(per_hour, ends)),
        })
    }

    /// Whether a figure can be given: a full cycle was seen, and the range is not wide.
    pub fn is_known(&self) -> bool {
        let (_, [low, high]) = self.per_hour;
        self.has_cycle && high <= WIDE * low
    }

    /// What was seen, in words.
    pub fn seen(&self) -> String {
        match self.is_after_gap() {
            true => format!("changed {} between {} looks", times(self.after_gap), self.looks),
            false => format!("{} in {} of observation", times(self.times), length_of(self.observed_s)),
        }
    }

    /// How sure the rate is, in a word.
    pub fn sureness(&self) -> &'static str {
        match self.per_hour {
            (_, [low, high]) if self.has_cycle && high <= 2.0 * low => "sure",
            (_, [low, high]) if self.has_cycle && high <= 4.0 * low => "fairly sure",
            _ if self.is_known() => "roughly known",
            _ => "a first impression only",
        }
    }
}

/// How often something changes at a place, in words.
pub fn how_often(place: &Place) -> Option<String> {
    let seen = Seen::of_place(place.rates.as_ref()?);
    Some(seen.how_often().unwrap_or_else(|| changed(place.changes, &seen)))
}

/// What was seen where nothing came twice, as a sentence without its end. `changes` are those of the cell with the most of them.
pub fn changed(changes: u32, seen: &Seen) -> String {
    let looked = length_of(seen.observed_s);
    match changes {
        _ if seen.is_after_gap() => seen.seen(),
        changes if changes > 2 => {
            format!("single cells changed up to {} in {looked} of observation", times(changes))
        }
        _ => format!("changed {} in {looked} of observation", times(changes)),
    }
}

/// Once, twice, 3 times.
pub fn times(count: u32) -> String {
    match count {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        count => format!("{count} times"),
    }
}

/// A rate per hour, in words: 12 times per hour, once in 3 h. Never per minute: places are compared with each other.
pub fn rate(per_hour: f64) -> String {
    match per_hour {
        rate if rate >= 10.0 => format!("{} times per hour", short(rate)),
        rate if rate >= 1.5 => format!("{rate:.0} times per hour"),
        rate if rate > 0.0 => format!("once in {}", length_of(3600.0 / rate)),
        _ => "never".to_owned(),
    }
}

/// The range around a rate per hour, in words and in the unit of the rate: 3.0 to 12 times per hour, once in 2.0 h to 8.0 h.
pub fn range(per_hour: f64, [low, high]: [f64; 2]) -> String {
    match per_hour {
        rate if rate >= 1.5 => format!("{} to {} times per hour", short(low), short(high)),
        _ => format!("once in {} to {}", length_of(3600.0 / high), length_of(3600.0 / low)),
    }
}

/// Names in a row; of many, the first and the last.
pub fn list(names: &[String]) -> String {
    match names {
        [first, .., last] if names.len() > 4 => {
            printable(&format!("{first}, …, {last} ({} logs)", names.len())).into_owned()
        }
        few => printable(&few.join(", ")).into_owned(),
    }
}

/// A number with two digits that matter.
pub fn short(value: f64) -> String {
    match value {
        value if value >= 100.0 => {
            let unit = libm::pow(10.0, libm::log10(value).floor() - 1.0);
            format!("{:.0}", (value / unit).round() * unit)
        }
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
    let at = Timestamp::from_second(time_s.floor() as i64).unwrap_or_default();
    at.strftime("%Y-%m-%d %H:%M UTC").to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_in_the_unit_that_a_person_would_choose() {
        let texts = [5.0, 89.0, 90.0, 5399.0, 5400.0, 170_000.0, 172_800.0].map(length_of);
        assert_eq!(texts, ["5 s", "89 s", "2 min", "90 min", "1.5 h", "47 h", "2.0 days"]);
    }

    fn seen(times: u32, low: f64, high: f64) -> Seen {
        let per_hour = ((low * high).sqrt(), [low, high]);
        Seen { times, observed_s: 1320.0, after_gap: 0, looks: 1, per_hour, has_cycle: times >= 2 }
    }

    #[test]
    fn a_rate_needs_a_full_cycle() {
        assert_eq!(seen(20, 15.0, 26.7).how_often().unwrap(), "about 20 times per hour");
        assert_eq!(seen(2, 0.5, 9.0).how_often().unwrap(), "twice in 22 min of observation");
        assert_eq!(seen(4, 0.05, 0.2).how_often().unwrap(), "about once in 10 h");
        assert_eq!(seen(1, 15.0, 26.7).how_often(), None);
        assert_eq!(changed(1, &seen(1, 0.1, 9.0)), "changed once in 22 min of observation");
        let gaps = Seen { after_gap: 2, looks: 9, ..seen(0, 0.1, 9.0) };
        assert_eq!((gaps.how_often(), &*changed(2, &gaps)), (None, "changed twice between 9 looks"));
        let gaps = Seen { after_gap: 3, looks: 9, has_cycle: true, ..seen(0, 1.5, 11.0) };
        let words = "changed 3 times between 9 looks: about 4 times per hour (1.5 to 11 times per hour)";
        assert_eq!(gaps.how_often().unwrap(), words);
        let words = [(20, 15.0), (20, 8.0), (20, 4.0), (20, 1.0), (1, 15.0)];
        let words = words.map(|(times, low)| seen(times, low, 26.7).sureness());
        let expected =
            ["sure", "fairly sure", "roughly known", "a first impression only", "a first impression only"];
        assert_eq!(words, expected);
    }

    #[test]
    fn a_range_is_in_the_unit_of_its_rate() {
        let ranges = [range(120.0, [30.0, 600.0]), range(6.0, [3.0, 12.0]), range(0.2, [0.1, 0.5])];
        let expected = ["30 to 600 times per hour", "3.0 to 12 times per hour", "once in 2.0 h to 10 h"];
        assert_eq!(ranges, expected);
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
