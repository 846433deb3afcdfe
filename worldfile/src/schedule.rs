//! The calendar of a world: when it starts, and the schedules of its things.

use crate::reader::{Table, Value};
use calendar::{Habit, Hours, Schedule, Stays, time_of_week_s};
use toml::Value as Toml;

/// The keys of a schedule.
pub(crate) const KEYS: &str = "hours, free_s, blocked_s, quiet_free_s, quiet_blocked_s, starts_blocked";
/// The shortest and the longest mean stay, s.
const STAY_S: std::ops::RangeInclusive<f64> = 1.0..=1e9;

/// The time of the week at the start of the world, s, of the key `starts`: Monday 0:00 without the key. `None`: invalid.
/// `Some(None)`: there is neither the key nor, `is_needed`, anything with a calendar.
pub(crate) fn starts_s(root: &Table<'_>, is_needed: bool) -> Option<Option<f64>> {
    let Some(value) = root.get("starts") else { return Some(is_needed.then_some(0.0)) };
    match time_of_week_s(value.text()?) {
        Ok(time_s) => Some(Some(time_s)),
        Err(help) => value.invalid("is no time of the week", "not understood", &help),
    }
}

/// The schedule of the thing `name`, whose table is `thing`. `Some(None)`: it has none.
pub(crate) fn schedule(thing: &Table<'_>, name: &str) -> Option<Option<Schedule>> {
    let Some(value) = thing.get("schedule") else { return Some(None) };
    let table = value.table(KEYS)?;
    table.sound(Some(habit(&table, name)?))
}

/// The hours that a list of texts names.
pub(crate) fn hours(value: &Value<'_, '_>) -> Option<Hours> {
    let mut hours = Hours::never();
    value.list(|item| match hours.add(item.text()?) {
        Ok(()) => Some(()),
        Err(help) => item.invalid("has hours that are not understood", "these hours", &help),
    })?;
    Some(hours)
}

fn habit(table: &Table<'_>, name: &str) -> Option<Schedule> {
    if !table.has("free_s") || !table.has("blocked_s") {
        let help = "it needs `free_s` and `blocked_s`, the mean stays in both states";
        let what = format!("the schedule of `{name}` is not complete");
        return table.error(&what, (table.span.clone(), "this schedule"), &[], help);
    }
    let hours = table.get("hours").map_or(Some(Hours::always()), |value| hours(&value));
    let [free, blocked] = ["free_s", "blocked_s"].map(|key| table.get(key).and_then(|value| stays(&value)));
    let quiet = |key, active: Option<Stays>| table.get(key).map_or(active, |value| stays(&value));
    let (quiet_free, quiet_blocked) = (quiet("quiet_free_s", free), quiet("quiet_blocked_s", blocked));
    let starts_blocked = table.get("starts_blocked").map_or(Some(true), |value| value.flag());
    let habit = Habit { hours: hours?, active: [free?, blocked?], quiet: [quiet_free?, quiet_blocked?] };
    Some(Schedule { habit, starts_blocked: starts_blocked? })
}

/// Stays in a state: their mean, or the mean of short ones, that of long ones, and the share of long ones.
fn stays(value: &Value<'_, '_>) -> Option<Stays> {
    if !value.is_list() {
        return value.within(&STAY_S).map(Stays::of_mean);
    }
    let items = value.items()?;
    let [short, long, share] = items.as_slice() else {
        let help = "it must be the mean stay, or three numbers: the mean of short stays, the mean of long stays, and the \
                    share of stays that are long, as in `[300.0, 14400.0, 0.2]`";
        return value.invalid(&format!("has {} numbers", items.len()), "these numbers", help);
    };
    let (short, long, share) = (short.within(&STAY_S), long.within(&STAY_S), share.within(&(0.0..=1.0)));
    Some(Stays { short_s: short?, long_s: long?, long_share: share? })
}

/// The keys of a schedule with their values.
pub(crate) fn write_schedule(schedule: &Schedule) -> Vec<(&'static str, Toml)> {
    let habit = &schedule.habit;
    let mut keys = Vec::new();
    if habit.hours != Hours::always() {
        keys.push(("hours", habit.hours.texts().into()));
    }
    let names = [["free_s", "blocked_s"], ["quiet_free_s", "quiet_blocked_s"]];
    for (names, stays) in names.iter().zip([&habit.active, &habit.quiet]) {
        let all = names.iter().zip(stays).map(|(name, stays)| (*name, stays_value(stays)));
        keys.extend(all);
    }
    keys.push(("starts_blocked", schedule.starts_blocked.into()));
    keys
}

fn stays_value(stays: &Stays) -> Toml {
    if *stays == Stays::of_mean(stays.short_s) {
        return stays.short_s.into();
    }
    [stays.short_s, stays.long_s, stays.long_share].map(Toml::from).to_vec().into()
}
