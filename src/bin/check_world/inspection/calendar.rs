//! The calendar of a world in words.

use calendar::{Habit, Hours, Schedule, Stays, moment};
use results::numbers::{duration, percent};
use sim::physics::PatrolDaySpec;

/// When the world starts.
pub(super) fn of_world(starts_s: f64) -> String {
    format!("the world starts on {}", moment(starts_s))
}

/// When a thing is blocked.
pub(super) fn of_thing(schedule: &Schedule) -> String {
    let starts = if schedule.starts_blocked { "at the start" } else { "not at the start" };
    let Habit { hours, active, quiet } = &schedule.habit;
    if *hours == Hours::always() {
        return format!("{}; {starts}", of_stays(active));
    }
    let [active, quiet] = [active, quiet].map(of_stays);
    format!("{}: {active}; in other hours: {quiet}; {starts}", hours.texts().join(", "))
}

/// The day of a robot.
pub(super) fn of_robot(day: &PatrolDaySpec) -> String {
    let dock = day.dock.map_or("where it starts".to_owned(), |at| format!("at ({}, {}) m", at.x, at.y));
    let busy = day.busy.texts();
    let busy = if busy.is_empty() { String::new() } else { format!(", busy {}", busy.join(", ")) };
    format!(
        "on patrol for {} of the time, {} on a battery, dock {dock}{busy}",
        percent(day.share),
        duration(day.battery_s)
    )
}

fn of_stays([free, blocked]: &[Stays; 2]) -> String {
    format!("{} in the mean, then not for {}", of_state(blocked), of_state(free))
}

fn of_state(stays: &Stays) -> String {
    if stays.long_share == 0.0 {
        return duration(stays.short_s);
    }
    format!(
        "{} ({} of the times {})",
        duration(stays.short_s),
        percent(stays.long_share),
        duration(stays.long_s)
    )
}
