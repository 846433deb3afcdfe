//! What a survey keeps of a log.

use crate::quality::Quality;
use crate::repeated::{repeats, silence_note, sketch};
use crate::route::{Route, distance_m};
use interfaces::GridFrame;
use localizer::{PoseState, TrajectoryPose};
use logs::{Log, LogError, TopicChoice};
use robot::state::Session;
use serde::{Deserialize, Serialize};

/// A log, and its place in time among the logs of one place.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct LogEntry {
    /// Its name for people.
    pub name: String,
    /// The [hash](Log::content_hash) of its content; 0 where it is not needed.
    pub content: u128,
    /// Hashes of some of its scans, by which a part of it is recognized.
    pub(crate) scans: Vec<u64>,
    /// What was used of it.
    pub choice: TopicChoice,
    /// The time of its first reading, s after that of the first log.
    pub offset_s: f64,
    /// This time in seconds since the epoch; `None` if the log does not say it.
    pub begin_s: Option<f64>,
    /// The time from its first reading to its last one, s.
    pub duration_s: f64,
    /// Whether its times are usable.
    pub has_times: bool,
    /// Whether its laser stands.
    pub stands: bool,
    /// The laser of its first reading, in words.
    pub laser: String,
    /// What was repaired, left out or assumed, each a sentence.
    pub notes: Vec<String>,
}

impl LogEntry {
    /// The entry of a log that was opened with this choice. Its place in time and its hash are not known yet.
    ///
    /// # Errors
    ///
    /// When the first reading cannot be read.
    pub fn of(name: String, log: &Log, choice: &TopicChoice) -> Result<Self, LogError> {
        let summary = log.summary();
        let first = log.readings()?.next().transpose()?;
        let laser = first.map_or_else(String::new, |first| {
            let (beams, step_rad) = (first.scan.ranges_m.len(), first.scan.angle_increment_rad.abs());
            let view_deg = (step_rad * beams.saturating_sub(1) as f64).to_degrees();
            format!("{beams} beams over {view_deg:.0}°")
        });
        Ok(Self {
            name,
            choice: choice.clone(),
            begin_s: summary.begin_s,
            duration_s: summary.duration_s,
            has_times: summary.has_times,
            stands: summary.stands,
            laser,
            notes: summary.notes.clone(),
            ..Self::default()
        })
    }

    /// Reads the log once more, so that it is recognized in other logs, and they in it.
    ///
    /// # Errors
    ///
    /// When the log can no longer be read.
    pub fn recognize(&mut self, log: &Log) -> Result<(), LogError> {
        self.content = log.content_hash()?;
        if !self.stands {
            self.scans = sketch(log)?; // a laser that stands can see the same every day
        }
        Ok(())
    }

    /// Whether this log and another one have scans in common.
    pub fn repeats(&self, other: &Self) -> bool {
        repeats(&self.scans, &other.scans)
    }

    /// Whether it says when it was recorded.
    pub(crate) fn is_dated(&self) -> bool {
        self.begin_s.is_some() && self.has_times
    }

    /// The time of its last reading, s after the first reading of the first log.
    pub fn end_s(&self) -> f64 {
        self.offset_s + self.duration_s
    }
}

/// A log that is part of a survey.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct SurveyedLog {
    /// The log.
    pub entry: LogEntry,
    /// The number of readings.
    pub readings: usize,
    /// The number of readings from which the survey has learned.
    pub used: usize,
    /// The number of places that the robot recognized.
    pub loops: usize,
    /// The part that was used.
    pub travelled: Travelled,
    /// How far the trajectory agrees with its own scans.
    pub quality: Quality,
    /// The noise that the mapper must expect, m.
    pub(crate) noise_m: Option<f64>,
    /// The cells that cover what was seen.
    pub(crate) frame: GridFrame,
    /// The poses of all readings; forgotten when they are no longer needed.
    pub(crate) poses: Vec<TrajectoryPose>,
}

/// A part of a route.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Travelled {
    /// The time from its begin to its end, s.
    pub duration_s: f64,
    /// Its length, m.
    pub length_m: f64,
    /// The number of readings without a certain pose.
    pub uncertain: usize,
}

impl SurveyedLog {
    /// `hiding_s`: for how long a body can hide what is in view, s.
    pub(crate) fn new(mut entry: LogEntry, route: Route, frame: GridFrame, hiding_s: f64) -> Self {
        entry
            .notes
            .extend(route.scale_note().into_iter().chain(silence_note(&route.trajectory.poses, hiding_s)));
        Self {
            entry,
            readings: route.trajectory.poses.len(),
            used: 0,
            loops: route.trajectory.loops,
            travelled: Travelled::default(),
            noise_m: noise_m(&route),
            quality: route.quality,
            frame,
            poses: route.trajectory.poses,
        }
    }

    /// A session of a robot, in the map of this frame: a log of which nothing is left to read.
    pub(crate) fn of_session(session: Session, frame: GridFrame) -> Self {
        let Session { name, offset_s, begin_s, duration_s, readings: [used, readings], laser, notes } =
            session;
        let has_times = begin_s.is_some();
        let entry =
            LogEntry { name, offset_s, begin_s, duration_s, has_times, laser, notes, ..LogEntry::default() };
        let travelled = Travelled { duration_s, ..Travelled::default() };
        let (quality, poses) = (Quality::default(), Vec::new());
        Self { entry, readings, used, loops: 0, travelled, quality, noise_m: None, frame, poses }
    }

    /// The log as a session.
    pub(crate) fn session(&self) -> Session {
        let LogEntry { name, offset_s, begin_s, duration_s, laser, notes, .. } = self.entry.clone();
        Session { name, offset_s, begin_s, duration_s, readings: [self.used, self.readings], laser, notes }
    }

    /// Whether the survey has learned from all readings.
    pub fn is_finished(&self) -> bool {
        self.used >= self.readings
    }

    /// The poses of all readings, as the first pass has found them; none if they were forgotten.
    pub fn route(&self) -> &[TrajectoryPose] {
        &self.poses
    }

    /// The poses of the readings that were used, in the frame of the map, with times since the first log has begun; none
    /// if they were forgotten.
    pub fn poses(&self) -> impl Iterator<Item = TrajectoryPose> {
        let poses = self.poses.iter().take(self.used);
        poses.map(|at| TrajectoryPose { time_s: at.time_s + self.entry.offset_s, ..*at })
    }

    /// Counts one more reading as used.
    pub(crate) fn pass(&mut self) {
        self.used += 1;
        let Some(at) = self.poses.get(self.used - 1) else { return };
        let before = self.used.checked_sub(2).and_then(|before| self.poses.get(before));
        self.travelled.duration_s = at.time_s;
        self.travelled.length_m += before.map_or(0.0, |before| distance_m(before, at));
        self.travelled.uncertain += usize::from(at.state != PoseState::Tracking);
    }
}

/// The least noise, m: with poses that were found, and of a laser that stands.
const MIN_M: f64 = 0.02;
const MIN_STANDING_M: f64 = 0.01;
/// The largest noise, m.
const MAX_M: f64 = 0.1;

/// The noise that the mapper must expect along a route, m, by what the route says about the errors of ranges and poses
/// together: the distance below which 97 % of its points lie from the surfaces of other passes, from 0.02 to 0.1 m. At edges,
/// plants and glass, real scans have long tails, each of which would count as a change. Of a laser that stands, it is the noise
/// of its ranges, from 0.01 to 0.1 m. `None` if no place was seen twice.
fn noise_m(route: &Route) -> Option<f64> {
    let found = route.trajectory.residual_m.map(|residual_m| residual_m.clamp(MIN_M, MAX_M));
    found.or_else(|| route.range_std_m.map(|std_m| std_m.clamp(MIN_STANDING_M, MAX_M)))
}
