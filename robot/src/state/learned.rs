//! What a robot has learned about a place: its mapper, and what gives its readings their poses.

use super::facts::Facts;
use super::format::{State, StateError};
use crate::settings::default_mapper;
use crate::{Pilot, Robot};
use interfaces::{GridFrame, LaserReading};
use localizer::LocalizerSettings;
use mapper::{Calendar, Mapper, MapperSettings};
use nalgebra::Point2;

const MAPPER: &str = "mapper";
const LOCALIZATION: &str = "localization";
const FILTER: &str = "filter";
/// The time at which readings have the time 0, in seconds since 1970-01-01 UTC. Absent where readings have no dates.
const DATES: &str = "dates";

/// The mapper that a robot has left in a state, whatever its settings are. It has the dates of its readings if the robot knew them.
///
/// # Errors
///
/// When the state has none, or one of another program.
pub fn saved_mapper(state: &State) -> Result<Mapper, StateError> {
    let facts = state.facts(MAPPER).ok_or_else(|| StateError::NoSection(MAPPER.to_owned()))?;
    let numbers = |name, separator| -> Option<[f64; 2]> {
        let (a, b) = facts.get(name)?.trim_matches(['(', ')']).split_once(separator)?;
        Some([a.parse().ok()?, b.parse().ok()?])
    };
    let frame = || {
        let resolution_m = facts.get("map.resolution_m")?.parse().ok()?;
        let ([x, y], [width, height]) = (numbers("map.origin_m", ", ")?, numbers("map.cells", " × ")?);
        GridFrame::new(Point2::new(x, y), resolution_m, width as usize, height as usize)
    };
    let misfit = || StateError::OtherContent(MAPPER.to_owned());
    let settings: MapperSettings = facts.settings("mapper").ok_or_else(misfit)?;
    let mut mapper = Mapper::new(&settings, frame().ok_or_else(misfit)?).map_err(|_| misfit())?;
    mapper.restore(state.section(MAPPER, facts)?).map_err(|_| misfit())?;
    match state.has(DATES) {
        true => {
            let bytes = state.section(DATES, &Facts::default())?.try_into();
            let epoch_s = f64::from_le_bytes(bytes.map_err(|_| StateError::OtherContent(DATES.to_owned()))?);
            mapper.set_epoch(epoch_s, true);
        }
        false => mapper.set_epoch(0.0, false),
    }
    Ok(mapper)
}

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
        let mapper = map.with_learned_settings("mapper", mapper, Some(&default_mapper()));
        Self { mapper, localization, filter }
    }

    /// Copies what was learned. This is short; to turn the copy into bytes takes longer.
    pub fn snapshot<P: Pilot>(&self, robot: &mut Robot<LaserReading, P>) -> LearnedSnapshot {
        let (mapper, localization) = (robot.mapper.clone(), robot.localization_mut().snapshot());
        let filter = robot.filter_mut().map(|filter| interfaces::snapshot(filter.values()));
        LearnedSnapshot { facts: self.clone(), mapper, localization, filter: filter.unwrap_or_default() }
    }

    /// Lets a robot that was made with the settings of these facts go on with what was learned.
    ///
    /// # Errors
    ///
    /// When the state does not hold what was learned, or holds it with other settings. The robot must not
    /// be used then.
    pub fn restore<P: Pilot>(
        &self,
        state: &State,
        robot: &mut Robot<LaserReading, P>,
    ) -> Result<(), StateError> {
        let misfit = |part: &str| StateError::OtherContent(part.to_owned());
        let learned = [
            state.section(MAPPER, &self.mapper)?, //
            state.section(LOCALIZATION, &self.localization)?,
        ];
        robot.mapper.restore(learned[0]).map_err(|_| misfit(MAPPER))?;
        robot.localization_mut().restore(learned[1]).map_err(|_| misfit(LOCALIZATION))?;
        if let (Some(filter), Ok(learned)) = (robot.filter_mut(), state.section(FILTER, &self.filter)) {
            interfaces::restore(filter.values(), learned).map_err(|_| misfit(FILTER))?;
        }
        Ok(())
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
        let is_dated = *mapper.calendar() != Calendar::Relative;
        let epoch_s = mapper.epoch_s().to_le_bytes().to_vec();
        let state = state.with(MAPPER, facts.mapper, mapper.snapshot());
        let state = if is_dated { state.with(DATES, Facts::default(), epoch_s) } else { state };
        let state = state.with(LOCALIZATION, facts.localization, localization);
        if filter.is_empty() { state } else { state.with(FILTER, facts.filter, filter) }
    }
}
