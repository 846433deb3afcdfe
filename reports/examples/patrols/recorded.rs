//! What the things of a building do if they repeat recorded series.

use anyhow::{Context, ensure};
use days::ThingKind;
use days::calendar::{Change, DAY_S, Recording, Timeline};
use interfaces::{Purpose, RandomStream};
use std::path::{Path, PathBuf};

/// Series of doors and of other things.
#[derive(Default)]
pub(crate) struct Recorded {
    doors: Vec<Series>,
    others: Vec<Series>,
}

/// What one thing did in a real building.
struct Series {
    /// The building: the name of the file up to the first `-`.
    building: String,
    /// The times of the changes, s, and the new states: 1 in the file is `true`.
    changes: Vec<Change>,
    end_s: f64,
}

/// The series of the things of one building. Things that were recorded in the same real building repeat the same days, as long as no
/// series is used twice.
pub(crate) struct Draw<'a> {
    recorded: &'a Recorded,
    days: f64,
    rng: RandomStream,
    /// The series of doors and of other things that are not yet used; all of them again after the last one.
    left: [Vec<&'a Series>; 2],
    /// The start of the days that are repeated, s, for each real building.
    starts_s: Vec<(&'a str, f64)>,
}

impl Recorded {
    /// Reads the series of doors (1 is open) and of other things (1 is present), of which there must be one of each.
    pub(crate) fn read(doors: &[PathBuf], others: &[PathBuf], days: f64) -> anyhow::Result<Self> {
        let read = |paths: &[PathBuf]| -> anyhow::Result<Vec<Series>> {
            paths.iter().map(|path| Series::read(path)).collect()
        };
        let recorded = Self { doors: read(doors)?, others: read(others)? };
        for series in recorded.all() {
            let building = &series.building;
            ensure!(
                !recorded.starts_s(building, days).is_empty(),
                "the series `{building}-…` have no {days} days in a row, from midnight on, in which all of them were recorded"
            );
        }
        Ok(recorded)
    }

    fn all(&self) -> impl Iterator<Item = &Series> {
        self.doors.iter().chain(&self.others)
    }

    /// The midnights after which every series of a real building was recorded for a number of days.
    fn starts_s(&self, building: &str, days: f64) -> Vec<f64> {
        let series: Vec<&Series> = self.all().filter(|series| series.building == building).collect();
        let first = series.iter().map(|series| (series.start_s() / DAY_S).ceil()).fold(0.0, f64::max);
        let last = series.iter().map(|series| series.end_s / DAY_S - days).fold(f64::INFINITY, f64::min);
        let starts_s = (0..).map(|day| (first + f64::from(day)) * DAY_S);
        let starts_s = starts_s.take_while(|start_s| *start_s <= last * DAY_S);
        let is_whole = |start_s: &f64| series.iter().all(|series| series.is_whole(*start_s, days));
        starts_s.filter(is_whole).collect()
    }

    /// Draws series for the things of a building.
    pub(crate) fn draw(&self, days: f64, seed: u64) -> Draw<'_> {
        let rng = RandomStream::new(seed, Purpose::Thing(0));
        Draw { recorded: self, days, rng, left: [Vec::new(), Vec::new()], starts_s: Vec::new() }
    }
}

impl Draw<'_> {
    /// What the next thing of a building does.
    pub(crate) fn timeline(&mut self, kind: ThingKind) -> Timeline {
        let is_door = kind == ThingKind::Door;
        let left = usize::from(!is_door);
        if self.left[left].is_empty() {
            // The second thing with a series mostly repeats other days of it.
            self.starts_s.clear();
            let all = if is_door { &self.recorded.doors } else { &self.recorded.others };
            self.left[left] = all.iter().collect();
        }
        let index = self.below(self.left[left].len());
        let series = self.left[left].swap_remove(index);
        let known = self.starts_s.iter().find(|(building, _)| *building == series.building);
        let start_s = known.map(|(_, start_s)| *start_s).unwrap_or_else(|| {
            let starts_s = self.recorded.starts_s(&series.building, self.days);
            let start_s = starts_s[self.below(starts_s.len())];
            self.starts_s.push((&series.building, start_s));
            start_s
        });
        let changes = series.changes_from(start_s).into_iter();
        // An open door does not block.
        let changes: Vec<(f64, bool)> = changes.map(|(time_s, is_one)| (time_s, is_one != is_door)).collect();
        Timeline::recorded(&changes)
    }

    fn below(&mut self, count: usize) -> usize {
        self.rng.uniform(0.0..count as f64) as usize
    }
}

impl Series {
    fn read(path: &Path) -> anyhow::Result<Self> {
        let at = || format!("cannot read {}", path.display());
        let text = std::fs::read_to_string(path).with_context(at)?;
        let recording = Recording::parse(&text).with_context(at)?;
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let building = name.split('-').next().unwrap_or(&name).to_owned();
        let end_s = recording.end_s.unwrap_or(recording.last_s()).min(recording.limit_s());
        Ok(Self { building, changes: recording.changes, end_s })
    }

    fn start_s(&self) -> f64 {
        self.changes[0].0
    }

    /// The number of changes up to a time.
    fn until(&self, time_s: f64) -> usize {
        self.changes.partition_point(|(changed_s, _)| *changed_s <= time_s)
    }

    /// Whether the series was recorded all the time, for a number of days from a time on.
    fn is_whole(&self, start_s: f64, days: f64) -> bool {
        let end = self.until(start_s + days * DAY_S);
        let from = self.until(start_s).saturating_sub(1);
        self.changes[from..end].iter().all(|(_, state)| state.is_some())
    }

    /// The state at a time and the changes after it; their times are since that time, s.
    fn changes_from(&self, start_s: f64) -> Vec<(f64, bool)> {
        let from = self.until(start_s).saturating_sub(1);
        let known = self.changes[from..].iter();
        known.filter_map(|(time_s, state)| Some(((time_s - start_s).max(0.0), (*state)?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(building: &str, changes: &[(f64, Option<bool>)]) -> Series {
        let changes = changes.iter().map(|(day, state)| (day * DAY_S, *state)).collect();
        Series { building: building.to_owned(), changes, end_s: 10.0 * DAY_S }
    }

    fn recorded() -> Recorded {
        Recorded {
            doors: vec![series("a", &[(0.0, Some(false)), (5.5, Some(true)), (5.75, Some(false))])],
            others: vec![
                series("a", &[(0.0, Some(true)), (2.0, None), (2.5, Some(false)), (9.5, None)]),
                series("b", &[(0.25, Some(false)), (6.0, Some(true))]),
            ],
        }
    }

    #[test]
    fn days_with_a_gap_are_not_repeated() {
        let days = |building, days| -> Vec<f64> {
            recorded().starts_s(building, days).iter().map(|start_s| start_s / DAY_S).collect()
        };
        assert_eq!(days("a", 1.0), [0.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        assert_eq!(days("a", 6.0), [3.0]);
        assert_eq!(days("b", 7.0), [1.0, 2.0, 3.0]);
        assert!(days("a", 7.0).is_empty());
    }

    #[test]
    fn things_repeat_the_same_days_and_an_open_door_does_not_block() {
        let recorded = recorded();
        for seed in 0..20 {
            let mut draw = recorded.draw(6.0, seed);
            let mut door = draw.timeline(ThingKind::Door);
            let mut others = [draw.timeline(ThingKind::Box), draw.timeline(ThingKind::Person)];
            let [start_s, other_s] = ["a", "b"].map(|building| {
                draw.starts_s.iter().find(|(name, _)| *name == building).map_or(f64::NAN, |found| found.1)
            });
            assert_eq!(start_s, 3.0 * DAY_S);
            others.iter_mut().for_each(|other| other.advance(0.0, |_, _| ()));
            door.advance(0.0, |_, _| ());
            assert!(door.is_blocked() && others.iter().all(|other| !other.is_blocked()));
            let mut changes = Vec::new();
            door.advance(6.0 * DAY_S, |time_s, is_blocked| changes.push((time_s, is_blocked)));
            assert_eq!(changes, [(2.5 * DAY_S, false), (2.75 * DAY_S, true)]);
            let until_s = 6.0 * DAY_S - other_s;
            others.iter_mut().for_each(|other| other.advance(until_s, |_, _| ()));
            assert_eq!(others.iter().filter(|other| other.is_blocked()).count(), 1);
        }
    }
}
