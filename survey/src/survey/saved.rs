//! A survey in a state file.

use super::Survey;
use crate::change_log::ChangeLog;
use crate::known_place::KnownPlace;
use crate::replay::FoundPoses;
use crate::settings::SurveySettings;
use crate::surveyed_log::SurveyedLog;
use interfaces::{GridFrame, PoseMode, ValueError, read_value, write_value};
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
    pub fn read(mut bytes: &[u8]) -> Result<Self, ValueError> {
        let (pose, logs) = read_value(&mut bytes)?;
        if bytes.is_empty() { Ok(Self { pose, logs }) } else { Err(ValueError) }
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
    logs: Vec<SurveyedLog>,
}

impl SavedSurvey {
    /// Everything that logs have changed, as bytes: the logs, and what was learned from them; settings are not in it.
    pub fn into_snapshot(self) -> (Vec<u8>, Vec<u8>) {
        let Self { pose, place, mapper, changes, logs } = self;
        // All of it can be written. What could not would be refused when it is read.
        let bytes = |write: &dyn Fn(&mut Vec<u8>) -> Result<(), ValueError>| {
            let mut bytes = Vec::new();
            if write(&mut bytes).is_err() {
                bytes.clear();
            }
            bytes
        };
        let place = place.map(|place| Arc::unwrap_or_clone(place).snapshot());
        let mapper = mapper.map(|mut mapper| (*mapper.frame(), mapper.snapshot()));
        (
            bytes(&|bytes| write_value(&(pose, &logs), bytes)),
            bytes(&|bytes| write_value(&(&place, &mapper, &changes), bytes)),
        )
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
        mut learned: &[u8],
    ) -> Result<Self, ValueError> {
        type Learned = (Option<Vec<u8>>, Option<(GridFrame, Vec<u8>)>, ChangeLog);
        let (place, map, changes): Learned = read_value(&mut learned)?;
        if !learned.is_empty() {
            return Err(ValueError);
        }
        let place = place.map(|bytes| KnownPlace::restored(&settings, &bytes)).transpose()?;
        let mut survey = Self {
            settings,
            learns_noise,
            place: place.map(Arc::new),
            robot: None,
            changes,
            logs: logs.logs,
        };
        if let Some((frame, bytes)) = map {
            // The last log of which something was learned has set the noise.
            let last = survey.logs.iter().rposition(|log| log.used > 0).ok_or(ValueError)?;
            let settings = survey.settings_of(last);
            let mut mapper = Mapper::new(&settings.mapper, frame).map_err(|_| ValueError)?;
            mapper.restore(&bytes)?;
            let poses = Box::new(FoundPoses::new(Vec::new()));
            survey.robot = Some(Robot::new(poses, mapper, NoPilot));
        }
        Ok(survey)
    }
}
