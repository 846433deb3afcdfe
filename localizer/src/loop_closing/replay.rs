//! All readings so far are read again, at once or beside the robot.

use super::{Correction, Switch};
use crate::constants::NEAR_STD;
use crate::estimate::{Localized, PoseEstimate, PoseState};
use crate::first_map::{FirstMap, Kept};
use crate::localizer::Localizer;
use crate::motion::Predicted;
use interfaces::LaserReading;
use mapper::Mapper;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender};
use std::thread::JoinHandle;

/// A replay is rejected if this share fewer poses would be certain; it is accepted if this share more are, or if some move.
const CHANGED_CERTAIN: f64 = 0.02;

/// A reading that came while others were read again, with the time of the map before it.
pub(super) type Meanwhile = (LaserReading, f64, Localized);

/// A thread that reads the readings again.
#[derive(Debug)]
pub(super) struct Background {
    pub(super) thread: JoinHandle<Replayed>,
    pub(super) meanwhile: Sender<Meanwhile>,
    /// The number of readings when the thread began, and now.
    pub(super) begun: usize,
    pub(super) readings: usize,
    /// The number of readings that the thread has read.
    pub(super) read: Arc<AtomicUsize>,
}

impl Background {
    /// Whether the thread has read all readings so far.
    pub(super) fn is_up_to_date(&self) -> bool {
        self.read.load(Ordering::Relaxed) == self.readings || self.thread.is_finished()
    }

    /// Passes a reading on. Returns whether the robot changes to the new map with it.
    pub(super) fn add(&mut self, meanwhile: Meanwhile, switch: Switch) -> bool {
        let is_up_to_date = self.is_up_to_date();
        self.readings += 1;
        // A thread that has failed is noticed by its result.
        self.meanwhile.send(meanwhile).ok();
        match switch {
            Switch::After(readings) => self.readings - self.begun >= readings,
            Switch::AtOnce | Switch::WhenReady => is_up_to_date,
        }
    }
}

/// The readings, and what reading them again has changed, if anything.
pub(super) type Replayed = (FirstMap, Option<(Replay, Correction)>);

/// A localizer and a map that learn all readings again.
#[derive(Debug)]
pub(super) struct Replay {
    pub(super) localizer: Localizer,
    pub(super) map: Mapper,
    /// The last reading, from which the map has not learned yet.
    pub(super) last: Option<Localized>,
}

impl Replay {
    /// Reads the next reading, near a pose if one is known.
    fn read(&mut self, reading: &LaserReading, after_pause: bool, near: Option<Predicted>) -> PoseEstimate {
        if let Some(Localized { reading, estimate }) = self.last.take() {
            learn(&mut self.map, &reading, &estimate);
        }
        if after_pause {
            self.map.pause(reading.time_s);
        }
        let localized = self.localizer.localize_near(reading, &self.map, near);
        self.last.insert(localized).estimate.clone()
    }

    /// Reads all readings, near their corrected poses, and those that come meanwhile.
    pub(super) fn all(self, first: FirstMap, coming: Receiver<Meanwhile>, read: &AtomicUsize) -> Replayed {
        let (mut first, mut again) = self.log(first);
        read.store(first.log.kept.len(), Ordering::Relaxed);
        for (reading, map_s, localized) in coming {
            let (near, is_after_pause) = (first.pose_prior(&reading), first.is_after_pause(map_s));
            if let Some((again, correction)) = &mut again {
                again.read(&reading, is_after_pause, near);
                correction.readings += 1;
            }
            let (states, localized) = match &again {
                Some((Self { map, last: Some(last), .. }, _)) => (Some(map.states()), last),
                _ => (None, &localized),
            };
            if first.add(&reading, (map_s, states), localized) {
                first.postpone();
            }
            read.store(first.log.kept.len(), Ordering::Relaxed);
        }
        (first, again)
    }

    /// Reads the readings of a log, near their corrected poses.
    fn log(mut self, mut first: FirstMap) -> Replayed {
        let near = first.corrected();
        let read =
            |(kept, near): (&Kept, Predicted)| self.read(&kept.reading, kept.is_after_pause, Some(near));
        let estimates: Vec<PoseEstimate> = first.log.kept.iter().zip(near).map(read).collect();
        let is_certain = |state: PoseState| usize::from(state == PoseState::Tracking);
        let (mut before, mut after, mut largest_m) = (0, 0, 0.0_f64);
        for (kept, estimate) in first.log.kept.iter().zip(&estimates) {
            (before, after) = (before + is_certain(kept.state), after + is_certain(estimate.state));
            if kept.state == PoseState::Tracking {
                let moved = estimate.pose.translation.vector - kept.pose.translation.vector;
                largest_m = largest_m.max(moved.norm());
            }
        }
        let certain = |change: f64| before as f64 * (1.0 + change);
        // A robot that was lost had few certain poses, which did not move.
        let is_better = largest_m >= NEAR_STD.m || after as f64 > certain(CHANGED_CERTAIN);
        if (after as f64) < certain(-CHANGED_CERTAIN) || !is_better {
            first.refuse();
            return (first, None);
        }
        let correction = Correction { places: first.log.loops, readings: estimates.len(), largest_m };
        first.accept(&estimates);
        (first, Some((self, correction)))
    }
}

/// What the loop of the robot does with a reading.
pub(super) fn learn(map: &mut Mapper, reading: &LaserReading, estimate: &PoseEstimate) {
    // A reading that the mapper refuses was refused before.
    if estimate.state != PoseState::Tracking || map.update(reading).is_err() {
        map.skip(reading);
    }
}
