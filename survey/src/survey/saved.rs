//! A survey in a state file.

use super::Survey;
use crate::change_log::ChangeLog;
use crate::places::PlaceBook;
use crate::replay::FoundPoses;
use crate::settings::SurveySettings;
use crate::surveyed_log::SurveyedLog;
use interfaces::{GridFrame, PoseMode, from_bytes, to_bytes};
use localizer::KnownPlace;
use mapper::{Growth, Mapper, ScanFilterSettings};
use robot::state::{
    Facts, Session, State, StateError, saved_frame, saved_mapper_with, saved_sessions, saved_surfaces,
    with_map, with_sessions, with_surfaces,
};
use robot::{NoPilot, Robot};
use std::sync::Arc;

/// The parts of a state that only a survey uses; a robot that goes on in the place keeps them as they are.
pub const SURVEY_PARTS: [&str; 2] = [SavedLogs::PART, SavedSurvey::PART];

/// The logs of a survey that was saved: they can be read before the settings of the survey are known.
#[derive(Clone, Debug)]
pub struct SavedLogs {
    /// How the poses of the logs are used; `None` if a robot has learned the place.
    pub pose: Option<PoseMode>,
    logs: Vec<SurveyedLog>,
}

impl SavedLogs {
    /// The name of the part of a state that has the logs.
    const PART: &'static str = "logs";

    /// The logs in a state, and the sessions of robots.
    ///
    /// # Errors
    ///
    /// When the state has neither.
    pub fn read(state: &State) -> Result<Self, StateError> {
        let misfit = |_| StateError::OtherContent(Self::PART.to_owned());
        let (pose, mut logs): (Option<PoseMode>, Vec<SurveyedLog>) = match state.has(Self::PART) {
            true => from_bytes(state.section(Self::PART, &Facts::default())?).map_err(misfit)?,
            false => (None, Vec::new()),
        };
        let later = saved_sessions(state).into_iter().skip(logs.len());
        if let Some(frame) = saved_frame(state) {
            logs.extend(later.map(|session| SurveyedLog::of_session(session, frame)));
        }
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
    filter: ScanFilterSettings,
    place: Option<Arc<KnownPlace>>,
    mapper: Option<Mapper>,
    changes: ChangeLog,
    book: PlaceBook,
    logs: Vec<SurveyedLog>,
}

impl SavedSurvey {
    /// The name of the part of a state with what was learned from the logs.
    const PART: &'static str = "survey";

    /// Everything that logs have changed, as a state. `facts`: what it belongs to.
    pub fn into_state(self, facts: Facts) -> State {
        let Self { pose, filter, place, mapper, changes, book, logs } = self;
        let surfaces = place.map(|place| Arc::unwrap_or_clone(place).snapshot()).unwrap_or_default();
        let frame = mapper.as_ref().map(|mapper| *mapper.frame());
        let sessions: Vec<Session> = logs.iter().map(SurveyedLog::session).collect();
        let state = State::default()
            .with(SavedLogs::PART, Facts::default(), to_bytes(&(Some(pose), logs)))
            .with(Self::PART, facts, to_bytes(&(frame, changes, book)));
        let state = with_sessions(state, &sessions);
        match mapper {
            Some(mapper) => with_map(state, mapper, Some(&filter), surfaces),
            None => with_surfaces(state, surfaces),
        }
        .with_build()
    }

    /// What the survey in a state belongs to; `None` if the state is of a robot.
    pub fn facts(state: &State) -> Option<&Facts> {
        state.facts(Self::PART)
    }
}

impl Survey {
    /// Copies what logs have changed. This is short; to turn the copy into bytes takes longer.
    pub fn saved(&self) -> SavedSurvey {
        SavedSurvey {
            pose: self.settings.pose,
            filter: self.settings.filter.clone(),
            place: self.place.clone(),
            mapper: self.mapper().cloned(),
            changes: self.changes.clone(),
            book: self.book.clone(),
            logs: self.logs.clone(),
        }
    }

    /// Goes on from a state: from that of a survey with the same facts bit for bit, from that of a robot in its map. Also returns
    /// a note if settings differ.
    ///
    /// # Errors
    ///
    /// When the state was saved with other settings, or does not fit this program.
    pub fn restored(
        settings: SurveySettings,
        learns_noise: bool,
        state: &State,
        facts: &Facts,
    ) -> Result<(Self, Option<String>), StateError> {
        let misfit = |_| StateError::OtherContent(SavedSurvey::PART.to_owned());
        let logs = SavedLogs::read(state)?.logs;
        let place = saved_surfaces(state).map(KnownPlace::restored);
        let place = place.transpose().map_err(misfit)?.map(Arc::new);
        let mut survey = Self { place, logs, ..Self::new(settings, learns_noise) };
        let mut note = None;
        // The last log of which something was learned has set the noise.
        let last = survey.logs.iter().rposition(|log| log.used > 0);
        if let (Some(last), Some(_)) = (last, saved_frame(state)) {
            let settings = survey.settings_of(last);
            let (resolution_m, filter) = (survey.settings.resolution_m, Some(&survey.settings.filter));
            let (mut mapper, differs) = saved_mapper_with(state, &settings.mapper, resolution_m, filter)?;
            note = differs;
            survey.date(&mut mapper, last);
            survey.book = PlaceBook::of_map(&mapper);
            survey.robot = Some(Robot::new(Box::new(FoundPoses::new(Vec::new())), mapper, NoPilot));
        }
        if state.has(SavedSurvey::PART) {
            type Learned = (Option<GridFrame>, ChangeLog, PlaceBook);
            let learned: Learned = from_bytes(state.section(SavedSurvey::PART, facts)?).map_err(misfit)?;
            let frame;
            (frame, survey.changes, survey.book) = learned;
            // A robot can have learned in a larger map since.
            let growth =
                frame.zip(survey.mapper()).and_then(|(frame, mapper)| Growth::new(frame, *mapper.frame()));
            growth.iter().for_each(|growth| survey.changes.grow(growth));
        }
        Ok((survey, note))
    }
}
