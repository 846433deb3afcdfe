//! A survey in a state file.

use super::Survey;
use crate::change_log::ChangeLog;
use crate::passes::FoundPoses;
use crate::places::PlaceBook;
use crate::settings::SurveySettings;
use crate::surveyed_log::SurveyedLog;
use interfaces::{GridFrame, from_bytes, to_bytes};
use localizer::KnownPlace;
use mapper::Growth;
use robot::state::{Part, SavedMap, SavedSettings, State, StateCopy, StateError};
use robot::{BUILD, NoPilot, Robot};
use serde::{Deserialize, Serialize};

/// What a state has of a survey, beside the map and the surfaces.
#[derive(Debug, Default, Deserialize, Serialize)]
pub(crate) struct SavedSurvey {
    /// The frame of the map in which the changes are.
    frame: Option<GridFrame>,
    pub(crate) changes: ChangeLog,
    pub(crate) book: PlaceBook,
    pub(crate) logs: Vec<SurveyedLog>,
}

impl SavedSurvey {
    /// The survey in a state; its logs end with the sessions of robots that went on in the map. Empty if nothing was learned.
    pub(crate) fn of(state: &State) -> Result<Self, StateError> {
        let mut saved = match &state.survey {
            Some(survey) => from_bytes(&survey.bytes)?,
            None => Self::default(),
        };
        let Some(map) = &state.map else { return Ok(saved) };
        let later = state.sessions.iter().skip(saved.logs.len());
        saved.logs.extend(later.map(|session| SurveyedLog::of_session(session.clone(), map.frame)));
        // A robot can have learned in a larger map since.
        let growth = saved.frame.replace(map.frame).and_then(|frame| Growth::new(frame, map.frame));
        growth.iter().for_each(|growth| saved.changes.grow(growth));
        if state.survey.is_none() {
            saved.book = PlaceBook::of_map(&map.mapper()?);
        }
        Ok(saved)
    }
}

/// The logs in a state, and the sessions of robots, in the order of their times.
///
/// # Errors
///
/// When the state is not one of this program.
pub fn saved_logs(state: &State) -> Result<Vec<SurveyedLog>, StateError> {
    SavedSurvey::of(state).map(|saved| saved.logs)
}

/// The settings of the survey in a state; `None` if no log was learned.
pub fn saved_settings(state: &State) -> Option<SurveySettings> {
    state.survey.as_ref()?.settings.get("survey")
}

impl Survey {
    /// Copies what logs have changed.
    pub fn saved(&self) -> StateCopy {
        let settings = SavedSettings::default().with("survey", &self.settings);
        let (filter, place, mapper) =
            (self.settings.filter.clone(), self.place.clone(), self.mapper().cloned());
        let frame = mapper.as_ref().map(|mapper| *mapper.frame());
        let (changes, book, logs) = (self.changes.clone(), self.book.clone(), self.logs.clone());
        Box::new(move || State {
            build: BUILD.to_owned(),
            sessions: logs.iter().map(SurveyedLog::session).collect(),
            map: mapper.map(|mapper| SavedMap::of(mapper, &filter)),
            surfaces: place.map(KnownPlace::snapshot).unwrap_or_default(),
            survey: Some(Part { settings, bytes: to_bytes(&SavedSurvey { frame, changes, book, logs }) }),
            ..State::default()
        })
    }

    /// Goes on from a state: from that of a survey with the same settings bit for bit, from that of a robot in its map. Also
    /// returns notes on settings that differ.
    ///
    /// # Errors
    ///
    /// When a setting differs that must agree, and when the state does not fit this program.
    pub fn restored(
        settings: SurveySettings,
        learns_noise: bool,
        state: &State,
    ) -> Result<(Self, Option<String>), StateError> {
        let mut note = match &state.survey {
            Some(survey) => survey.settings.agree(&SavedSettings::default().with("survey", &settings))?,
            None => None,
        };
        let SavedSurvey { changes, book, logs, .. } = SavedSurvey::of(state)?;
        let place = Some(&state.surfaces).filter(|surfaces| !surfaces.is_empty());
        let place = place.map(|surfaces| KnownPlace::restored(surfaces)).transpose()?;
        let mut survey = Self { place, changes, book, logs, ..Self::new(settings, learns_noise) };
        // The last log of which something was learned has set the noise.
        let last = survey.logs.iter().rposition(|log| log.used > 0);
        if let (Some(last), Some(map)) = (last, &state.map) {
            let settings = survey.settings_of(last);
            let (mut mapper, other) =
                map.mapper_with(&settings.mapper, &settings.filter, settings.resolution_m)?;
            note = note.or(other);
            survey.date(&mut mapper, last);
            survey.robot = Some(Robot::new(Box::new(FoundPoses::new(Vec::new())), mapper, NoPilot));
        }
        Ok((survey, note))
    }
}
