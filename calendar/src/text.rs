//! Times of the week and hours as text: `Mon 7:00`, `Mon-Fri 8:00-18:00`.

use crate::hours::{DAY_S, HOUR_S, Hours, WEEK_S};

const DAYS: [&str; 7] = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"];
const SLOTS_OF_DAY: usize = 48;

/// The time of the week, s since Monday 0:00, that a text such as `Mon 7:00` or `Sat` names.
///
/// # Errors
///
/// When the text is no time of the week; the message says what is valid.
pub fn time_of_week_s(text: &str) -> Result<f64, String> {
    let valid = || "a time of the week is a day and a time, as in `Mon 7:00`".to_owned();
    let mut words = text.split_whitespace();
    let day = words.next().and_then(day).ok_or_else(valid)?;
    let hour = words.next().map_or(Some(0.0), hour).filter(|hour| *hour < 24.0).ok_or_else(valid)?;
    match words.next() {
        None => Ok(day as f64 * DAY_S + hour * HOUR_S),
        Some(_) => Err(valid()),
    }
}

/// A time of the week in words: `Mon 7:05`.
pub fn moment(time_s: f64) -> String {
    let minutes = (time_s.rem_euclid(WEEK_S) / 60.0).floor() as usize;
    let (day, minute) = (minutes / 1440 % 7, minutes % 1440);
    format!("{} {}:{:02}", DAYS[day], minute / 60, minute % 60)
}

impl Hours {
    /// Adds hours by a text such as `Mon-Fri 8:00-18:00`, `Sat 22:00-2:00` or `daily 7:00-20:00`. Hours that end before they
    /// begin end on the next day.
    ///
    /// # Errors
    ///
    /// When the text is none, or the hours last no time; the message says what is valid.
    pub fn add(&mut self, text: &str) -> Result<(), String> {
        let valid = || {
            "hours are days, and from when to when in half hours, as in `Mon-Fri 8:00-18:00`, `Sat 22:00-2:00` or `daily 7:00-20:00`".to_owned()
        };
        let (days, hours) = text.trim().split_once(char::is_whitespace).ok_or_else(valid)?;
        let (first, last) = match days {
            "daily" => (0, 6),
            days => match days.split_once('-') {
                Some((first, last)) => (day(first).ok_or_else(valid)?, day(last).ok_or_else(valid)?),
                None => day(days).map(|day| (day, day)).ok_or_else(valid)?,
            },
        };
        let (from, until) = hours.trim().split_once('-').ok_or_else(valid)?;
        let half = |text: &str| hour(text).filter(|hour| (2.0 * hour).fract() == 0.0).ok_or_else(valid);
        let (from_h, until_h) = (half(from)?, half(until)?);
        if from_h == 24.0 || from_h == until_h {
            return Err(format!("`{}` is no time: a whole day is `0:00-24:00`", hours.trim()));
        }
        for ahead in 0..=(last + 7 - first) % 7 {
            let day = first + ahead;
            if until_h > from_h {
                self.set(day, from_h, until_h, true);
            } else {
                self.set(day, from_h, 24.0, true);
                self.set(day + 1, 0.0, until_h, true);
            }
        }
        Ok(())
    }

    /// The hours as texts that [`Self::add`] reads.
    pub fn texts(&self) -> Vec<String> {
        let days: Vec<Vec<[usize; 2]>> = (0..7).map(|day| self.stretches(day)).collect();
        let mut texts = Vec::new();
        let mut first = 0;
        for alike in days.chunk_by(|a, b| a == b) {
            let last = first + alike.len() - 1;
            let name = match (first, last) {
                (0, 6) => "daily".to_owned(),
                _ if first == last => DAYS[first].to_owned(),
                _ => format!("{}-{}", DAYS[first], DAYS[last]),
            };
            let time = |slot: usize| format!("{}:{:02}", slot / 2, 30 * (slot % 2));
            texts.extend(
                alike[0].iter().map(|[from, until]| format!("{name} {}-{}", time(*from), time(*until))),
            );
            first = last + 1;
        }
        texts
    }

    /// The active stretches of a day, in half hours from midnight.
    fn stretches(&self, day: usize) -> Vec<[usize; 2]> {
        let is_active = |slot: &usize| self.is_active(day as f64 * DAY_S + *slot as f64 * 0.5 * HOUR_S);
        let slots: Vec<bool> = (0..SLOTS_OF_DAY).map(|slot| is_active(&slot)).collect();
        let mut from = 0;
        let mut stretches = Vec::new();
        for alike in slots.chunk_by(|a, b| a == b) {
            if alike[0] {
                stretches.push([from, from + alike.len()]);
            }
            from += alike.len();
        }
        stretches
    }
}

/// The index of a day by the first three letters of its name.
fn day(text: &str) -> Option<usize> {
    DAYS.iter().position(|day| *day == text)
}

/// A time of day, hours, from `0:00` to `24:00`.
fn hour(text: &str) -> Option<f64> {
    let (hours, minutes) = text.trim().split_once(':')?;
    let minutes = minutes.parse::<u32>().ok().filter(|value| minutes.len() == 2 && *value < 60)?;
    let hours = hours.parse::<u32>().ok().filter(|hours| *hours < 24 || (*hours, minutes) == (24, 0))?;
    Some(f64::from(hours) + f64::from(minutes) / 60.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hours(texts: &[&str]) -> Hours {
        let mut hours = Hours::never();
        texts.iter().for_each(|text| hours.add(text).unwrap());
        hours
    }

    #[test]
    fn hours_are_read_and_written() {
        for texts in [
            &["Mon-Fri 8:00-18:00"][..],
            &["daily 0:00-24:00"],
            &["Mon 9:00-12:30", "Mon 13:00-17:00", "Sat-Sun 10:00-11:30"],
        ] {
            assert_eq!(hours(texts).texts(), texts);
        }
        assert_eq!(
            hours(&["Fri-Mon 22:00-2:00"]).texts(),
            hours(&["Fri 22:00-24:00", "Sat-Mon 0:00-2:00", "Sat-Mon 22:00-24:00", "Tue 0:00-2:00"]).texts()
        );
        assert_eq!(hours(&["Mon-Fri 8:00-18:00"]), Hours::daily(&[0, 1, 2, 3, 4], 8.0, 18.0));
        for wrong in [
            "",
            "Mon",
            "8:00-18:00",
            "Mon 8-18",
            "Moon 8:00-9:00",
            "Mon 8:10-9:00",
            "Mon 8:00-25:00",
            "Mon 8:0-9:00",
            "Mon 8:00-24:01",
            "Mon 8:00-99999999:00",
        ] {
            assert!(Hours::never().add(wrong).unwrap_err().contains("`Mon-Fri 8:00-18:00`"), "{wrong}");
        }
        for wrong in ["Mon 9:00-9:00", "Mon 24:00-24:00", "Mon 24:00-2:00"] {
            assert!(
                Hours::never().add(wrong).unwrap_err().ends_with("a whole day is `0:00-24:00`"),
                "{wrong}"
            );
        }
    }

    #[test]
    fn times_of_the_week_are_read_and_written() {
        assert_eq!(time_of_week_s("Mon 7:00"), Ok(7.0 * HOUR_S));
        assert_eq!(time_of_week_s("Sun"), Ok(6.0 * DAY_S));
        assert_eq!(moment(time_of_week_s("Wed 17:05").unwrap()), "Wed 17:05");
        for wrong in ["", "7:00", "Mon 24:00", "Mon 99999999:00", "Mon 7", "Mon 7:00 h", "mon 7:00"] {
            assert!(time_of_week_s(wrong).is_err(), "{wrong}");
        }
    }
}
