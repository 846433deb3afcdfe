//! Whether the intervals of the usual hours hold on recorded things.

use crate::series::{LOOKS, Looks, STEP_S, Series};
use mapper::{Calendar, Clock, DAY_S, Week};
use rayon::prelude::*;
use std::io::{Result, Write};

/// The half hours of a week.
const SLOTS: usize = 336;
/// The share of fewer weeks says little.
const MIN_WEEKS: f64 = 3.0;

/// For every kind of looks: of the half hours of the week after the split, the share in which the thing was blocked as often as
/// the 90 % interval says, and the mean length of the interval.
pub(crate) fn print(series: &[Series], calendar: &Calendar, out: &mut impl Write) -> Result<()> {
    writeln!(
        out,
        "\nUsual hours: share of the half hours inside their 90 % interval, and its mean length\n"
    )?;
    for (name, looks) in LOOKS {
        let of_series = series.par_iter().map(|series| inside(series, looks, calendar));
        let [inside, all, length] =
            of_series.reduce(|| [0.0; 3], |a, b| std::array::from_fn(|part| a[part] + b[part]));
        if all > 0.0 {
            writeln!(out, "{name:7} {:.3} {:.3} {all} half hours", inside / all, length / all)?;
        }
    }
    Ok(())
}

/// The number of half hours inside, of all, and the sum of the lengths of the intervals.
fn inside(series: &Series, looks: Looks, calendar: &Calendar) -> [f64; 3] {
    let Some(week) = learned(series, looks, calendar) else { return [0.0; 3] };
    let mut sums = [0.0; 3];
    for (usual, [blocked, days]) in week.slots().iter().zip(seen_after(series, calendar)) {
        if days >= MIN_WEEKS {
            let [low, high] = usual.interval_90_of_weeks(days);
            let is_inside = (low..=high).contains(&(blocked / days));
            sums = [sums[0] + f64::from(u8::from(is_inside)), sums[1] + 1.0, sums[2] + high - low];
        }
    }
    sums
}

fn learned(series: &Series, looks: Looks, calendar: &Calendar) -> Option<Week> {
    let is_seen = looks.draw(series.states.len(), 0);
    let mut clock = Clock::default();
    for look in (0..series.split()).filter(|step| is_seen[*step]).filter_map(|step| series.look(step)) {
        clock.observe(look, calendar);
    }
    clock.week(calendar)
}

/// For each half hour of the week, after the split: the sum over days of the share in which the thing was blocked, and the
/// number of days.
fn seen_after(series: &Series, calendar: &Calendar) -> Vec<[f64; 2]> {
    let steps_of_slot = (DAY_S / 48.0 / STEP_S) as usize;
    let mut seen = vec![[0.0; 2]; SLOTS];
    for first in (series.split()..series.states.len()).step_by(steps_of_slot) {
        let looks: Vec<_> = (first..first + steps_of_slot).filter_map(|step| series.look(step)).collect();
        let blocked = looks.iter().filter(|look| look.is_blocked).count();
        if looks.len() == steps_of_slot {
            let hour = calendar.hour_of_week(looks[0].time_s).unwrap_or_default();
            let slot = &mut seen[(2.0 * hour) as usize % SLOTS];
            *slot = [slot[0] + blocked as f64 / looks.len() as f64, slot[1] + 1.0];
        }
    }
    seen
}
