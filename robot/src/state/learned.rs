//! What was learned about a place, as every program writes and reads it: the map, the surfaces in which poses are found, what
//! the scan filter knows, the sessions.

use super::facts::Facts;
use super::format::{State, StateError};
use crate::settings::default_mapper;
use crate::{Pilot, Robot};
use interfaces::{GridFrame, LaserReading};
use localizer::LocalizerSettings;
use mapper::{Mapper, MapperSettings, ScanFilterSettings};
use nalgebra::Point2;
use serde::{Deserialize, Serialize};

const MAPPER: &str = "mapper";
const LOCALIZATION: &str = "localization";
/// Absent where poses are given.
const SURFACES: &str = "surfaces";
const FILTER: &str = "filter";
/// The time at which readings have the time 0, in seconds since 1970-01-01 UTC. Absent where readings have no dates.
const DATES: &str = "dates";
const SESSIONS: &str = "sessions";
/// The settings that must be the same in a state and in the program that reads it, beside the resolution. Others are those of the
/// program.
const MUST_AGREE: [&str; 4] =
    ["mapper.estimator", "mapper.occupancy", "filter.max_range_m", "filter.min_shadow_angle_rad"];

/// A session in a place: a log, or a run of a robot.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Session {
    /// The program that learned from it.
    pub program: String,
    /// Its name: that of the log, or the program with a number.
    pub name: String,
    /// When it began, by the times of the map, s.
    pub offset_s: f64,
    /// This time in seconds since 1970-01-01 UTC; `None` if it is not known.
    pub begin_s: Option<f64>,
    /// The time from its begin to its end, s.
    pub duration_s: f64,
    /// The number of readings that entered the map, and of all readings.
    pub readings: [usize; 2],
    /// The laser, in words; empty if it is not known.
    pub laser: String,
    /// What was repaired, left out or assumed, each a sentence.
    pub notes: Vec<String>,
}

/// The sessions of a state, and the present one.
#[derive(Clone, Debug)]
pub struct Sessions {
    before: Vec<Session>,
    program: &'static str,
    /// The time and the number of readings of the map at its begin.
    begin_s: f64,
    readings: usize,
}

impl Sessions {
    /// No session before the one that begins with an empty map.
    pub fn of(program: &'static str) -> Self {
        Self { before: Vec::new(), program, begin_s: 0.0, readings: 0 }
    }

    /// The sessions of a state that `program` goes on with, in this map.
    pub fn after(state: Option<&State>, program: &'static str, mapper: &Mapper) -> Self {
        let before = state.map(saved_sessions).unwrap_or_default();
        Self { before, program, begin_s: mapper.time(), readings: mapper.readings() }
    }

    /// The sessions with the present one, which ends now, if it has learned something.
    pub fn now(&self, mapper: &Mapper) -> Vec<Session> {
        let mut sessions = self.before.clone();
        let readings = mapper.readings().saturating_sub(self.readings);
        if readings > 0 {
            sessions.push(Session {
                program: self.program.to_owned(),
                name: format!("{} {}", self.program, sessions.len() + 1),
                offset_s: self.begin_s,
                begin_s: date(mapper).map(|epoch_s| epoch_s + self.begin_s),
                duration_s: mapper.time() - self.begin_s,
                readings: [readings; 2],
                laser: String::new(),
                notes: Vec::new(),
            });
        }
        sessions
    }
}

/// The state with these sessions.
pub fn with_sessions(state: State, sessions: &Vec<Session>) -> State {
    state.with(SESSIONS, Facts::default(), interfaces::to_bytes(sessions))
}

/// The sessions in a state; none if it says nothing of them.
pub fn saved_sessions(state: &State) -> Vec<Session> {
    let bytes = state.section(SESSIONS, &Facts::default()).unwrap_or_default();
    interfaces::from_bytes(bytes).unwrap_or_default()
}

/// The time at which the readings of a map have the time 0, in seconds since 1970-01-01 UTC, if they have dates.
fn date(mapper: &Mapper) -> Option<f64> {
    Some(mapper.epoch_s()).filter(|epoch_s| mapper.is_dated() && *epoch_s > 0.0)
}

/// The surfaces in a state, in which poses are found; `None` if it has none.
pub fn saved_surfaces(state: &State) -> Option<&[u8]> {
    state.section(SURFACES, &Facts::default()).ok()
}

/// The state with a map, and with the surfaces in which poses are found, if there are some.
pub fn with_map(
    state: State,
    mut mapper: Mapper,
    filter: Option<&ScanFilterSettings>,
    surfaces: Vec<u8>,
) -> State {
    let facts = mapper_facts(mapper.settings(), mapper.frame(), filter);
    let epoch_s = date(&mapper);
    let state = state.with(MAPPER, facts, mapper.snapshot());
    let state = epoch_s
        .map_or(state.clone(), |epoch_s| state.with(DATES, Facts::default(), epoch_s.to_le_bytes().to_vec()));
    with_surfaces(state, surfaces)
}

/// The state with the surfaces in which poses are found, if there are some.
pub fn with_surfaces(state: State, surfaces: Vec<u8>) -> State {
    if surfaces.is_empty() { state } else { state.with(SURFACES, Facts::default(), surfaces) }
}

/// The frame of the map in a state; `None` if it has no map.
pub fn saved_frame(state: &State) -> Option<GridFrame> {
    let facts = state.facts(MAPPER)?;
    let numbers = |name, separator| -> Option<[f64; 2]> {
        let (a, b) = facts.get(name)?.trim_matches(['(', ')']).split_once(separator)?;
        Some([a.parse().ok()?, b.parse().ok()?])
    };
    let resolution_m = facts.get("map.resolution_m")?.parse().ok()?;
    let ([x, y], [width, height]) = (numbers("map.origin_m", ", ")?, numbers("map.cells", " × ")?);
    GridFrame::new(Point2::new(x, y), resolution_m, width as usize, height as usize)
}

/// The map in a state, with the settings of the program that saved it.
///
/// # Errors
///
/// When the state has none, or one of another version.
pub fn saved_mapper(state: &State) -> Result<Mapper, StateError> {
    let facts = state.facts(MAPPER).ok_or(StateError::NothingLearned)?;
    let settings = facts.settings("mapper").ok_or_else(|| StateError::OtherContent(MAPPER.to_owned()))?;
    read_mapper(state, facts, &settings)
}

/// The map in a state, with other settings, and a note if they differ from those of the state.
///
/// # Errors
///
/// When the state has no map, and when a setting differs that must agree.
pub fn saved_mapper_with(
    state: &State,
    settings: &MapperSettings,
    resolution_m: f64,
    filter: Option<&ScanFilterSettings>,
) -> Result<(Mapper, Option<String>), StateError> {
    let facts = state.facts(MAPPER).ok_or(StateError::NothingLearned)?;
    let frame = saved_frame(state).ok_or_else(|| StateError::OtherContent(MAPPER.to_owned()))?;
    if frame.resolution_m() != resolution_m {
        let [saved, expected] = [frame.resolution_m(), resolution_m].map(|side_m| format!("`{side_m}`"));
        return Err(StateError::OtherFacts { name: "map.resolution_m".to_owned(), saved, expected });
    }
    let others = facts.agree(&mapper_facts(settings, &frame, filter), &MUST_AGREE)?;
    let note = (!others.is_empty())
        .then(|| format!("the state has other values, and those of this run count: {}", others.join(", ")));
    Ok((read_mapper(state, facts, settings)?, note))
}

fn read_mapper(state: &State, facts: &Facts, settings: &MapperSettings) -> Result<Mapper, StateError> {
    let misfit = |part: &str| StateError::OtherContent(part.to_owned());
    let frame = saved_frame(state).ok_or_else(|| misfit(MAPPER))?;
    let mut mapper = Mapper::new(settings, frame).map_err(|_| misfit(MAPPER))?;
    mapper.restore(state.section(MAPPER, facts)?).map_err(|_| misfit(MAPPER))?;
    match state.section(DATES, &Facts::default()) {
        Ok(bytes) => {
            mapper.set_epoch(f64::from_le_bytes(bytes.try_into().map_err(|_| misfit(DATES))?), true);
        }
        Err(_) => mapper.set_epoch(0.0, false),
    }
    Ok(mapper)
}

fn map_facts(frame: &GridFrame) -> Facts {
    let origin = frame.origin();
    Facts::default()
        .with("map.resolution_m", frame.resolution_m())
        .with("map.cells", format!("{} × {}", frame.width(), frame.height()))
        .with("map.origin_m", format!("({}, {})", origin.x, origin.y))
}

fn mapper_facts(settings: &MapperSettings, frame: &GridFrame, filter: Option<&ScanFilterSettings>) -> Facts {
    let facts = map_facts(frame).with_learned_settings("mapper", settings, Some(&default_mapper()));
    match filter {
        Some(filter) => facts.with_learned_settings("filter", filter, Some(&ScanFilterSettings::default())),
        None => facts,
    }
}

/// The settings that what a robot has learned belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedFacts {
    filter: Option<ScanFilterSettings>,
    localization: Facts,
}

impl LearnedFacts {
    /// The facts of a localization, and of the filter of scans. `pose` is the name of the kind of localization; `localizer` is
    /// `None` if the poses are given.
    pub fn new(
        pose: &str,
        localizer: Option<&LocalizerSettings>,
        filter: Option<&ScanFilterSettings>,
    ) -> Self {
        let localization = Facts::default().with("pose", pose);
        let localization = match localizer {
            Some(settings) => {
                localization.with_learned_settings("localizer", settings, Some(&LocalizerSettings::default()))
            }
            None => localization,
        };
        Self { filter: filter.cloned(), localization }
    }

    /// Copies what was learned. This is short; to turn the copy into bytes takes longer.
    pub fn snapshot<P: Pilot>(&self, robot: &mut Robot<LaserReading, P>) -> LearnedSnapshot {
        let mapper = robot.mapper.clone();
        let (localization, surfaces) =
            (robot.localization_mut().snapshot(), robot.localization_mut().surfaces());
        let filter = robot.filter_mut().map(|filter| interfaces::snapshot(filter.values()));
        let filter = filter.unwrap_or_default();
        LearnedSnapshot { facts: self.clone(), mapper, localization, surfaces, filter }
    }

    /// Lets a robot go on with what was learned, by this program or by another one. The robot keeps its settings and its frame,
    /// which must cover the saved map. A robot that localizes itself searches for its pose in the saved surfaces, unless the state
    /// has a localization with the same settings and frame. Returns a note if settings differ.
    ///
    /// # Errors
    ///
    /// When the state does not hold what was learned, or holds it with other settings. The robot must not
    /// be used then.
    pub fn restore<P: Pilot>(
        &self,
        state: &State,
        robot: &mut Robot<LaserReading, P>,
    ) -> Result<Option<String>, StateError> {
        let misfit = |part: &str| StateError::OtherContent(part.to_owned());
        let (settings, frame) = (robot.mapper.settings().clone(), *robot.mapper.frame());
        let dates = (robot.mapper.epoch_s(), robot.mapper.is_dated());
        let (mut mapper, note) =
            saved_mapper_with(state, &settings, frame.resolution_m(), self.filter.as_ref())?;
        if !state.has(DATES) {
            mapper.set_epoch(dates.0, dates.1);
        }
        let is_same_frame = *mapper.frame() == frame;
        let is_covered = is_same_frame || mapper.grow(&settings, frame).is_ok_and(|growth| growth.is_some());
        if !is_covered {
            let text = |frame: &GridFrame| {
                map_facts(frame).iter().map(|(_, value)| value.to_owned()).collect::<Vec<_>>().join(", ")
            };
            let (saved, expected) = (text(mapper.frame()), text(&frame));
            return Err(StateError::OtherFacts { name: "map".to_owned(), saved, expected });
        }
        robot.mapper = mapper;
        match state.section(LOCALIZATION, &self.localization) {
            Ok(learned) if is_same_frame => {
                robot.localization_mut().restore(learned).map_err(|_| misfit(LOCALIZATION))?;
            }
            _ => {
                let surfaces = saved_surfaces(state).unwrap_or_default();
                robot.begin_in(surfaces).map_err(|_| misfit(SURFACES))?;
            }
        }
        if let (Some(filter), Ok(learned)) = (robot.filter_mut(), state.section(FILTER, &Facts::default())) {
            interfaces::restore(filter.values(), learned).map_err(|_| misfit(FILTER))?;
        }
        Ok(note)
    }
}

/// A copy of what was learned. A thread can turn it into bytes while the robot goes on.
#[derive(Clone, Debug)]
pub struct LearnedSnapshot {
    facts: LearnedFacts,
    mapper: Mapper,
    localization: Vec<u8>,
    surfaces: Vec<u8>,
    filter: Vec<u8>,
}

impl LearnedSnapshot {
    /// Adds what was learned to a state.
    pub fn added_to(self, state: State) -> State {
        let Self { facts, mapper, localization, surfaces, filter } = self;
        let state = with_map(state, mapper, facts.filter.as_ref(), surfaces);
        let state = state.with(LOCALIZATION, facts.localization, localization);
        if filter.is_empty() { state } else { state.with(FILTER, Facts::default(), filter) }
    }
}
