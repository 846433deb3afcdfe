//! What was learned from the logs of one place, one log after the other; more logs can follow, days later.

mod saved;
#[cfg(test)]
mod tests;

pub(crate) use saved::SavedSurvey;
pub use saved::{saved_logs, saved_settings};

use crate::change_log::ChangeLog;
use crate::extent::{check_seen, too_much, union};
use crate::passes::{FoundPoses, Replay, RoutePass, Stage, judged};
use crate::places::{Place, PlaceBook, PlaceName, Since, StillName, places, since, still_names};
use crate::quality::Verdict;
use crate::repeated::max_step_s;
use crate::settings::{SurveyError, SurveySettings};
use crate::surveyed_log::{LogEntry, SurveyedLog};
use interfaces::{GridFrame, LaserReading};
use localizer::KnownPlace;
use logs::Log;
use mapper::{Mapper, NoReturnEvidence, ScanFilter};
use robot::{NoPilot, Robot, Turn};
use std::ops::ControlFlow;

/// The map of a place and its changes, from one or more logs in the order of their times.
///
/// A log is added by its [first pass](Self::first_pass), and learned by its second one: a [replay](Self::replay) and its
/// [turns](Self::turn). Everything that a
/// log needs comes from the logs before it: the place in which it finds its own, the frame of the map, which grows, and the
/// noise. So it makes no difference, to the last bit, whether all logs are added at once or a survey is saved, restored,
/// and goes on with the next log.
pub struct Survey {
    settings: SurveySettings,
    /// Whether the noise of the mapper follows from the routes.
    learns_noise: bool,
    place: Option<KnownPlace>,
    /// The robot that reads the logs; `None` before the first reading was learned.
    robot: Option<Robot<LaserReading, NoPilot>>,
    /// When the cells changed last.
    pub changes: ChangeLog,
    book: PlaceBook,
    logs: Vec<SurveyedLog>,
    /// The area that was seen in the first passes of this run, m².
    seen_m2: f64,
}

/// Logs are those of one session, one visit of the robot, if they begin earlier than this after the end of the log before, s.
const SESSION_GAP_S: f64 = 6.0 * 3600.0;

impl Survey {
    /// A survey without a log. `learns_noise`: the noise in the settings is replaced by what the routes say about it.
    pub fn new(settings: SurveySettings, learns_noise: bool) -> Self {
        let (changes, book) = (ChangeLog::default(), PlaceBook::default());
        let (place, robot, logs) = (None, None, Vec::new());
        Self { settings, learns_noise, place, robot, changes, book, logs, seen_m2: 0.0 }
    }

    /// The logs, in the order of their times.
    pub fn logs(&self) -> &[SurveyedLog] {
        &self.logs
    }

    /// What the map is good for: as the worst of its logs.
    pub fn verdict(&self) -> Verdict {
        self.logs.iter().map(|log| log.quality.verdict()).max().unwrap_or(Verdict::Good)
    }

    /// The map; `None` before the first reading was learned.
    pub fn mapper(&self) -> Option<&Mapper> {
        self.robot.as_ref().map(|robot| &robot.mapper)
    }

    /// What was learned about the beams without a return of each scanner of the present log.
    pub fn no_returns(&self) -> Vec<NoReturnEvidence> {
        let filter = self.robot.as_ref().and_then(Robot::filter);
        filter.map(|filter| filter.no_returns().evidence().collect()).unwrap_or_default()
    }

    /// The places where something changes, those with the most change first; none before the first reading was learned.
    pub fn places(&self) -> Vec<Place> {
        self.mapper().map(|mapper| places(mapper, &self.changes, &self.book)).unwrap_or_default()
    }

    /// Gives names to places, in this session and all later ones, instead of those given before.
    pub fn name_places(&mut self, names: Vec<PlaceName>) {
        self.book.names = names;
    }

    /// The names that none of these places has: nothing changes there, as far as it was seen.
    pub fn still_names(&self, places: &[Place]) -> Vec<StillName> {
        self.mapper().map(|mapper| still_names(mapper, &self.book.names, places)).unwrap_or_default()
    }

    /// What is different at these places since the last session; `None` in the first one. A session is one visit of the
    /// robot: logs that follow each other within six hours; a log without a date is one of its own.
    pub fn since(&self, places: &[Place]) -> Option<Since> {
        since(&self.book, self.mapper()?, &self.changes, places)
    }

    /// The settings, with the noise for the logs up to this one.
    pub fn settings_of(&self, log: usize) -> SurveySettings {
        let mut settings = self.settings.clone();
        if self.learns_noise {
            let noises_m = self.logs.iter().take(log + 1).filter_map(|log| log.noise_m);
            if let Some(noise_m) = noises_m.reduce(f64::max) {
                settings.set_noise(noise_m);
            }
        }
        settings
    }

    /// The cells that cover what was seen in the logs up to this one.
    ///
    /// # Errors
    ///
    /// When the place is too large for a map, and when there is no log.
    pub fn frame_of(&self, log: usize) -> Result<GridFrame, SurveyError> {
        union(self.logs.iter().take(log + 1).map(|log| &log.frame))
    }

    /// Forgets the logs from this one on. They must not have been learned. Without any log, the place is forgotten as well.
    pub fn forget_from(&mut self, log: usize) {
        self.logs.truncate(log);
        if self.logs.is_empty() {
            self.place = None;
        }
    }

    /// Keeps the numbers of the places.
    fn keep_numbers(&mut self) {
        let places = self.places();
        if let Some(robot) = &self.robot {
            self.book.keep(&robot.mapper, &places);
        }
    }

    /// Whether a session begins with a log: not with the first one.
    fn begins_session(&self, log: usize) -> bool {
        let [.., before, log] = &self.logs[..=log] else { return false };
        let begins_s = log.entry.begin_s.zip(before.entry.begin_s);
        let gap_s = begins_s.map(|(begin_s, before_s)| begin_s - before_s - before.entry.duration_s);
        gap_s.is_none_or(|gap_s| gap_s >= SESSION_GAP_S)
    }

    /// Forgets the poses of the logs that were learned: no [`replay`](Self::replay) needs them any more.
    pub fn forget_poses(&mut self) {
        self.logs.iter_mut().filter(|log| log.is_finished()).for_each(|log| log.poses = Vec::new());
    }

    /// The first pass over the next log: its route, in the frame of the first one. `is_followed`: other logs can follow, and
    /// must find their place. `watch` is called with the stage and the number of its readings, when it begins and after each
    /// reading, and interrupts the pass with a `Break`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range, when the log cannot be read, when its scans turn against its poses, when most of them
    /// have no certain pose, when the place is too large for a map, when the log finds no place in the map of the first one,
    /// and when the pass is interrupted.
    pub fn first_pass(
        &mut self,
        log: &Log,
        entry: LogEntry,
        is_followed: bool,
        watch: impl FnMut((Stage, usize)) -> ControlFlow<()>,
    ) -> Result<(), SurveyError> {
        let all_stand = entry.stands && self.logs.iter().all(|log| log.entry.stands);
        let mut pass = RoutePass { log, settings: &self.settings, watch };
        let route = match &self.place {
            Some(place) => pass.in_place(place, all_stand)?,
            None => pass.route()?,
        }
        .without_doubts();
        let frame = route.frame(&self.settings)?;
        if is_followed && self.place.is_none() {
            self.place = Some(pass.place(&route)?);
        }
        check_seen(self.seen_m2 + route.seen_m2, &self.settings)?;
        self.seen_m2 += route.seen_m2;
        self.logs.push(SurveyedLog::new(entry, route, frame, self.settings.mapper.max_gap));
        Ok(())
    }

    /// Begins the second pass over a log, or goes on with it: the first reading is one that was not learned yet. The time
    /// since the log before counts as not observed, and so does a time without any scan (longer than 8 s, and than ten usual steps).
    ///
    /// # Errors
    ///
    /// When the log cannot be read, and when the map is too large. `None` if the log has no such reading: it is another one
    /// than in the first pass.
    pub fn replay(&mut self, number: usize, log: &Log) -> Result<Option<Replay>, SurveyError> {
        let Some(surveyed) = self.logs.get(number) else { return Ok(None) };
        let (settings, route, used) = (self.settings_of(number), surveyed.route(), surveyed.used);
        let mut filter = ScanFilter::judged(&settings.filter, judged(log, route, &settings.filter)?);
        let mut replay = Replay::new(number, log, surveyed.entry.offset_s)?;
        // The reading before: a scan that sweeps is undone from there on.
        let before = used.saturating_sub(1);
        let mut poses = FoundPoses::new(route.get(before..).unwrap_or_default().to_vec());
        for passed in 0..used {
            let Some(mut reading) = replay.next()? else { break };
            filter.apply(&mut reading);
            if passed == before {
                poses.posed(reading);
            }
        }
        let Some(begin_s) = replay.next_s() else { return Ok(None) };
        let max_step_s = max_step_s(route, settings.mapper.max_gap);
        let mapper = self.mapper_for(number, begin_s)?;
        let mut robot = Robot::new(Box::new(poses), mapper, NoPilot).with_filter(filter);
        robot.session_mut().max_step_s = max_step_s;
        self.robot = Some(robot);
        Ok(Some(replay))
    }

    /// The first log up to this one that does not say when it was recorded; from it on, nothing has hours.
    pub fn undated(&self, log: usize) -> Option<&LogEntry> {
        let mut entries = self.logs.iter().take(log + 1).map(|log| &log.entry);
        entries.find(|entry| !entry.is_dated())
    }

    /// Tells a mapper the date of the readings of a log.
    fn date(&self, mapper: &mut Mapper, log: usize) {
        let begin_s = self.logs.first().and_then(|first| first.entry.begin_s);
        mapper.set_epoch(begin_s.unwrap_or_default(), self.undated(log).is_none());
    }

    /// The map of the logs before, which grows by what a new one has seen.
    fn mapper_for(&mut self, number: usize, begin_s: f64) -> Result<Mapper, SurveyError> {
        let (settings, frame) = (self.settings_of(number), self.frame_of(number)?);
        let Some(Robot { mut mapper, .. }) = self.robot.take() else {
            let mut mapper = Mapper::new(&settings.mapper, frame)?;
            self.date(&mut mapper, number);
            return Ok(mapper);
        };
        self.date(&mut mapper, number);
        if self.logs[number].used == 0 {
            if let Some(growth) = mapper.grow(&settings.mapper, frame)? {
                self.changes.grow(&growth);
            }
            if self.begins_session(number) {
                self.book.begin_session(&mapper, number);
            }
            mapper.pause(begin_s);
        }
        Ok(mapper)
    }

    /// The robot makes a turn with the next reading of a log; `None` at its end.
    ///
    /// # Errors
    ///
    /// When the log cannot be read to its end, when the mapper refuses a reading, and when the map has taken all of its memory.
    pub fn turn(&mut self, replay: &mut Replay) -> Result<Option<Turn<LaserReading, ()>>, SurveyError> {
        let Self { robot: Some(robot), changes, book, logs, .. } = self else { return Ok(None) };
        let (Some(reading), Some(log)) = (replay.next()?, logs.get_mut(replay.number)) else {
            return Ok(None);
        };
        let turn = robot.step(reading)?;
        log.pass();
        changes.note(&robot.mapper);
        book.note(&robot.mapper);
        if robot.mapper.is_full() {
            let part = log.used as f64 / log.route().len().max(log.used) as f64;
            return Err(too_much(self.seen_m2, robot.mapper.bytes() as f64 / part, &self.settings));
        }
        if replay.is_over() {
            log.readings = log.used;
            self.keep_numbers();
        }
        Ok(Some(turn))
    }
}
