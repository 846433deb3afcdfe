//! What a robot has learned about a place: its mapper, and what gives its readings their poses.

use super::facts::Facts;
use super::format::{State, StateError};
use crate::Localization;
use interfaces::{GridFrame, LaserReading};
use localizer::LocalizerSettings;
use mapper::{Mapper, MapperSettings};

const MAPPER: &str = "mapper";
const LOCALIZATION: &str = "localization";

/// The settings that what was learned belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedFacts {
    mapper: Facts,
    localization: Facts,
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
        let mapper = map.with_learned_settings("mapper", mapper, Some(&MapperSettings::default()));
        Self { mapper, localization }
    }

    /// Copies what was learned. This is short; to turn the copy into bytes takes longer.
    pub fn snapshot<L>(&self, mapper: &Mapper, localization: &mut L) -> LearnedSnapshot
    where
        L: Localization<LaserReading> + ?Sized,
    {
        let (mapper, localization) = (mapper.clone(), localization.snapshot());
        LearnedSnapshot { facts: self.clone(), mapper, localization }
    }

    /// Goes on with what was learned. The mapper and the localization were made with the settings of these facts.
    ///
    /// # Errors
    ///
    /// When the state does not hold what was learned, or holds it with other settings. The mapper and the localization
    /// must not be used then.
    pub fn restore<L>(
        &self,
        state: &State,
        mapper: &mut Mapper,
        localization: &mut L,
    ) -> Result<(), StateError>
    where
        L: Localization<LaserReading> + ?Sized,
    {
        let misfit = |part: &str| StateError::OtherContent(part.to_owned());
        let learned = [
            state.section(MAPPER, &self.mapper)?, //
            state.section(LOCALIZATION, &self.localization)?,
        ];
        mapper.restore(learned[0]).map_err(|_| misfit(MAPPER))?;
        localization.restore(learned[1]).map_err(|_| misfit(LOCALIZATION))
    }
}

/// A copy of what was learned. A thread can turn it into bytes while the robot goes on.
#[derive(Clone, Debug)]
pub struct LearnedSnapshot {
    facts: LearnedFacts,
    mapper: Mapper,
    localization: Vec<u8>,
}

impl LearnedSnapshot {
    /// Adds what was learned to a state.
    pub fn added_to(self, state: State) -> State {
        let Self { facts, mut mapper, localization } = self;
        state.with(MAPPER, facts.mapper, mapper.snapshot()).with(
            LOCALIZATION,
            facts.localization,
            localization,
        )
    }
}
