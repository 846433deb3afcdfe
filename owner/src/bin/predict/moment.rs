//! Times as people say them, and as they read them.

use cli::program::duration_s;
use jiff::civil::{DateTime, Time, Weekday};
use jiff::tz::TimeZone;
use jiff::{Timestamp, ToSpan, Zoned};
use mapper::Calendar;
use survey::Forecast;

/// The days of the week, from Monday on.
const WEEKDAYS: [&str; 7] = ["monday", "tuesday", "wednesday", "thursday", "friday", "saturday", "sunday"];

/// The time of `text`, s, as in `forecast`: a time after the last reading (`+10m`), a date (ISO 8601), or the next time of the
/// day (`17:10`) or of the week (`Tue 17:10`). A date before the last reading is refused: a forecast knows only the present and what
/// follows.
pub(crate) fn parse(text: &str, forecast: &Forecast) -> Result<f64, String> {
    let now_s = forecast.now_s();
    if let Some(ahead) = text.strip_prefix('+') {
        return duration_s(ahead).map(|ahead_s| now_s + ahead_s);
    }
    let zone = match forecast.calendar() {
        Calendar::Zone(zone) => zone,
        Calendar::Relative => {
            let why = forecast.why_undated().unwrap_or("it has no time zone");
            return Err(format!(
                "the state knows no hours ({why}): give a time after its last reading, as +10m"
            ));
        }
    };
    let time_s = in_zone(text, zone, now_s).ok_or_else(|| {
        "must be a time as +10m, 17:10, \"Tue 17:10\", 2024-01-30T17:10 or 2024-01-30T17:10Z".to_owned()
    })?;
    if time_s < now_s {
        // Rounded up: this text is a time that is accepted.
        let last = zoned(now_s.ceil(), zone).map(|at| at.strftime("%FT%T (%Z)").to_string());
        let last = last.unwrap_or_else(|| format!("{now_s:.0} s"));
        return Err(format!("must not be before the last reading, {last}"));
    }
    Ok(time_s)
}

/// The time of a text that names a date, or the next time of the day or of the week, s; `None` if it does not.
fn in_zone(text: &str, zone: &TimeZone, now_s: f64) -> Option<f64> {
    let seconds = |zoned: &Zoned| zoned.timestamp().as_duration().as_secs_f64();
    if let Ok(timestamp) = text.parse::<Timestamp>() {
        return Some(timestamp.as_duration().as_secs_f64());
    }
    if let Ok(date) = text.parse::<DateTime>() {
        return date.to_zoned(zone.clone()).ok().as_ref().map(seconds);
    }
    let (weekday, time) = match text.rsplit_once(' ') {
        Some((day, time)) => (Some(weekday(day.trim())?), time),
        None => (None, text),
    };
    let time: Time = format!("{time:0>5}").parse().ok()?; // 8:00 is 08:00
    next(&zoned(now_s, zone)?, weekday, time).as_ref().map(seconds)
}

/// The first of eight days on which this time of the day, on this weekday, is after `now`.
fn next(now: &Zoned, weekday: Option<Weekday>, time: Time) -> Option<Zoned> {
    let days = (0..=7).filter_map(|days| {
        let date = now.date().checked_add(days.days()).ok()?;
        date.to_datetime(time).to_zoned(now.time_zone().clone()).ok()
    });
    let mut fitting = days.filter(|at| at > now && weekday.is_none_or(|weekday| at.weekday() == weekday));
    fitting.next()
}

fn weekday(name: &str) -> Option<Weekday> {
    let name = name.to_lowercase();
    let day = WEEKDAYS.iter().position(|long| name.len() >= 2 && long.starts_with(&name))?;
    Weekday::from_monday_zero_offset(day as i8).ok()
}

fn zoned(time_s: f64, zone: &TimeZone) -> Option<Zoned> {
    Timestamp::from_second(time_s.floor() as i64).ok().map(|at| at.to_zoned(zone.clone()))
}

/// A time in words: in local civil time, or after the last reading.
pub(crate) fn text(time_s: f64, forecast: &Forecast) -> String {
    match forecast.calendar() {
        Calendar::Zone(zone) => zoned(time_s, zone)
            .map_or_else(|| format!("{time_s:.0} s"), |at| at.strftime("%a %Y-%m-%d %H:%M %Z").to_string()),
        Calendar::Relative => {
            let ahead_s = time_s - forecast.now_s();
            let side = if ahead_s < 0.0 { "before" } else { "after" };
            format!("{} {side} the last reading", owner::words::length_of(ahead_s.abs()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_time_is_after_now_and_summer_time_counts() {
        let berlin = TimeZone::get("Europe/Berlin").unwrap();
        // Saturday before the change to summer time.
        let now: Zoned = "2024-03-30T17:10[Europe/Berlin]".parse().unwrap();
        assert_eq!(now.time_zone(), &berlin);
        let at = |weekday: Option<&str>, time: &str| {
            let weekday = weekday.map(|name| super::weekday(name).unwrap());
            next(&now, weekday, time.parse().unwrap()).unwrap().strftime("%F %H:%M %:z").to_string()
        };
        assert_eq!(at(None, "17:10"), "2024-03-31 17:10 +02:00");
        assert_eq!(at(None, "18:00"), "2024-03-30 18:00 +01:00");
        assert_eq!(at(Some("Sat"), "17:10"), "2024-04-06 17:10 +02:00");
        assert_eq!(at(Some("tuesday"), "17:10"), "2024-04-02 17:10 +02:00");
        assert!(weekday("Tud").is_none() && weekday("t").is_none());
    }
}
