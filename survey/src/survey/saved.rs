//! A survey in a state file.

use super::Survey;
use crate::change_log::ChangeLog;
use crate::places::PlaceBook;
use crate::replay::FoundPoses;
use crate::settings::SurveySettings;
use crate::surveyed_log::SurveyedLog;
use interfaces::{GridFrame, PoseMode, ValueError, from_bytes, to_bytes};
use localizer::KnownPlace;
use mapper::Mapper;
use robot::{NoPilot, Robot};
use std::sync::Arc;

/// The logs of a survey that was saved: they can be read before the settings of the survey are known.
#[derive(Clone, Debug)]
pub struct SavedLogs {
    /// How the poses of the logs are used.
    pub pose: PoseMode,
    logs: Vec<SurveyedLog>,
}

impl SavedLogs {
    /// The name of the part of a state that has the logs.
    pub const PART: &'static str = "logs";

    /// The logs from their bytes.
    ///
    /// # Errors
    ///
    /// When the bytes are no logs of a survey.
    pub fn read(bytes: &[u8]) -> Result<Self, ValueError> {
        from_bytes(bytes).map(|(pose, logs)| Self { pose, logs })
    }

    /// The logs, in the order of their times.
    pub fn logs(&self) -> &[SurveyedLog] {
        &self.logs
    }
}

/// A copy of a survey. A thread can turn it into bytes while the survey goes on.
#[derive(Clone, Debug)]
pub struct SavedSurvey {
    pose: PoseMode,
    place: Option<Arc<KnownPlace>>,
    mapper: Option<Mapper>,
    changes: ChangeLog,
    book: PlaceBook,
    logs: Vec<SurveyedLog>,
}

impl SavedSurvey {
    /// The name of the part of a state with what was learned from the logs.
    pub const PART: &'static str = "survey";

    /// Everything that logs have changed, as bytes: the logs, and what was learned from them; settings are not in it.
    pub fn into_snapshot(self) -> (Vec<u8>, Vec<u8>) {
        let Self { pose, place, mapper, changes, book, logs } = self;
        let place = place.map(|place| Arc::unwrap_or_clone(place).snapshot());
        let mapper = mapper.map(|mut mapper| (*mapper.frame(), mapper.snapshot()));
        (to_bytes(&(pose, logs)), to_bytes(&(place, mapper, changes, book)))
    }
}

impl Survey {
    /// Copies what logs have changed. This is short; to turn the copy into bytes takes longer.
    pub fn saved(&self) -> SavedSurvey {
        SavedSurvey {
            pose: self.settings.pose,
            place: self.place.clone(),
            mapper: self.mapper().cloned(),
            changes: self.changes.clone(),
            book: self.book.clone(),
            logs: self.logs.clone(),
        }
    }

    /// Goes on from the snapshot of a survey with the same settings, bit for bit.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot.
    pub fn restored(
        settings: SurveySettings,
        learns_noise: bool,
        logs: SavedLogs,
        learned: &[u8],
    ) -> Result<Self, ValueError> {
        type Learned = (Option<Vec<u8>>, Option<(GridFrame, Vec<u8>)>, ChangeLog, PlaceBook);
        let (place, map, changes, book): Learned = from_bytes(learned)?;
        let place = place.map(|bytes| KnownPlace::restored(&bytes)).transpose()?;
        let mut survey = Self {
            settings,
            learns_noise,
            place: place.map(Arc::new),
            robot: None,
            changes,
            book,
            logs: logs.logs,
            seen_m2: 0.0,
        };
        if let Some((frame, bytes)) = map {
            // The last log of which something was learned has set the noise.
            let last = survey.logs.iter().rposition(|log| log.used > 0).ok_or(ValueError)?;
            let settings = survey.settings_of(last);
            let mut mapper = Mapper::new(&settings.mapper, frame).map_err(|_| ValueError)?;
            survey.date(&mut mapper, last);
            mapper.restore(&bytes)?;
            let poses = Box::new(FoundPoses::new(Vec::new()));
            survey.robot = Some(Robot::new(poses, mapper, NoPilot));
        }
        Ok(survey)
    }
}
