//! A robot that maps a place for the first time: its loops are closed while it drives.
//!
//! ```text
//! reading ─▶ trajectory finder ─guide─▶ localizer ─▶ pose ─▶ mapper
//!                  └─▶ a loop that contradicts the map: all readings again, near the corrected trajectory
//! ```
//!
//! - Where the scans fit the map but do not fix the pose, as in a corridor, the [`TrajectoryFinder`](crate::TrajectoryFinder)
//!   guides the localizer: its submaps hold what the map does not hold yet. While it does, nothing is searched for in the whole
//!   map: in a map that is not finished, something always looks like the place.
//! - After a long way around, the robot comes back beside its own map, and the map is inconsistent where the two meet. When the
//!   finder recognises the place, the robot reads its own log again: a new localizer and a new mapper get all readings so far,
//!   guided by the corrected trajectory. So there is one kind of map, and what it knows of changes and rates follows from the
//!   better poses as well.
//!
//! The map can move until it *stands*: nothing is left to explore, and the robot has gone as far on known ground as on new
//! ground before. From then on, its frame stays for ever.

use crate::estimate::{Localized, PoseEstimate, PoseState};
use crate::first_map::{FirstMap, Kept, Log};
use crate::localizer::{Guide, Localizer};
use crate::settings::LocalizerSettings;
use interfaces::{GridFrame, LaserReading, SettingsError, ValueError, read_value, write_value};
use mapper::Mapper;
use nalgebra::Isometry2;
use std::fmt;

/// The readings are not read again if this share of those with a certain pose would no longer be certain: then the loop
/// is not believed.
const FEWER_CERTAIN: f64 = 0.02;
/// The same if no certain pose would move by more than this, m: a map with smaller errors is whole.
const LEAST_M: f64 = 0.05;

/// A localizer that starts from nothing, and that learns the map again when a loop is closed. The same readings give the same
/// bits.
#[derive(Debug)]
pub struct LoopClosingLocalizer {
    settings: LocalizerSettings,
    frame: GridFrame,
    start: Isometry2<f64>,
    localizer: Localizer,
    /// `None`: the first map stands.
    first: Option<FirstMap>,
}

/// What a closed loop has changed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Correction {
    /// The number of places that were recognised so far.
    pub places: usize,
    /// The number of readings that were read again.
    pub readings: usize,
    /// The largest distance by which a certain pose of the past has moved, m.
    pub largest_m: f64,
}

impl fmt::Display for Correction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { places, readings, largest_m } = self;
        write!(
            f,
            "a loop was closed: {places} places recognised, {readings} readings read again, poses of the past moved by up \
             to {largest_m:.2} m"
        )
    }
}

/// The result of one reading.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopClosed {
    /// The reading with its pose.
    pub localized: Localized,
    /// If a loop was closed that the map contradicted: the map that `localize` got is a new one, in which earlier readings
    /// have better poses.
    pub correction: Option<Correction>,
}

impl LoopClosingLocalizer {
    /// A localizer without a map, as [`Localizer::from_nothing`].
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn from_nothing(
        settings: &LocalizerSettings,
        frame: &GridFrame,
        pose: Isometry2<f64>,
    ) -> Result<Self, SettingsError> {
        Ok(Self {
            settings: settings.clone(),
            frame: *frame,
            start: pose,
            localizer: Localizer::from_nothing(settings, frame, pose)?,
            first: Some(FirstMap::new(settings)?),
        })
    }

    /// Whether the first map stands: no loop will move it any more.
    pub fn stands(&self) -> bool {
        self.first.is_none()
    }

    /// Whether the robot should rest: at the start, see [`Localizer::wants_rest`], and for half a second before the readings
    /// are read again, which takes a real robot some time.
    pub fn wants_rest(&self) -> bool {
        self.localizer.wants_rest() || self.first.as_ref().is_some_and(FirstMap::wants_rest)
    }

    /// Estimates the pose of a reading, as [`Localizer::localize`]. `map` has learned from the readings so far whose pose was
    /// certain, has skipped the others, and has learned from nothing else.
    pub fn localize(&mut self, reading: &LaserReading, map: &mut Mapper) -> LoopClosed {
        let Some(first) = &mut self.first else {
            return LoopClosed { localized: self.localizer.localize(reading, map), correction: None };
        };
        let localized = match first.guide(reading) {
            Some(guide) => self.localizer.localize_near(reading, map, guide),
            None => self.localizer.localize(reading, map),
        };
        if self.localizer.much_has_moved() {
            // Keyframes from before and after do not fit together: most of what they show has moved.
            self.first = None;
            return LoopClosed { localized, correction: None };
        }
        let closed = match first.add(reading, map, &localized) {
            Some(poses) => self.read_again(&poses, map),
            None => None,
        };
        if self.first.as_ref().is_some_and(FirstMap::stands) {
            self.first = None;
        }
        closed.unwrap_or(LoopClosed { localized, correction: None })
    }

    /// Reads all readings so far again, near other poses. `None` if that is no use; then nothing has changed.
    fn read_again(&mut self, near: &[Guide], map: &mut Mapper) -> Option<LoopClosed> {
        let first = self.first.as_mut()?;
        let mut localizer = Localizer::from_nothing(&self.settings, &self.frame, self.start).ok()?;
        let mut again = map.emptied();
        let mut estimates = Vec::with_capacity(near.len());
        let mut last = None;
        for (Kept { reading, is_after_pause, .. }, near) in first.kept().iter().zip(near) {
            if let Some(Localized { reading, estimate }) = last.take() {
                learn(&mut again, &reading, &estimate);
            }
            if *is_after_pause {
                again.pause(reading.time_s);
            }
            let localized = localizer.localize_near(reading, &again, *near);
            estimates.push(localized.estimate.clone());
            last = Some(localized);
        }
        let is_certain = |state: PoseState| usize::from(state == PoseState::Tracking);
        let (mut before, mut after, mut largest_m) = (0, 0, 0.0_f64);
        for (kept, estimate) in first.kept().iter().zip(&estimates) {
            (before, after) = (before + is_certain(kept.state), after + is_certain(estimate.state));
            if kept.state == PoseState::Tracking {
                let moved = estimate.pose.translation.vector - kept.pose.translation.vector;
                largest_m = largest_m.max(moved.norm());
            }
        }
        if (after as f64) < before as f64 * (1.0 - FEWER_CERTAIN) || largest_m < LEAST_M {
            first.refuse();
            return None;
        }
        let correction = Correction { places: first.loops(), readings: estimates.len(), largest_m };
        first.accept(&estimates);
        (self.localizer, *map) = (localizer, again);
        Some(LoopClosed { localized: last?, correction: Some(correction) })
    }
}

impl LoopClosingLocalizer {
    /// Everything that readings have changed, as bytes; settings are not in it. While the first map is young, that is all
    /// readings.
    pub fn snapshot(&mut self) -> Vec<u8> {
        let (mut bytes, log) = (Vec::new(), self.first.as_ref().map(FirstMap::log));
        let localizer = self.localizer.snapshot();
        // Both always can be written. An empty snapshot would be refused.
        match write_value(&localizer, &mut bytes).and_then(|()| write_value(&log, &mut bytes)) {
            Ok(()) => bytes,
            Err(ValueError) => Vec::new(),
        }
    }

    /// Goes on from the snapshot of a localizer with the same settings and the same frame, bit for bit. The trajectory of a
    /// young map is found again, which takes as long as before.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot. The localizer must not be used then.
    pub fn restore(&mut self, mut snapshot: &[u8]) -> Result<(), ValueError> {
        let localizer: Vec<u8> = read_value(&mut snapshot)?;
        let log: Option<Log> = read_value(&mut snapshot)?;
        self.localizer.restore(&localizer)?;
        self.first = match log {
            Some(log) => Some(FirstMap::with_log(&self.settings, log).ok_or(ValueError)?),
            None => None,
        };
        if snapshot.is_empty() { Ok(()) } else { Err(ValueError) }
    }

    /// Begins another session, see [`Localizer::begin_session`]. The map of the first session stands.
    pub fn begin_session(&mut self) {
        self.localizer.begin_session();
        if self.first.as_ref().is_some_and(|first| !first.kept().is_empty()) {
            self.first = None;
        }
    }
}

/// What the loop of the robot does with a reading.
fn learn(map: &mut Mapper, reading: &LaserReading, estimate: &PoseEstimate) {
    // A reading that the mapper refuses was refused before.
    if estimate.state != PoseState::Tracking || map.update(reading).is_err() {
        map.skip(reading);
    }
}
