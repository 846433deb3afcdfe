//! What is usual in a week, in words and as a small picture.

use mapper::{UsualChange, Week};
use maud::{Markup, html};
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

/// The width of half an hour and the height of a day in the picture, and the space for the names of days.
const SLOT: usize = 5;
const ROW: usize = 12;
const LEFT: usize = 28;
/// The steps in which probabilities are drawn: neighbors of one step are one rectangle.
const STEPS: f64 = 10.0;

/// A picture of a week: a row per day, from 0 to 24 o'clock. White: never blocked; dark: always. Hours of which little is known
/// are pale.
pub fn picture(week: &Week, name: &str) -> Markup {
    let slots = week.slots();
    let slots_of_day = slots.len() / DAYS.len();
    let (width, height) = (LEFT + SLOT * slots_of_day + 4, ROW * (DAYS.len() + 1));
    html! {
        svg.week xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (width) " " (height) } width=(width) height=(height)
            role="img" aria-label=(usual_hours(week, name)) font-size="9" font-family="sans-serif" {
            @for (day, slots) in slots.chunks(slots_of_day).enumerate() {
                text x="0" y=(ROW * day + 9) { (DAYS[day]) }
                @let steps: Vec<(u32, u32)> = slots.iter().map(|slot| {
                    let [low, high] = slot.interval_90;
                    ((STEPS * slot.probability).round() as u32, (STEPS * (1.0 - 0.8 * (high - low))).round() as u32)
                }).collect();
                @let mut at = 0;
                @for run in steps.chunk_by(|a, b| a == b) {
                    rect x=(LEFT + SLOT * at) y=(ROW * day) width=(SLOT * run.len()) height=(ROW - 1)
                        fill=(color(f64::from(run[0].0) / STEPS)) opacity={ (f64::from(run[0].1) / STEPS) } {}
                    @let () = at += run.len();
                }
            }
            @for hour in [0, 6, 12, 18, 24] {
                text x=(LEFT + SLOT * slots_of_day * hour / 24) y=(height - 2) text-anchor="middle" { (hour) }
            }
        }
    }
}

/// From light gray to dark blue.
fn color(share: f64) -> String {
    let mix = |from: f64, to: f64| (from + share * (to - from)) as u8;
    format!("#{:02x}{:02x}{:02x}", mix(232.0, 10.0), mix(234.0, 60.0), mix(238.0, 140.0))
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

    #[test]
    fn the_picture_has_a_row_per_day() {
        let picture = picture(&week(|day, _| day < 5), "blocked").into_string();
        assert!(DAYS.iter().all(|day| picture.contains(day)), "{picture}");
        assert!(picture.matches("<rect").count() >= 7);
    }
}
