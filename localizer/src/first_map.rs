//! The readings of a robot that maps a place for the first time, and whether they must be read again.

use crate::constants::{AMBIGUOUS, LOG_NOISE_M, NEAR_STD, SEARCH_EVERY, STDS, SUBMAP_KEYFRAMES};
use crate::estimate::{Localized, PoseEstimate, PoseState};
use crate::motion::Predicted;
use crate::settings::LocalizerSettings;
use crate::trajectory::{TrajectoryFinder, in_frame};
use interfaces::{Cell, CellState, Grid, LaserReading, SettingsError, Spread, heading_rad};
use nalgebra::{Isometry2, Matrix3, Vector2};
use std::collections::BTreeSet;

/// Motions in the map and by matching that differ by more than this, and than this many standard deviations, are inconsistent.
const INCONSISTENT: Spread = Spread::of_error(0.06);
/// Keyframes of the longer way over which motions are compared: about 5 m.
const WINDOW: usize = 16;
/// Ways on known ground after which the map is frozen: without openings, and with openings that may be too narrow, m.
const FROZEN_WAY_M: f64 = 60.0;
const OPENING_WAY_M: f64 = 300.0;
/// The first map is frozen after this number of readings, which bounds the memory: half an hour at 10 Hz.
const MAX_READINGS: usize = 18_000;
/// The same after this many readings in a row that do not agree with those before: the robot was carried.
const BROKEN_READINGS: u32 = 10;
/// Maximum number of rejected replays.
const MAX_REJECTED: u32 = 3;
/// Errors of a certain pose, and of the corrected trajectory, which are the same for many scans.
const CERTAIN_STD: Spread = Spread { m: 0.01, rad: 0.003 };
const CORRECTED_STD: Spread = Spread::of_error(0.003);

/// A reading, and what the localizer has made of it.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct Kept {
    /// The reading as its source gave it.
    pub(crate) reading: LaserReading,
    /// Whether the mapper paused before it.
    pub(crate) is_after_pause: bool,
    /// The pose in the map.
    pub(crate) pose: Isometry2<f64>,
    pub(crate) state: PoseState,
    /// Whether the pose is known well enough to be compared with a loop.
    is_known: bool,
}

/// What is in a state file: the rest follows from the readings.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Log {
    /// The readings so far.
    pub(crate) kept: Vec<Kept>,
    /// The time of the latest reading, s.
    time_s: f64,
    /// The last reading with a certain pose.
    last_certain: Option<usize>,
    /// The last keyframe with a known pose.
    last_known: Option<usize>,
    /// The number of loops that were compared with the map.
    pub(crate) loops: usize,
    /// Whether the map is inconsistent, as far as is known.
    is_inconsistent: bool,
    /// The number of scans until the readings are read again.
    rest: Option<u32>,
    /// Whether the robot has gone far enough without new ground, and the map has no openings.
    is_whole: bool,
    /// The number of rejected replays.
    refused: u32,
    /// The number of readings since one agreed with its submap, and whether there were too many.
    unsupported: u32,
    is_broken: bool,
}

/// The readings so far, and their trajectory with all loops.
#[derive(Debug)]
pub(crate) struct FirstMap {
    finder: TrajectoryFinder,
    /// The numbers of the readings that are keyframes.
    keyframes: Vec<usize>,
    pub(crate) log: Log,
}

impl FirstMap {
    pub(crate) fn new(settings: &LocalizerSettings) -> Result<Self, SettingsError> {
        let range_noise_std_m = settings.range_noise_std_m.max(LOG_NOISE_M);
        let settings = LocalizerSettings { range_noise_std_m, ..settings.clone() };
        let mut finder = TrajectoryFinder::new(&settings)?;
        // A robot that rests at the start does not go on as before.
        finder.builder.motion_prior.exists = true;
        Ok(Self { finder, keyframes: Vec::new(), log: Log::default() })
    }

    /// The first map with this log: the trajectory is found again. `None` if the log cannot be that of a first map.
    pub(crate) fn with_log(settings: &LocalizerSettings, log: Log) -> Option<Self> {
        let mut first = Self::new(settings).ok()?;
        for (number, kept) in log.kept.iter().enumerate() {
            first.find(&kept.reading, number);
        }
        let is_known = log.last_known.is_none_or(|last| last < first.keyframes.len())
            && log.last_certain.is_none_or(|last| last < log.kept.len());
        (is_known && log.loops == first.finder.loops().len()).then_some(Self { log, ..first })
    }

    /// Finds the trajectory to reading `number`.
    fn find(&mut self, reading: &LaserReading, number: usize) {
        self.finder.add(reading.clone());
        if self.finder.keyframe_count() > self.keyframes.len() {
            self.keyframes.push(number);
        }
    }

    /// Whether the map is_frozen: its frame does not move any more.
    pub(crate) fn is_frozen(&self) -> bool {
        let is_over = self.log.kept.len() >= MAX_READINGS || self.log.is_broken;
        self.log.rest.is_none() && (self.log.is_whole || is_over)
    }

    /// Takes the next reading. The result is where the robot is, from its last certain pose on; `None` if the last reading
    /// was certain, or if a scan since then did not agree with those before.
    pub(crate) fn pose_prior(&mut self, reading: &LaserReading) -> Option<Predicted> {
        let number = self.log.kept.len();
        self.find(reading, number);
        self.log.unsupported = if self.finder.is_supported() { 0 } else { self.log.unsupported + 1 };
        self.log.is_broken |= self.log.unsupported >= BROKEN_READINGS;
        let last = self.log.last_certain.filter(|last| last + 1 < number)?;
        let (motion, spread) = self.finder.motion_since(last)?;
        let at = self.log.kept[last].pose;
        let covariance = in_frame(&spread, &at.inverse()) + CERTAIN_STD.covariance();
        Some(Predicted::rigid(at * motion, covariance))
    }

    /// Whether the mapper, whose time is `map_s`, has paused since the last reading.
    pub(crate) fn is_after_pause(&self, map_s: f64) -> bool {
        map_s > self.log.time_s && !self.log.kept.is_empty()
    }

    /// Adds the pose of the reading, from which the map with these states, whose time was `map_s`, had not learned yet. Without
    /// states, the map counts as not finished. Returns whether a loop shows that the map is inconsistent, so that all readings
    /// must be read again.
    pub(crate) fn add(
        &mut self,
        reading: &LaserReading,
        (map_s, states): (f64, Option<&Grid<CellState>>),
        localized: &Localized,
    ) -> bool {
        let (pose, state) = (localized.estimate.pose, localized.estimate.state);
        let is_after_pause = self.is_after_pause(map_s);
        self.log.time_s = self.log.time_s.max(reading.time_s).max(map_s);
        let number = self.log.kept.len();
        let is_known = is_known(&localized.estimate);
        self.log.kept.push(Kept { reading: reading.clone(), is_after_pause, pose, state, is_known });
        if state == PoseState::Tracking {
            self.log.last_certain = Some(number);
        }
        if self.keyframes.last() == Some(&number) {
            self.look_at_keyframe();
            let (new_m, known_m) = self.finder.ways_on_ground_m();
            let has_returned = known_m >= new_m.max(FROZEN_WAY_M);
            self.log.is_whole = has_returned
                && (known_m >= OPENING_WAY_M || states.is_some_and(|states| !has_opening(states)));
        }
        if self.finder.loops().len() != self.log.loops {
            self.look_at_loops();
            let is_wanted = self.log.is_inconsistent || state == PoseState::Lost;
            if is_wanted && self.log.refused < MAX_REJECTED {
                self.log.rest.get_or_insert(SEARCH_EVERY);
            }
        }
        self.log.rest = self.log.rest.map(|rest| rest.saturating_sub(1));
        let is_due = self.log.rest == Some(0);
        self.log.rest = self.log.rest.filter(|_| !is_due);
        is_due
    }

    /// The readings must be read again after the next one.
    pub(crate) fn postpone(&mut self) {
        self.log.rest = Some(1);
    }

    /// Whether the robot should rest: the readings will be read again, for which a real robot needs some time.
    pub(crate) fn wants_rest(&self) -> bool {
        self.log.rest.is_some()
    }

    /// The readings have been read again, and have other poses.
    pub(crate) fn accept(&mut self, estimates: &[PoseEstimate]) {
        self.log.is_inconsistent = false;
        for (kept, estimate) in self.log.kept.iter_mut().zip(estimates) {
            (kept.pose, kept.state, kept.is_known) = (estimate.pose, estimate.state, is_known(estimate));
        }
    }

    /// The readings have been read again, and the map was no better.
    pub(crate) fn refuse(&mut self) {
        self.log.is_inconsistent = false;
        self.log.refused += 1;
    }

    /// The motion between two keyframes in the map, if both have a known pose.
    fn mapped_motion(&self, from: usize, to: usize) -> Option<Isometry2<f64>> {
        let known =
            |keyframe: usize| Some(&self.log.kept[self.keyframes[keyframe]]).filter(|kept| kept.is_known);
        Some(known(from)?.pose.inv_mul(&known(to)?.pose))
    }

    /// Compares the motion in the map to the last keyframe with that by matching with the surfaces around: since the last
    /// known keyframe, and over a longer way.
    fn look_at_keyframe(&mut self) {
        let now = self.keyframes.len() - 1;
        if !self.log.kept[self.keyframes[now]].is_known {
            return;
        }
        let last = self.log.last_known.replace(now);
        self.log.is_inconsistent |= last.into_iter().chain(now.checked_sub(WINDOW)).any(|from| {
            let mapped = self.mapped_motion(from, now);
            let matched = self.finder.matched_motion(from, now);
            let is_inconsistent = |(mapped, (matched, spread))| is_inconsistent(&mapped, &matched, &spread);
            mapped.zip(matched).is_some_and(is_inconsistent)
        });
    }

    /// Compares the motions in the map with those of new loops. What the map says may explain the place as well as the loop.
    fn look_at_loops(&mut self) {
        let is_inconsistent = self.finder.loops()[self.log.loops..].iter().any(|found| {
            let mapped = self.mapped_motion(found.edge.from, found.edge.to);
            mapped.is_some_and(|mapped| {
                let near = || self.finder.agreement_near(found, &mapped);
                let is_inconsistent =
                    |motion: &Isometry2<f64>| is_inconsistent(&mapped, motion, &Matrix3::zeros());
                let is_explained = |(near, share)| share >= AMBIGUOUS && !is_inconsistent(&near);
                is_inconsistent(&found.edge.motion) && !near().is_some_and(is_explained)
            })
        });
        self.log.is_inconsistent |= is_inconsistent;
        self.log.loops = self.finder.loops().len();
    }

    /// The poses of all readings in the map, by the trajectory with all loops. Where the trajectory begins, it is where the
    /// map is.
    pub(crate) fn corrected(&self) -> Vec<Predicted> {
        let found = self.finder.corrected();
        let last = self.keyframes[SUBMAP_KEYFRAMES.min(self.keyframes.len() - 1)];
        let first = || {
            self.log.kept[..=last].iter().zip(&found).filter(|(kept, _)| kept.state == PoseState::Tracking)
        };
        let count = first().count().max(1) as f64;
        let turn_rad = |(kept, found): (&Kept, &Isometry2<f64>)| heading_rad(&found.inv_mul(&kept.pose));
        // Relative to the first: the mean of headings around π.
        let turn = first().next().map_or(0.0, turn_rad);
        let rest = first().map(|pair| interfaces::wrap_rad(turn_rad(pair) - turn)).sum::<f64>() / count;
        let rotation = interfaces::rotation(turn + rest);
        let shift =
            first().map(|(kept, found)| kept.pose.translation.vector - rotation * found.translation.vector);
        let shift = shift.sum::<Vector2<f64>>() / count;
        let to_map = Isometry2::from_parts(shift.into(), rotation);
        let covariance = CORRECTED_STD.covariance();
        found.iter().map(|found| Predicted::rigid(to_map * found, covariance)).collect()
    }
}

/// Whether a pose is known well enough to be compared with a loop.
fn is_known(estimate: &PoseEstimate) -> bool {
    estimate.state != PoseState::Lost && estimate.position_std_m() <= NEAR_STD.m
}

/// Whether a motion in the map contradicts another one with this covariance.
fn is_inconsistent(mapped: &Isometry2<f64>, motion: &Isometry2<f64>, spread: &Matrix3<f64>) -> bool {
    let off = mapped.inv_mul(motion);
    let std_m = (spread[(0, 0)] + spread[(1, 1)]).sqrt();
    off.translation.vector.norm() > INCONSISTENT.m.max(STDS * std_m)
        || heading_rad(&off).abs() > INCONSISTENT.rad.max(STDS * spread[(2, 2)].sqrt())
}

// Whether a map has openings: places where the known space goes on into space that was never seen.

/// A narrower gap is no opening, m; cells so near to a surface are part of it.
const OPENING_M: f64 = 0.5;
const OPENING_CELLS: i32 = 2;

/// Whether free space goes on into unknown space somewhere, over a width of half a meter: then there is more to explore
/// (frontiers: Yamauchi 1997).
fn has_opening(states: &Grid<CellState>) -> bool {
    let frame = states.frame();
    let width = (OPENING_M / frame.resolution_m()).ceil() as i32;
    let mut frontier: BTreeSet<usize> =
        (0..frame.len()).filter(|index| is_frontier(states, *index)).collect();
    let mut parts = std::iter::from_fn(|| frame.take_connected(&mut frontier, 1));
    parts.any(|cells| frame.longer_side(&cells) >= width)
}

/// Whether a cell was never seen, and is beside a free one and away from surfaces.
fn is_frontier(states: &Grid<CellState>, index: usize) -> bool {
    let (frame, cells) = (states.frame(), states.cells());
    let is_blocked = |cell: Cell| states.get(cell) == Some(&CellState::Blocked);
    cells[index] == CellState::Unknown
        && frame.beside(index).any(|beside| cells[beside] == CellState::Free)
        && !frame.cell(index).square(OPENING_CELLS).any(is_blocked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::GridFrame;
    use nalgebra::Point2;

    /// A map with cells of 10 cm: `#` is blocked, `.` free, everything else was never seen.
    fn map(rows: &[&str]) -> Grid<CellState> {
        let frame = GridFrame::new(Point2::origin(), 0.1, rows[0].len(), rows.len()).unwrap();
        let state = |character: char| match character {
            '#' => CellState::Blocked,
            '.' => CellState::Free,
            _ => CellState::Unknown,
        };
        Grid::from_cells(frame, rows.iter().flat_map(|row| row.chars().map(state)).collect()).unwrap()
    }

    #[test]
    fn a_room_with_a_door_that_was_never_passed_has_an_opening() {
        let closed =
            ["##############", "#............#", "#............#", "#............#", "##############"];
        assert!(!has_opening(&map(&closed)));
        // The same room, of which a wall is missing over 4 and over 10 cells.
        let narrow =
            ["#####    #####", "#............#", "#............#", "#............#", "##############"];
        assert!(!has_opening(&map(&narrow)));
        let wide = ["##          ##", "#............#", "#............#", "#............#", "##############"];
        assert!(has_opening(&map(&wide)));
    }

    #[test]
    fn cells_of_a_wall_that_were_never_hit_are_no_opening() {
        let rows = ["################", "                ", "................", "################"];
        assert!(!has_opening(&map(&rows)));
    }
}
