//! A place as it will be: P(blocked) at any time, from what was learned.

use crate::settings::SurveySettings;
use crate::survey::{SavedLogs, SavedSurvey, Survey};
use interfaces::{Cell, CellState, Grid};
use mapper::Mapper;
use nalgebra::{Point2, Vector2};
use robot::state::{Facts, State, StateError, saved_mapper};

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
        let mut grid = Grid::filled(*self.mapper.frame(), f64::NAN);
        let changed: Vec<usize> = self.mapper.changed().collect();
        for tile in self.mapper.tiles() {
            let expiry_s = tile.clock().expiry_s(self.mapper.calendar()).unwrap_or(f64::NAN);
            tile.changed().for_each(|cell| grid.cells_mut()[changed[cell]] = expiry_s);
        }
        grid
    }

    /// The map at a time, s: P(blocked) of every cell; NaN for a cell that was never seen.
    pub fn map(&self, time_s: f64) -> Grid<f64> {
        let frame = *self.mapper.frame();
        let mut grid = Grid::filled(frame, f64::NAN);
        for (index, value) in grid.cells_mut().iter_mut().enumerate() {
            *value = self.blocked(frame.cell(index), time_s).unwrap_or(f64::NAN);
        }
        grid
    }

    /// The probability that a body with this radius, m, is stopped on its straight way between two points, m: that of the cell on
    /// its way that is most probably blocked, if it is there at this time, s. `None` if no cell of the way was ever seen.
    pub fn stopped(
        &self,
        [from, to]: [Point2<f64>; 2],
        radius_m: f64,
        time_s: impl Fn(f64) -> f64,
    ) -> Option<f64> {
        let (frame, way) = (self.mapper.frame(), to - from);
        let (cell_m, length_m) = (frame.resolution_m(), way.norm());
        let (steps, reach) = ((length_m / cell_m).ceil().max(1.0), (radius_m / cell_m).round() as i32);
        let mut largest: Option<f64> = None;
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            let (at, time_s) = (from + way * share, time_s(share * length_m));
            for offset in (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| Vector2::new(x, y))) {
                if offset.dot(&offset) <= reach * reach {
                    let Cell { x, y } = frame.cell_at(&at);
                    let found = self.blocked(Cell::new(x + offset.x, y + offset.y), time_s);
                    largest = largest.into_iter().chain(found).reduce(f64::max);
                }
            }
        }
        largest
    }
}
