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
/// Absent in state files with an older format.
const FILTER: &str = "filter";
/// The time at which readings have the time 0, in seconds since 1970-01-01 UTC. Absent where readings have no dates, and in
/// state files that were written before dates were saved.
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

    /// Lets a robot that was made with the settings of these facts go on with what was learned. Returns a note for the user if
    /// the state file has an older format, whose localizer is not read.
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
        let note = robot.restore_localization(learned[1], state.is_earlier());
        let note = note.map_err(|_| misfit(LOCALIZATION))?;
        // Absent from states of programs that did not save it.
        if let (Some(filter), Ok(learned)) = (robot.filter_mut(), state.section(FILTER, &self.filter)) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Localization, NoPilot};
    use interfaces::{Scan, Twist};
    use localizer::{Localizer, LoopClosingLocalizer, PoseState};
    use nalgebra::Isometry2;

    /// A scan in a square room of 4 m, or where nothing is near.
    fn reading(time_s: f64, is_in_room: bool) -> LaserReading {
        let angle_increment_rad = std::f64::consts::TAU / 360.0;
        let range = |beam: u32| {
            let (sin, cos) = (f64::from(beam) * angle_increment_rad).sin_cos();
            if is_in_room { (2.0 / sin.abs().max(cos.abs())) as f32 } else { f32::NAN }
        };
        let ranges_m = (0..360).map(range).collect();
        let (range_min_m, range_max_m) = (0.1, 5.0);
        let scan = Scan { angle_increment_rad, range_min_m, range_max_m, ranges_m, ..Scan::default() };
        let (pose, twist, mount) = (Isometry2::identity(), Twist::STOP, Isometry2::identity());
        LaserReading { time_s, pose, twist, velocities: Vec::new(), mount, scan }
    }

    fn robots() -> [Robot<LaserReading, NoPilot>; 2] {
        let frame = GridFrame::new(Point2::new(-4.0, -4.0), 0.05, 160, 160).unwrap();
        let settings = LocalizerSettings::default();
        let plain = Localizer::from_nothing(&settings, &frame, Isometry2::identity()).unwrap();
        let looping = LoopClosingLocalizer::from_nothing(&settings, &frame, Isometry2::identity()).unwrap();
        let robot = |localization: Box<dyn Localization<LaserReading> + Send + Sync>| {
            Robot::new(localization, Mapper::new(&MapperSettings::default(), frame).unwrap(), NoPilot)
        };
        [robot(Box::new(plain)), robot(Box::new(looping))]
    }

    #[test]
    fn the_note_of_an_earlier_state_is_what_the_robot_does() {
        for saw_a_room in [false, true] {
            for (mut robot, mut next) in robots().into_iter().zip(robots()) {
                let facts = LearnedFacts::new(&MapperSettings::default(), robot.mapper.frame(), "", None);
                for scan in 0..30 {
                    robot.step(reading(0.1 * f64::from(scan), saw_a_room)).unwrap();
                }
                let state = facts.snapshot(&mut robot).added_to(State::default()).of_earlier_version();
                let note = facts.restore(&state, &mut next).unwrap().unwrap();
                assert_eq!(note.contains("searches for its pose"), saw_a_room, "{note}");
                assert_eq!(note.contains("begins at a known pose"), !saw_a_room, "{note}");
                let belief = next.step(reading(3.0, true)).unwrap().belief;
                let is_lost = belief.state() == PoseState::Lost;
                assert_eq!(is_lost, saw_a_room, "{belief:?}");
            }
        }
    }
}
