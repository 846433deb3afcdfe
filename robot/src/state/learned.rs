//! What a robot has learned of a place: from its parts into a state, and back.

use super::format::{Part, SavedMap, Session, State};
use super::settings::{SavedSettings, StateError};
use crate::build::BUILD;
use crate::{Pilot, Robot, Settings};
use interfaces::{LaserReading, PoseMode, ValueError};
use localizer::LoopClosingLocalizer;
use mapper::{Calendar, Mapper, MapperSettings, ScanFilterSettings};

impl SavedMap {
    /// The map of a mapper, whose scans were filtered with these settings.
    pub fn of(mut mapper: Mapper, filter: &ScanFilterSettings) -> Self {
        let (frame, bytes) = (*mapper.frame(), mapper.snapshot());
        let settings = settings_of(mapper.settings(), filter, frame.resolution_m());
        Self { frame, settings, epoch_s: epoch_s(&mapper), bytes }
    }

    /// The map, with the settings of the program that saved it.
    ///
    /// # Errors
    ///
    /// When its settings or its bytes are not those of this program.
    pub fn mapper(&self) -> Result<Mapper, StateError> {
        self.read(&self.settings.get("mapper").ok_or(ValueError)?)
    }

    /// The map with other settings, and a note if they differ from those of the program that saved it. Its clocks go on, in its
    /// time zone unless another one is set.
    ///
    /// # Errors
    ///
    /// When a setting differs that must agree.
    pub fn mapper_with(
        &self,
        mapper: &MapperSettings,
        filter: &ScanFilterSettings,
        resolution_m: f64,
    ) -> Result<(Mapper, Option<String>), StateError> {
        let saved: MapperSettings = self.settings.get("mapper").ok_or(ValueError)?;
        let mut settings = mapper.clone();
        settings.clocks |= saved.clocks;
        settings.time_zone = settings.time_zone.or(saved.time_zone);
        let note = self.settings.agree(&settings_of(&settings, filter, resolution_m))?;
        Ok((self.read(&settings)?, note))
    }

    fn read(&self, settings: &MapperSettings) -> Result<Mapper, StateError> {
        let mut mapper = Mapper::new(settings, self.frame).map_err(|_| ValueError)?;
        mapper.restore(&self.bytes)?;
        mapper.set_epoch(self.epoch_s.unwrap_or_default(), self.epoch_s.is_some());
        Ok(mapper)
    }
}

fn settings_of(mapper: &MapperSettings, filter: &ScanFilterSettings, resolution_m: f64) -> SavedSettings {
    SavedSettings::default().with("resolution_m", &resolution_m).with("mapper", mapper).with("filter", filter)
}

/// The settings on which the snapshot of a localization depends.
fn localization_of(settings: &Settings) -> SavedSettings {
    match settings.pose {
        PoseMode::Localized => SavedSettings::default().with("localizer", &settings.localizer),
        PoseMode::Exact | PoseMode::Odometry | PoseMode::Corrected => {
            SavedSettings::default().with("pose", &"given")
        }
    }
}

/// The time at which the readings of a map have the time 0, in seconds since 1970-01-01 UTC, if they have dates.
fn epoch_s(mapper: &Mapper) -> Option<f64> {
    let has_dates = mapper.epoch_s() > 0.0 || *mapper.calendar() != Calendar::Relative;
    (mapper.is_dated() && has_dates).then(|| mapper.epoch_s())
}

/// The sessions of a state, and that of a robot that goes on with it.
#[derive(Clone, Debug)]
pub struct Sessions {
    program: &'static str,
    before: Vec<Session>,
    /// The time and the readings of the map when the present session began.
    begin_s: f64,
    readings: usize,
}

impl Sessions {
    /// The first session in a place, by this program.
    pub fn of(program: &'static str) -> Self {
        Self { program, before: Vec::new(), begin_s: 0.0, readings: 0 }
    }

    /// A session begins in the map of a state.
    pub fn go_on(&mut self, state: &State, mapper: &Mapper) {
        self.before.clone_from(&state.sessions);
        (self.begin_s, self.readings) = (mapper.time(), mapper.readings());
    }

    /// All sessions; the present one ends now, and counts if it has learned something.
    fn until_now(&self, mapper: &Mapper) -> Vec<Session> {
        let readings = mapper.readings().saturating_sub(self.readings);
        let now = || Session {
            name: format!("{} {}", self.program, self.before.len() + 1),
            offset_s: self.begin_s,
            begin_s: epoch_s(mapper).map(|epoch_s| epoch_s + self.begin_s),
            duration_s: mapper.time() - self.begin_s,
            readings: [readings; 2],
            ..Session::default()
        };
        self.before.iter().cloned().chain((readings > 0).then(now)).collect()
    }
}

/// A copy of what was learned: to make a state of it takes longer than to copy, and a thread can do it while the robot goes on.
pub type StateCopy = Box<dyn FnOnce() -> State + Send>;

/// Copies what a robot with these settings has learned.
pub fn learned<P: Pilot>(
    robot: &mut Robot<LaserReading, P>,
    settings: &Settings,
    sessions: &Sessions,
) -> StateCopy {
    let (mapper, sessions) = (robot.mapper.clone(), sessions.until_now(&robot.mapper));
    let bytes = robot.localization.snapshot();
    let surfaces = robot.localization.localizer_mut().map(LoopClosingLocalizer::surfaces).unwrap_or_default();
    let localization = Part { settings: localization_of(settings), bytes };
    let filter =
        robot.filter.as_mut().map(|filter| interfaces::snapshot(filter.values())).unwrap_or_default();
    let filter_settings = settings.filter.clone();
    Box::new(move || State {
        build: BUILD.to_owned(),
        sessions,
        map: Some(SavedMap::of(mapper, &filter_settings)),
        surfaces,
        filter,
        localization,
        ..State::default()
    })
}

/// Lets a robot with these settings go on with what was learned, by any program. The robot keeps its settings and its frame,
/// which must cover the saved map. A robot that localizes itself searches for its pose in the saved surfaces, unless the state
/// has a localization with the same settings and frame. Returns a note if settings differ.
///
/// # Errors
///
/// When the state does not hold what was learned, or when a setting differs that must agree. The robot must not be used then.
pub fn restore<P: Pilot>(
    state: &State,
    robot: &mut Robot<LaserReading, P>,
    settings: &Settings,
) -> Result<Option<String>, StateError> {
    let map = state.map.as_ref().ok_or(StateError::NothingLearned)?;
    let (frame, dates) = (*robot.mapper.frame(), (robot.mapper.epoch_s(), robot.mapper.is_dated()));
    let (mut mapper, note) = map.mapper_with(&settings.mapper, &settings.filter, frame.resolution_m())?;
    if map.epoch_s.is_none() {
        mapper.set_epoch(dates.0, dates.1);
    }
    let is_same_frame = map.frame == frame;
    if !is_same_frame && !mapper.grow(&settings.mapper, frame).is_ok_and(|growth| growth.is_some()) {
        let [saved, expected] = [map.frame, frame].map(|frame| format!("{frame:?}"));
        return Err(StateError::OtherSettings { name: "frame".to_owned(), saved, expected });
    }
    if is_same_frame && state.localization.settings == localization_of(settings) {
        robot.localization.restore(&state.localization.bytes)?;
    } else if let Some(localizer) = robot.localization.localizer_mut() {
        localizer.begin_in(&state.surfaces, mapper.states())?;
    }
    robot.mapper = mapper;
    if let Some(filter) = robot.filter.as_mut().filter(|_| !state.filter.is_empty()) {
        interfaces::restore(filter.values(), &state.filter)?;
    }
    Ok(note)
}
