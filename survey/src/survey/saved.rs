//! A survey in a state file.

use super::Survey;
use crate::change_log::ChangeLog;
use crate::places::{Directions, PlaceBook};
use crate::quality::Quality;
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
        type Saved = (PoseMode, Vec<SurveyedLog>, Vec<Quality>);
        let Ok((pose, mut logs, qualities)) = from_bytes::<Saved>(bytes) else {
            return from_bytes(bytes).map(|(pose, logs)| Self { pose, logs }); // an earlier state, without qualities
        };
        logs.iter_mut().zip(qualities).for_each(|(log, quality)| log.quality = quality);
        Ok(Self { pose, logs })
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
        let qualities: Vec<Quality> = logs.iter().map(|log| log.quality.clone()).collect();
        let logs = to_bytes(&(pose, logs, qualities));
        // Without directions, the bytes are those of an earlier state, which has none.
        let learned = match book.directions.is_empty() {
            true => to_bytes(&(place, mapper, changes, book)),
            false => to_bytes(&(place, mapper, changes, &book, &book.directions)),
        };
        (logs, learned)
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
        type Earlier = (Option<Vec<u8>>, Option<(GridFrame, Vec<u8>)>, ChangeLog);
        type Undirected = (Option<Vec<u8>>, Option<(GridFrame, Vec<u8>)>, ChangeLog, PlaceBook);
        type Learned = (Option<Vec<u8>>, Option<(GridFrame, Vec<u8>)>, ChangeLog, PlaceBook, Directions);
        let (place, map, changes, book) =
            if let Ok((place, map, changes, mut book, directions)) = from_bytes::<Learned>(learned) {
                book.directions = directions;
                (place, map, changes, Some(book))
            } else if let Ok((place, map, changes, book)) = from_bytes::<Undirected>(learned) {
                (place, map, changes, Some(book))
            } else {
                from_bytes::<Earlier>(learned).map(|(place, map, changes)| (place, map, changes, None))?
            };
        let is_earlier = book.is_none();
        let place = place.map(|bytes| KnownPlace::restored(&bytes)).transpose()?;
        let mut survey = Self {
            settings,
            learns_noise,
            place: place.map(Arc::new),
            robot: None,
            changes,
            book: book.unwrap_or_default(),
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
            if is_earlier {
                survey.book = PlaceBook::of_map(&mapper); // a state of a version before 10 has none
            }
            let poses = Box::new(FoundPoses::new(Vec::new()));
            survey.robot = Some(Robot::new(poses, mapper, NoPilot));
        }
        Ok(survey)
    }
}
