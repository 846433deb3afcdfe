//! What a robot has learned about a place: its mapper, and what gives its readings their poses.

use super::facts::Facts;
use super::format::{State, StateError};
use crate::{Pilot, Robot};
use interfaces::{GridFrame, LaserReading};
use localizer::LocalizerSettings;
use mapper::{Mapper, MapperSettings};

const MAPPER: &str = "mapper";
const LOCALIZATION: &str = "localization";
/// What is said of a state whose map is used, and not what its localizer knew.
const RELOCALIZES: &str =
    "the state is of an earlier version: its map is used, and the robot searches for its pose in it";
/// Missing in the states of earlier versions.
const FILTER: &str = "filter";

/// The settings that what was learned belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedFacts {
    mapper: Facts,
    localization: Facts,
    filter: Facts,
}

impl LearnedFacts {
    /// The facts of a mapper with this frame, and of a localization. `pose` is the name of the kind of localization;
    /// `localizer` is `None` if the poses are given.
    pub fn new(
        mapper: &MapperSettings,
        frame: &GridFrame,
        pose: &str,
        localizer: Option<&LocalizerSettings>,
    ) -> Self {
        let origin = frame.origin();
        let map = Facts::default()
            .with("map.resolution_m", frame.resolution_m())
            .with("map.cells", format!("{} × {}", frame.width(), frame.height()))
            .with("map.origin_m", format!("({}, {})", origin.x, origin.y));
        let poses = map.clone().with("pose", pose);
        let localization = match localizer {
            Some(settings) => {
                poses.with_learned_settings("localizer", settings, Some(&LocalizerSettings::default()))
            }
            None => poses,
        };
        let filter = map.clone();
        let mapper = map.with_learned_settings("mapper", mapper, Some(&MapperSettings::default()));
        Self { mapper, localization, filter }
    }

    /// Copies what was learned. This is short; to turn the copy into bytes takes longer.
    pub fn snapshot<P: Pilot>(&self, robot: &mut Robot<LaserReading, P>) -> LearnedSnapshot {
        let (mapper, localization) = (robot.mapper.clone(), robot.localization_mut().snapshot());
        let filter = robot.filter_mut().map(|filter| interfaces::snapshot(filter.values()));
        LearnedSnapshot { facts: self.clone(), mapper, localization, filter: filter.unwrap_or_default() }
    }

    /// Lets a robot that was made with the settings of these facts go on with what was learned. Returns a note for the user if
    /// the state is of an earlier version, whose localizer is not read.
    ///
    /// # Errors
    ///
    /// When the state does not hold what was learned, or holds it with other settings. The robot must not
    /// be used then.
    pub fn restore<P: Pilot>(
        &self,
        state: &State,
        robot: &mut Robot<LaserReading, P>,
    ) -> Result<Option<&'static str>, StateError> {
        let misfit = |part: &str| StateError::OtherContent(part.to_owned());
        let learned = [
            state.section(MAPPER, &self.mapper)?, //
            state.section(LOCALIZATION, &self.localization)?,
        ];
        robot.mapper.restore(learned[0]).map_err(|_| misfit(MAPPER))?;
        let searches = robot.restore_localization(learned[1], state.is_earlier());
        let searches = searches.map_err(|_| misfit(LOCALIZATION))?;
        // Absent from states of programs that did not save it.
        if let (Some(filter), Ok(learned)) = (robot.filter_mut(), state.section(FILTER, &self.filter)) {
            interfaces::restore(filter.values(), learned).map_err(|_| misfit(FILTER))?;
        }
        Ok(searches.then_some(RELOCALIZES))
    }
}

/// A copy of what was learned. A thread can turn it into bytes while the robot goes on.
#[derive(Clone, Debug)]
pub struct LearnedSnapshot {
    facts: LearnedFacts,
    mapper: Mapper,
    localization: Vec<u8>,
    filter: Vec<u8>,
}

impl LearnedSnapshot {
    /// Adds what was learned to a state.
    pub fn added_to(self, state: State) -> State {
        let Self { facts, mut mapper, localization, filter } = self;
        let state = state.with(MAPPER, facts.mapper, mapper.snapshot());
        let state = state.with(LOCALIZATION, facts.localization, localization);
        if filter.is_empty() { state } else { state.with(FILTER, facts.filter, filter) }
    }
}
