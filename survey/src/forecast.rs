//! A place as it will be: P(blocked) at any time, from what was learned.

use crate::masks::{keepout_mask, speed_mask};
use crate::outlook::Outlook;
use crate::places::{Place, places};
use crate::survey::SavedSurvey;
use interfaces::{CellState, Grid};
use mapper::{Calendar, Door, Mapper};
use nalgebra::Point2;
use robot::state::{State, StateError};

/// What changes is at most this far from a point that means it, m.
pub const NEAR_M: f64 = 0.5;

/// What was learned about a place, and what follows from it for other times. Times are in seconds since 1970-01-01 UTC if the
/// place [has dates](Self::why_undated), otherwise since the first reading.
#[derive(Clone, Debug)]
pub struct Forecast {
    mapper: Mapper,
    places: Vec<Place>,
    why_undated: Option<String>,
}

impl Forecast {
    /// The place in a state.
    ///
    /// # Errors
    ///
    /// When nothing was learned yet, and when the state does not fit this program.
    pub fn of_state(state: &State) -> Result<Self, StateError> {
        let SavedSurvey { changes, book, logs, .. } = SavedSurvey::of(state)?;
        let mapper = state.map.as_ref().ok_or(StateError::NothingLearned)?.mapper()?;
        let undated = logs.iter().map(|log| &log.entry).find(|entry| !entry.is_dated());
        let why_undated = undated.map(|log| format!("{} does not say when it was recorded", log.name));
        Ok(Self { places: places(&mapper, &changes, &book), mapper, why_undated })
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

    /// The places where something changes, with the numbers and the names that they have in the report of `map_log`.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The door at a point: its closed leaf is at most half a meter away, m.
    pub fn door_at(&self, point: Point2<f64>) -> Option<&Door> {
        let far_m = |door: &&Door| door.closed.distance_m(&point);
        let near = self.mapper.doors().iter().filter(|door| far_m(door) <= NEAR_M);
        near.min_by(|a, b| far_m(a).total_cmp(&far_m(b)))
    }

    /// The time of the last reading, s.
    pub fn now_s(&self) -> f64 {
        self.outlook().now_s()
    }

    /// The map and its calendar.
    pub fn outlook(&self) -> Outlook<'_> {
        Outlook { mapper: &self.mapper, calendar: self.calendar() }
    }

    /// The map at a time, s: P(blocked) of every cell; NaN for a cell that was never seen.
    pub fn map(&self, time_s: f64) -> Grid<f64> {
        let frame = *self.mapper.frame();
        let mut grid = Grid::filled(frame, f64::NAN);
        for (index, _) in self.mapper.states().cells().other_than(CellState::Unknown) {
            if let Some(blocked) = self.outlook().blocked(frame.cell(index), time_s) {
                grid.cells_mut()[index] = blocked;
            }
        }
        grid
    }

    /// The speed mask and the keepout mask at a time, s: cells are kept out of that are probably blocked then, and the robot slows
    /// down where changes are usual then.
    pub fn masks(&self, time_s: f64) -> [Grid<u8>; 2] {
        let pace = self.outlook().by_tile(1.0, |clock| clock.pace(time_s, self.calendar()));
        let blocked =
            |index: usize| self.outlook().blocked(self.mapper.frame().cell(index), time_s).unwrap_or(0.0);
        [speed_mask(&self.mapper, |index| pace.cells()[index]), keepout_mask(&self.mapper, blocked)]
    }
}
