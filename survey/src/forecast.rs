//! A place as it will be: P(blocked) at any time, from what was learned.

use crate::masks::{keepout_mask, speed_mask};
use crate::settings::SurveySettings;
use crate::survey::{SavedLogs, SavedSurvey, Survey};
use interfaces::{Cell, CellState, Grid};
use mapper::{Calendar, Clock, Door, Mapper, Segment, ThingKind};
use nalgebra::{Point2, Vector2};
use robot::state::{Facts, State, StateError, saved_mapper};

/// Cells whose centers are at most this far from the closed leaf of a door are blocked by it, in cells.
const LEAF: f64 = 2.0;

/// What changes is at most this far from a point that means it, m.
pub const NEAR_M: f64 = 0.5;

/// What was learned about a place, and what follows from it for other times. Times are in seconds since 1970-01-01 UTC if the
/// place [has dates](Self::why_undated), otherwise since the first reading.
#[derive(Clone, Debug)]
pub struct Forecast {
    mapper: Mapper,
    why_undated: Option<String>,
}

impl Forecast {
    /// The place in a state that `map_log` has written, or a robot.
    ///
    /// # Errors
    ///
    /// When the state holds neither, or was written by another program.
    pub fn of_state(state: &State) -> Result<Self, StateError> {
        let Some(facts) = state.facts(SavedSurvey::PART) else {
            let why = "it is of a robot that does not know the date".to_owned();
            return Ok(Self { mapper: saved_mapper(state)?, why_undated: Some(why) });
        };
        let misfit = || StateError::OtherContent(SavedSurvey::PART.to_owned());
        let logs =
            SavedLogs::read(state.section(SavedLogs::PART, &Facts::default())?).map_err(|_| misfit())?;
        let settings: SurveySettings = facts.settings("survey").ok_or_else(misfit)?;
        let has_zone = settings.mapper.time_zone.is_some();
        let learns_noise = facts.get("--noise") == Some("learned");
        let learned = state.section(SavedSurvey::PART, facts)?;
        let survey = Survey::restored(settings, learns_noise, logs, learned).map_err(|_| misfit())?;
        let undated = survey.undated(survey.logs().len());
        let why_undated = match undated {
            Some(log) => Some(format!("{} does not say when it was recorded", log.name)),
            None => (!has_zone).then(|| "its format is older than version 8, which has hours".to_owned()),
        };
        Ok(Self { mapper: survey.mapper().ok_or_else(misfit)?.clone(), why_undated })
    }

    /// The map.
    pub fn mapper(&self) -> &Mapper {
        &self.mapper
    }

    /// Why the place has no hours and no dates; `None` if it has.
    pub fn why_undated(&self) -> Option<&str> {
        self.why_undated.as_deref()
    }

    /// How its times relate to local civil time.
    pub fn calendar(&self) -> &Calendar {
        if self.why_undated.is_none() { self.mapper.calendar() } else { &Calendar::Relative }
    }

    /// The doors that were found, with their numbers, which they keep.
    pub fn doors(&self) -> impl Iterator<Item = (u32, &Door)> {
        doors(&self.mapper)
    }

    /// The door at a point: its closed leaf is at most half a meter away, m.
    pub fn door_at(&self, point: Point2<f64>) -> Option<(u32, &Door)> {
        let far_m = |(_, door): &(u32, &Door)| distance_m(&door.closed, point);
        let near = self.doors().filter(|door| far_m(door) <= NEAR_M);
        near.min_by(|a, b| far_m(a).total_cmp(&far_m(b)))
    }

    /// The time of the last reading, s.
    pub fn now_s(&self) -> f64 {
        self.mapper.epoch_s() + self.mapper.time()
    }

    /// The probability that a cell is blocked at a time, s; `None` for a cell that was never seen, and outside of the map. A time
    /// before the last reading counts as that of the last reading.
    pub fn blocked(&self, cell: Cell, time_s: f64) -> Option<f64> {
        let index = self.mapper.frame().index(cell)?;
        let is_known = self.mapper.states().cells()[index] != CellState::Unknown;
        let ahead_s = (time_s - self.now_s()).max(0.0);
        is_known.then(|| self.mapper.blocked_probability_later(index, ahead_s))
    }

    /// For how long a look at a cell says more than the usual hours, s; NaN where nothing ever changed, and where it is longer
    /// than four weeks.
    pub fn expiry(&self) -> Grid<f64> {
        self.by_tile(f64::NAN, |clock| clock.expiry_s(self.calendar()).unwrap_or(f64::NAN))
    }

    /// A value of each cell that ever changed, by the clock of its tile; of other cells, `other`.
    fn by_tile(&self, other: f64, value: impl Fn(&Clock) -> f64) -> Grid<f64> {
        let mut grid = Grid::filled(*self.mapper.frame(), other);
        let changed: Vec<usize> = self.mapper.changed().collect();
        for tile in self.mapper.tiles() {
            let value = value(tile.clock());
            tile.changed().for_each(|cell| grid.cells_mut()[changed[cell]] = value);
        }
        grid
    }

    /// The map at a time, s: P(blocked) of every cell; NaN for a cell that was never seen.
    pub fn map(&self, time_s: f64) -> Grid<f64> {
        let frame = *self.mapper.frame();
        let mut grid = Grid::filled(frame, f64::NAN);
        for (index, _) in self.mapper.states().cells().other_than(CellState::Unknown) {
            if let Some(blocked) = self.blocked(frame.cell(index), time_s) {
                grid.cells_mut()[index] = blocked;
            }
        }
        grid
    }

    /// The speed mask and the keepout mask at a time, s: cells are kept out of that are probably blocked then, and the robot slows
    /// down where changes are usual then.
    pub fn masks(&self, time_s: f64) -> [Grid<u8>; 2] {
        let pace = self.by_tile(1.0, |clock| clock.pace(time_s, self.calendar()));
        let blocked = |index: usize| self.blocked(self.mapper.frame().cell(index), time_s).unwrap_or(0.0);
        [speed_mask(&self.mapper, |index| pace.cells()[index]), keepout_mask(&self.mapper, blocked)]
    }

    /// The probability that a body with this radius, m, is stopped on its straight way between two points, m: that of the cell on
    /// its way that is most probably blocked, if it is there at this time, s. Doors are blocked when they are closed, as their own
    /// clocks say. `None` if no cell of the way was ever seen.
    pub fn stopped(
        &self,
        [from, to]: [Point2<f64>; 2],
        radius_m: f64,
        time_s: impl Fn(f64) -> f64,
    ) -> Option<f64> {
        let (frame, way) = (self.mapper.frame(), to - from);
        let (cell_m, length_m) = (frame.resolution_m(), way.norm());
        let (steps, reach) = ((length_m / cell_m).ceil().max(1.0), (radius_m / cell_m).round() as i32);
        let doors: Vec<&Door> =
            self.doors().map(|(_, door)| door).filter(|door| door.is_open.is_some()).collect();
        let mut largest: Option<f64> = None;
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            let (at, time_s) = (from + way * share, time_s(share * length_m));
            for offset in (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| Vector2::new(x, y))) {
                if offset.dot(&offset) <= reach * reach {
                    let Cell { x, y } = frame.cell_at(&at);
                    let cell = Cell::new(x + offset.x, y + offset.y);
                    let is_leaf =
                        |door: &&&Door| distance_m(&door.closed, frame.center(cell)) <= LEAF * cell_m;
                    let found = match doors.iter().find(is_leaf) {
                        Some(door) => Some(1.0 - door.clock.probability(time_s, self.calendar())),
                        None => self.blocked(cell, time_s),
                    };
                    largest = largest.into_iter().chain(found).reduce(f64::max);
                }
            }
        }
        largest
    }
}

/// The doors of a map, with their numbers.
pub fn doors(mapper: &Mapper) -> impl Iterator<Item = (u32, &Door)> {
    mapper.things().iter().filter_map(|thing| match &thing.kind {
        ThingKind::Door(door) => Some((thing.id, &**door)),
        ThingKind::Furniture(_) => None,
    })
}

/// The distance of a point from a segment, m.
fn distance_m(segment: &Segment, point: Point2<f64>) -> f64 {
    let [from, to] = segment.ends;
    let along = to - from;
    let share = (along.dot(&(point - from)) / along.norm_squared()).clamp(0.0, 1.0);
    (point - from - along * share).norm()
}
