//! What is usual in a week, in words.

use mapper::{UsualChange, Week};
use results::numbers::percent;

const DAYS: [&str; 7] = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"];
const WEEK_H: f64 = 168.0;
/// Stays whose begins and ends differ by less than this time, h, are one entry of the text.
const SAME_H: f64 = 0.75;

/// A stay in the blocked state, every week at the same time.
#[derive(Clone, Copy)]
struct Stay {
    from: UsualChange,
    until: UsualChange,
}

impl Stay {
    fn day(&self) -> usize {
        (self.from.hour / 24.0) as usize % DAYS.len()
    }

    /// The hour of the day at which it begins, and its length, h.
    fn hours(&self) -> [f64; 2] {
        [self.from.hour % 24.0, (self.until.hour - self.from.hour).rem_euclid(WEEK_H)]
    }

    fn is_like(&self, other: &Self) -> bool {
        self.hours().iter().zip(other.hours()).all(|(hours, others)| (hours - others).abs() < SAME_H)
    }

    /// Half the length of the intervals of its begin and its end, h.
    fn uncertainty_h(&self) -> f64 {
        [self.from, self.until].iter().map(|change| change.latest_hour - change.earliest_hour).sum::<f64>()
            / 4.0
    }
}

/// When a thing is usually in the blocked state, which has this name: “open Mon to Fri 8:10 to 17:20 (± 30 min)”.
pub fn usual_hours(week: &Week, name: &str) -> String {
    let changes = week.usual_changes();
    let begins = changes.iter().enumerate().filter(|(_, change)| change.becomes_blocked);
    let stays: Vec<Stay> =
        begins.map(|(at, from)| Stay { from: *from, until: changes[(at + 1) % changes.len()] }).collect();
    if stays.is_empty() {
        let mean = week.slots().iter().map(|slot| slot.probability).sum::<f64>() / week.slots().len() as f64;
        return format!("{name} {} of the time, at no hours in particular", percent(mean));
    }
    let groups = stays.chunk_by(|a, b| a.is_like(b) && b.day() == a.day() + 1);
    let texts: Vec<String> = groups.map(in_words).collect();
    format!("{name} {}", texts.join("; "))
}

/// Stays on consecutive days, at the same hours.
fn in_words(stays: &[Stay]) -> String {
    let mean = |of: &dyn Fn(&Stay) -> f64| stays.iter().map(of).sum::<f64>() / stays.len() as f64;
    let (from, length) = (mean(&|stay| stay.hours()[0]), mean(&|stay| stay.hours()[1]));
    let [first, last] = [stays[0].day(), stays[stays.len() - 1].day()];
    let days =
        if first == last { DAYS[first].to_owned() } else { format!("{} to {}", DAYS[first], DAYS[last]) };
    let until = from + length;
    let until_day = if until >= 24.0 && length >= 12.0 && stays.len() == 1 {
        format!("{} ", DAYS[(first + (until / 24.0) as usize) % DAYS.len()])
    } else {
        String::new()
    };
    let minutes = 10.0 * (6.0 * mean(&Stay::uncertainty_h)).ceil();
    format!("{days} {} to {until_day}{} (± {minutes:.0} min)", time_of_day(from), time_of_day(until))
}

/// An hour as a time of day, to ten minutes.
fn time_of_day(hour: f64) -> String {
    let tens = (6.0 * hour).round() as u32 % 144;
    format!("{}:{}0", tens / 6, tens % 6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mapper::{Calendar, Clock, DAY_S, Look};

    /// Four weeks of a thing that is blocked at these hours of these days of the week.
    fn week(is_blocked: impl Fn(u32, f64) -> bool) -> Week {
        const MONDAY_S: f64 = 1_704_067_200.0;
        let mut clock = Clock::default();
        for look in 0..29 * 144 {
            let (day, hour) = (look / 144, f64::from(look % 144) / 6.0);
            let time_s = MONDAY_S + f64::from(day) * DAY_S + 3600.0 * hour;
            clock.observe(Look { time_s, is_blocked: is_blocked(day % 7, hour) }, &Calendar::UTC);
        }
        clock.week(&Calendar::UTC).unwrap()
    }

    #[test]
    fn usual_hours_are_told_as_people_do() {
        let text = |is_blocked: fn(u32, f64) -> bool| usual_hours(&week(is_blocked), "open");
        let office = text(|day, hour| day < 5 && (9.0..17.0).contains(&hour));
        assert!(office.starts_with("open Mon to Fri 9:"), "{office}");
        let market = text(|day, hour| day == 2 || day == 5 && hour < 14.0);
        assert!(market.contains("Wed") && market.contains("Sat"), "{market}");
        let night = text(|_, hour| !(6.0..22.0).contains(&hour));
        assert!(night.contains("to 6:"), "{night}");
        assert_eq!(text(|_, _| true), "open >99.9 % of the time, at no hours in particular");
        assert_eq!(text(|_, _| false), "open <0.1 % of the time, at no hours in particular");
    }
}
