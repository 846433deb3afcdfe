//! A robot that maps a place for the first time: its loops are closed while it drives.
//!
//! ```text
//! reading ─▶ trajectory finder ─pose prior─▶ localizer ─▶ pose ─▶ mapper
//!                  └─▶ a loop that contradicts the map: all readings again, near the corrected trajectory
//! ```
//!
//! - Where the scans fit the map but do not fix the pose, as in a corridor, the [`TrajectoryFinder`](crate::TrajectoryFinder)
//!   gives the localizer a pose prior: its submaps hold what the map does not hold yet. While it does, nothing is searched for in the whole
//!   map: in a map that is not finished, something always looks like the place.
//! - After a long way around, the robot comes back beside its own map, and the map is inconsistent where the two meet. When the
//!   finder recognizes the place, the robot reads its own log again: a new localizer and a new mapper get all readings so far,
//!   near the corrected trajectory. So there is one kind of map, and what it knows of changes and rates follows from the
//!   better poses as well.
//!
//! A live robot goes on in the old map while a thread reads its log ([`Switch`]), and then the readings that came meanwhile.
//! When the thread has caught up, the robot changes to the new map.
//!
//! The map can move until it is *frozen*: nothing is left to explore, and the robot has gone as far on known ground as on new
//! ground before. From then on, its frame stays for ever.

mod replay;

use crate::estimate::Localized;
use crate::first_map::{FirstMap, Log};
use crate::localizer::Localizer;
use crate::settings::LocalizerSettings;
use interfaces::{CellState, Grid, GridFrame, LaserReading, SettingsError, ValueError, from_bytes, to_bytes};
use mapper::Mapper;
use nalgebra::{Isometry2, Matrix3};
use replay::{Background, Replay, Replayed, learn};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::sync::mpsc;

/// A localizer that starts from nothing, and that learns the map again when a loop is closed. The same readings give the same
/// bits.
#[derive(Debug)]
pub struct LoopClosingLocalizer {
    settings: LocalizerSettings,
    frame: GridFrame,
    start: Isometry2<f64>,
    localizer: Localizer,
    /// `None`: the first map is frozen, or a thread has it.
    first: Option<FirstMap>,
    switch: Switch,
    background: Option<Background>,
}

/// When the robot changes to the map that it has learned again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Switch {
    /// At the reading that closes the loop, which takes as long as all readings so far.
    #[default]
    AtOnce,
    /// This number of readings later, meanwhile in the old map: the same readings give the same bits.
    After(usize),
    /// At the first reading after the new map is complete.
    WhenReady,
}

/// What a closed loop has changed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Correction {
    /// The number of places that were recognized so far.
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
            "a loop was closed: {places} places recognized, {readings} readings read again, poses of the past moved by up \
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
            switch: Switch::AtOnce,
            background: None,
        })
    }

    /// The same localizer, which changes to a new map as given.
    #[must_use]
    pub fn switching(self, switch: Switch) -> Self {
        Self { switch, ..self }
    }

    /// Whether the first map is frozen: no loop will move it any more.
    pub fn is_frozen(&self) -> bool {
        self.first.is_none() && self.is_settled()
    }

    /// Whether no map is being learned again in another thread.
    pub fn is_settled(&self) -> bool {
        self.background.is_none()
    }

    /// Whether [`settle`](Self::settle) would not wait long.
    pub fn is_up_to_date(&self) -> bool {
        self.background.as_ref().is_none_or(Background::is_up_to_date)
    }

    /// Waits for the map that is being learned again, and changes to it: before a snapshot, or another session.
    pub fn settle(&mut self, map: &mut Mapper) {
        if let Some(LoopClosed { localized, .. }) = self.change_map(map) {
            learn(map, &localized.reading, &localized.estimate);
        }
    }

    /// Whether the robot should rest: at the start, see [`Localizer::wants_rest`], and for half a second before the readings
    /// are read again, which takes a real robot some time.
    pub fn wants_rest(&self) -> bool {
        self.localizer.wants_rest() || self.first.as_ref().is_some_and(FirstMap::wants_rest)
    }

    /// Estimates the pose of a reading, as [`Localizer::localize`]. `map` has learned from the readings so far whose pose was
    /// certain, has skipped the others, and has learned from nothing else.
    pub fn localize(&mut self, reading: &LaserReading, map: &mut Mapper) -> LoopClosed {
        if self.background.is_some() {
            return self.localize_meanwhile(reading, map);
        }
        let Some(first) = &mut self.first else {
            return LoopClosed { localized: self.localizer.localize(reading, map), correction: None };
        };
        let prior = first.pose_prior(reading);
        let localized = self.localizer.localize_near(reading, map, prior);
        if self.localizer.much_has_moved {
            // Keyframes from before and after do not fit together: most of what they show has moved.
            self.first = None;
            return LoopClosed { localized, correction: None };
        }
        let is_due = first.add(reading, (map.time(), Some(map.states())), &localized);
        let closed = if is_due { self.read_again(map) } else { None };
        if self.first.as_ref().is_some_and(FirstMap::is_frozen) {
            self.first = None;
        }
        closed.unwrap_or(LoopClosed { localized, correction: None })
    }

    /// Reads all readings so far again, or lets a thread do it. `None` if the map stays as it is for now.
    fn read_again(&mut self, map: &mut Mapper) -> Option<LoopClosed> {
        let (settings, frame, start) = (self.settings.clone(), self.frame, self.start);
        let (emptied, first) = (map.emptied(), self.first.take()?);
        let (meanwhile, coming) = mpsc::channel();
        let (begun, read) = (first.log.kept.len(), Arc::new(AtomicUsize::new(0)));
        let count = read.clone();
        // To make a large map takes time as well.
        let read_all = move || match Localizer::from_nothing(&settings, &frame, start) {
            Ok(localizer) => Replay { localizer, map: emptied(), last: None }.all(first, coming, &count),
            Err(_) => (first, None), // the settings were valid before
        };
        if self.switch == Switch::AtOnce {
            drop(meanwhile);
            return self.take_over(read_all(), map);
        }
        let thread = std::thread::Builder::new().spawn(read_all);
        self.background =
            thread.ok().map(|thread| Background { thread, meanwhile, begun, readings: begun, read });
        None
    }

    /// Estimates the pose of a reading in the old map, until the robot changes to the new one.
    fn localize_meanwhile(&mut self, reading: &LaserReading, map: &mut Mapper) -> LoopClosed {
        let map_s = map.time();
        let localized = self.localizer.localize(reading, map);
        if self.localizer.much_has_moved {
            self.background = None;
        } else if let Some(background) = &mut self.background
            && background.add((reading.clone(), map_s, localized.clone()), self.switch)
            && let Some(closed) = self.change_map(map)
        {
            return closed;
        }
        LoopClosed { localized, correction: None }
    }

    /// Waits for the thread, and takes over what it has learned.
    fn change_map(&mut self, map: &mut Mapper) -> Option<LoopClosed> {
        let Background { thread, meanwhile, .. } = self.background.take()?;
        drop(meanwhile); // the thread ends
        self.take_over(thread.join().ok()?, map)
    }

    /// Changes to what was learned again. `None` if that was no use.
    fn take_over(&mut self, (first, again): Replayed, map: &mut Mapper) -> Option<LoopClosed> {
        self.first = Some(first).filter(|first| !first.is_frozen());
        let (Replay { localizer, map: learned, last }, correction) = again?;
        (self.localizer, *map) = (localizer, learned);
        Some(LoopClosed { localized: last?, correction: Some(correction) })
    }

    /// Everything that readings have changed, as bytes; settings are not in it. While the first map is young, that is all
    /// readings. A map that is being learned again must be [settled](Self::settle) before.
    pub fn snapshot(&mut self) -> Vec<u8> {
        to_bytes(&(self.localizer.snapshot(), self.first.as_ref().map(|first| &first.log)))
    }

    /// Goes on from the snapshot of a localizer with the same settings and the same frame, bit for bit. The trajectory of a
    /// young map is found again, which takes as long as before.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot. The localizer must not be used then.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        let (localizer, log): (Vec<u8>, Option<Log>) = from_bytes(snapshot)?;
        self.background = None;
        self.localizer.restore(&localizer)?;
        let read = |log| FirstMap::with_log(&self.settings, log).ok_or(ValueError);
        self.first = log.map(read).transpose()?;
        Ok(())
    }

    /// See [`Localizer::surfaces`].
    pub fn surfaces(&mut self) -> Vec<u8> {
        self.localizer.surfaces()
    }

    /// Begins in a known place, see [`Localizer::begin_in`]; its map is frozen.
    ///
    /// # Errors
    ///
    /// When the bytes are no surfaces.
    pub fn begin_in(&mut self, surfaces: &[u8], map: &Grid<CellState>) -> Result<(), ValueError> {
        if self.localizer.begin_in(surfaces, map)? {
            (self.background, self.first) = (None, None);
        }
        Ok(())
    }

    /// Puts the robot elsewhere, see [`Localizer::seat`]. The map is frozen: its readings so far are of another way.
    pub fn seat(&mut self, pose: Isometry2<f64>, covariance: &Matrix3<f64>) {
        self.localizer.seat(pose, covariance);
        (self.background, self.first) = (None, None);
    }

    /// Begins another session, see [`Localizer::begin_session`]. The map of the first session is frozen.
    pub fn begin_session(&mut self) {
        self.localizer.begin_session();
        self.background = None;
        if self.first.as_ref().is_some_and(|first| !first.log.kept.is_empty()) {
            self.first = None;
        }
    }
}
