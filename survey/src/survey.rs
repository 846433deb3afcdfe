//! What was learned from the logs of one place, one log after the other; more logs can follow, days later.

mod saved;
#[cfg(test)]
mod tests;

pub use saved::SavedLogs;

use crate::change_log::ChangeLog;
use crate::error::SurveyError;
use crate::extent::union;
use crate::known_place::KnownPlace;
use crate::passes::{PassError, RoutePass, RouteProgress, learn_on};
use crate::replay::{FoundPoses, Replay, judged};
use crate::route::frame;
use crate::settings::SurveySettings;
use crate::surveyed_log::{LogEntry, SurveyedLog};
use interfaces::{GridFrame, LaserReading, World};
use logs::{Log, Readings};
use mapper::Mapper;
use robot::{Belief, Localization};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The map of a place and its changes, from one or more logs in the order of their times.
///
/// A log is added by its [first pass](Self::first_pass), and learned by its [second one](Self::learn). Everything that a
/// log needs comes from the logs before it: the place in which it finds its own, the frame of the map, which grows, and the
/// noise. So it makes no difference, to the last bit, whether all logs are added at once or a survey is saved, restored,
/// and goes on with the next log.
#[derive(Clone, Debug)]
pub struct Survey {
    settings: SurveySettings,
    /// Whether the noise of the mapper follows from the routes.
    learns_noise: bool,
    place: Option<Arc<KnownPlace>>,
    mapper: Option<Mapper>,
    changes: ChangeLog,
    logs: Vec<SurveyedLog>,
}

impl Survey {
    /// A survey without a log. `learns_noise`: the noise in the settings is replaced by what the routes say about it.
    pub fn new(settings: SurveySettings, learns_noise: bool) -> Self {
        let changes = ChangeLog::default();
        Self { settings, learns_noise, place: None, mapper: None, changes, logs: Vec::new() }
    }

    /// The logs, in the order of their times.
    pub fn logs(&self) -> &[SurveyedLog] {
        &self.logs
    }

    /// The map; `None` before the first reading was learned.
    pub fn mapper(&self) -> Option<&Mapper> {
        self.mapper.as_ref()
    }

    /// When the cells changed last.
    pub fn changes(&self) -> &ChangeLog {
        &self.changes
    }

    /// The settings, with the noise for the logs up to this one.
    pub fn settings_of(&self, log: usize) -> SurveySettings {
        let mut settings = self.settings.clone();
        if self.learns_noise {
            let noises_m = self.logs.iter().take(log + 1).filter_map(|log| log.noise_m);
            settings.learn_noise_from(noises_m);
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

    /// Counts a log that was learned in part as finished: its rest is left out.
    pub fn leave_rest(&mut self, log: usize) {
        if let Some(log) = self.logs.get_mut(log) {
            log.readings = log.used;
        }
    }

    /// Forgets the poses of the logs that were learned: no [`replay`](Self::replay) needs them any more.
    pub fn forget_poses(&mut self) {
        self.logs.iter_mut().filter(|log| log.is_finished()).for_each(|log| log.poses = Arc::default());
    }

    /// The first pass over the next log. `is_followed`: other logs can follow, and must find their place.
    ///
    /// # Errors
    ///
    /// As for [`routes`](crate::routes()).
    pub fn first_pass(
        &mut self,
        log: &Log,
        entry: LogEntry,
        is_followed: bool,
        watch: impl FnMut(RouteProgress) -> ControlFlow<()>,
    ) -> Result<(), PassError> {
        let all_stand = entry.stands && self.logs.iter().all(|log| log.entry.stands);
        let mut pass = RoutePass { log, number: self.logs.len(), settings: &self.settings, watch };
        let route = match &self.place {
            Some(place) => pass.in_place(place, all_stand)?,
            None => pass.route()?,
        };
        let frame = frame(std::slice::from_ref(&route), &self.settings)?;
        if is_followed && self.place.is_none() {
            self.place = Some(Arc::new(pass.place(&route)?));
        }
        self.logs.push(SurveyedLog::new(entry, route, frame));
        Ok(())
    }

    /// A log from the first reading on that was not learned yet, and the poses of its readings.
    ///
    /// # Errors
    ///
    /// When the log cannot be read. `None` if it has no such reading: it is another one than in the first pass.
    pub fn replay(
        &self,
        number: usize,
        log: &Log,
    ) -> Result<Option<(Replay<Readings>, FoundPoses)>, PassError> {
        let Some(surveyed) = self.logs.get(number) else { return Ok(None) };
        let (settings, offset_s, used) = (&self.settings, surveyed.entry.offset_s, surveyed.used);
        let mut readings = log.readings()?;
        // The reading before: a scan that sweeps is undone from there on.
        let before = used.saturating_sub(1);
        for _ in 0..before {
            readings.next().transpose()?;
        }
        let no_returns = judged(log, &surveyed.poses, settings)?;
        let Some(mut replay) = Replay::new(readings, settings, offset_s)? else { return Ok(None) };
        let poses = surveyed.poses.get(before..).unwrap_or_default().to_vec();
        replay.judge(no_returns, poses.clone());
        let mut poses = FoundPoses::new(poses);
        if used > 0 {
            poses.pass(replay.sense());
            replay.act(&());
        }
        Ok(Some((replay, poses)))
    }

    /// The second pass over a log, from its [`replay`](Self::replay), until the log or `observe` ends it. Returns whether
    /// the log is learned; if it is not, the pass can go on with the same replay.
    ///
    /// `observe` is called once per reading, after the mapper has integrated it.
    ///
    /// # Errors
    ///
    /// When the log cannot be read to its end, when the mapper refuses a reading, and when the map is too large.
    pub fn learn<L>(
        &mut self,
        number: usize,
        replay: &mut Replay<Readings>,
        poses: &mut L,
        mut observe: impl FnMut(&Replay<Readings>, &LaserReading, &Belief) -> ControlFlow<()>,
    ) -> Result<bool, PassError>
    where
        L: Localization<LaserReading> + ?Sized,
    {
        let is_new = self.logs.get(number).is_some_and(|log| log.used == 0);
        let (settings, frame) = (self.settings_of(number), self.frame_of(number)?);
        let Self { mapper, changes, logs, .. } = self;
        let mapper = match mapper {
            None => mapper.insert(Mapper::new(&settings.mapper, frame).map_err(SurveyError::from)?),
            Some(mapper) if is_new => {
                if let Some(growth) = mapper.grow(&settings.mapper, frame).map_err(SurveyError::from)? {
                    changes.grow(&growth);
                }
                mapper.pause(replay.time_s());
                mapper
            }
            Some(mapper) => mapper,
        };
        let Some(log) = logs.get_mut(number) else { return Ok(true) };
        let mut is_over = false;
        let learned = learn_on(replay, poses, mapper, |replay, reading, belief| {
            log.used += 1;
            changes.note(belief.mapper);
            is_over = replay.is_over();
            observe(replay, reading, belief)
        });
        if is_over {
            log.readings = log.used;
        }
        log.measure();
        learned.map(|()| is_over)
    }
}
