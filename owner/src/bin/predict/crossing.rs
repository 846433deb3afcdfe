//! Where a route meets what comes and goes: wait, or go round?

use crate::place::called;
use crate::route;
use controller::{FREE, InflationSettings, Moves, Planner};
use interfaces::{Cell, CellState, Grid, GridFrame};
use nalgebra::{Point2, Vector2};
use owner::words::length_of;
use serde::Serialize;
use survey::{Forecast, Obstacle, Stop, Travel};

/// What is more probably in the way is no part of a detour.
const PROBABLY: f64 = 0.5;
/// A way round is searched within this distance along both axes, m.
const WINDOW_M: f64 = 20.0;
/// The number of points behind the obstacle at one of which it comes back to the route, and the distance between them, m. (A route can lead back to
/// where it was; that is no way round.)
const STEPS: u32 = 8;
const STEP_M: f64 = 0.5;
/// Less than this number of changes is few data.
const FEW_CHANGES: u32 = 4;

/// What a route meets.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Crossing {
    /// Where it is on the route, m.
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// The time of arrival there, s.
    pub(crate) time_s: f64,
    /// What it is, in words.
    pub(crate) title: String,
    /// The probability that it is in the way then.
    pub(crate) blocked: f64,
    pub(crate) advice: Advice,
}

/// Wait or go round.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Advice {
    /// How long to wait at most, s; infinite (`null` in JSON) without a limit, `None` if nothing is known of how long it stays.
    pub(crate) patience_s: Option<f64>,
    /// How much longer the way round takes, s; `None` without a known way round.
    pub(crate) detour_s: Option<f64>,
    /// The expected loss of time, s, averaged over the cases that it is in the way, and that it is not.
    pub(crate) loss_s: Option<f64>,
    /// The same in words.
    pub(crate) text: String,
}

/// A route, and its points.
pub(crate) struct Line<'a> {
    pub(crate) forecast: &'a Forecast,
    pub(crate) travel: Travel,
    pub(crate) points: &'a [route::Stop],
}

impl Line<'_> {
    /// The point at a distance, m.
    fn at(&self, way_m: f64) -> Point2<f64> {
        let next = self.points.partition_point(|point| point.way_m <= way_m);
        let next = next.clamp(1, self.points.len() - 1);
        let [from, to] = [&self.points[next - 1], &self.points[next]];
        let share = (way_m - from.way_m) / (to.way_m - from.way_m).max(1e-9);
        Point2::new(from.x_m + (to.x_m - from.x_m) * share, from.y_m + (to.y_m - from.y_m) * share)
    }

    /// What to do in front of what the route meets.
    pub(crate) fn crossing(&self, stop: &Stop) -> Crossing {
        let (mapper, [x_m, y_m]) = (self.forecast.mapper(), [stop.at.x, stop.at.y]);
        let index = mapper.frame().index(mapper.frame().cell_at(&stop.at)).unwrap_or(0);
        let place = self.forecast.places().iter().find(|place| place.cells.contains(&index));
        let what = match stop.obstacle {
            Obstacle::Wall => "a wall".to_owned(),
            Obstacle::Door(id) => format!("door {id}"),
            Obstacle::Cells => place.map_or("what comes and goes".to_owned(), called),
        };
        let title = format!("{what} at ({x_m:.2}, {y_m:.2}) m");
        let told = |text: &str| Advice { text: text.to_owned(), ..Advice::default() };
        let advice = match stop {
            Stop { obstacle: Obstacle::Wall, .. } => told("not passable"),
            _ if stop.ways_m[0] <= 0.0 && stop.blocked >= PROBABLY => told("the route starts inside it"),
            _ => {
                let door = mapper.doors().iter().find(|door| stop.obstacle == Obstacle::Door(door.id));
                let changes = door.map_or(mapper.evidence(index).changes(), |door| door.evidence().changes());
                self.advice(stop, changes)
            }
        };
        Crossing { x_m, y_m, time_s: stop.time_s, title, blocked: stop.blocked, advice }
    }

    /// How much longer than the route the way round an obstacle is, m, back to the route behind the obstacle; `None` if there is none in
    /// the window.
    fn detour_m(&self, stop: &Stop) -> Option<f64> {
        let (frame, outlook) = (self.forecast.mapper().frame(), self.forecast.outlook());
        let cell_m = frame.resolution_m();
        // A little before the place where the robot touches the obstacle.
        let way_m = (stop.ways_m[0] - 2.0 * cell_m).max(0.0);
        let from = self.at(way_m);
        let (low, side) = (frame.cell_at(&(from - Vector2::repeat(WINDOW_M))), 2.0 * WINDOW_M / cell_m);
        let corner = frame.center(low) - Vector2::repeat(0.5 * cell_m);
        let window = GridFrame::new(corner, cell_m, side as usize, side as usize)?;
        let is_free = |cell: Cell| {
            let at = window.center(cell);
            let (obstacle, blocked) = outlook.obstacle(frame.cell_at(&at), stop.time_s)?;
            let is_own = stop.is_same(&Stop { obstacle, at, ..*stop });
            Some(blocked < if is_own { PROBABLY * stop.blocked } else { PROBABLY })
        };
        let state = |index: usize| {
            let around = window.cell(index).neighbours4().into_iter();
            // What was never seen is no way, but a single cell that was missed by chance is.
            let is_missed = || around.filter(|cell| is_free(*cell) == Some(true)).count() >= 3;
            let is_way = is_free(window.cell(index)).unwrap_or_else(is_missed);
            if is_way { CellState::Free } else { CellState::Blocked }
        };
        let map = Grid::from_cells(window, (0..window.len()).map(state).collect())?;
        let settings = InflationSettings { footprint_padding_m: 0.0, inflation_m: 0.0, inflation_cost: FREE };
        let mut planner = Planner::new(&settings, self.travel.radius_m, Moves::Eight, &map);
        let mut lengths_m = vec![f64::INFINITY; window.len()];
        planner.lengths_m(&map, &from, &mut lengths_m);
        let (first_m, end_m) = (stop.ways_m[1] + cell_m, self.points.last()?.way_m);
        let more_m = (0..STEPS).filter_map(|step| {
            let reached_m = (first_m + STEP_M * f64::from(step)).min(end_m);
            let length_m = lengths_m[window.index(window.cell_at(&self.at(reached_m)))?];
            Some((length_m + way_m - reached_m).max(0.0))
        });
        more_m.reduce(f64::min).filter(|more_m| more_m.is_finite())
    }

    /// Waits for the way to be free, or goes round. `changes`: the number of those that were seen.
    fn advice(&self, stop: &Stop, changes: u32) -> Advice {
        let detour_s = self.detour_m(stop).map(|more_m| more_m / self.travel.speed_m_s);
        let (waiting, longer_s) = (self.forecast.outlook().waiting(stop), detour_s.unwrap_or(f64::INFINITY));
        let patience_s = waiting.as_ref().map(|waiting| waiting.patience_s(longer_s));
        let loss_s = waiting.map(|waiting| stop.blocked * waiting.best_s(longer_s));
        let none = || format!("no way round is known within {WINDOW_M:.0} m");
        let round =
            |go: &str| detour_s.map_or_else(none, |detour_s| format!("{go}: {} more", length_of(detour_s)));
        let advised = match patience_s {
            None => format!("not known how long it stays; {}", round("if it is blocked, go round")),
            Some(..1.0) => format!("do not wait, {}", round("go round")),
            Some(f64::INFINITY) => format!("wait until the way is free; {}", round("the way round")),
            Some(patience_s) => format!("wait at most {}, then {}", length_of(patience_s), round("go round")),
        };
        let loss = |s| format!(" (expected loss, averaged over blocked and free: {})", length_of(s));
        let few = if changes < FEW_CHANGES { "; few data" } else { "" };
        let text = format!("{advised}{}{few}", loss_s.map(loss).unwrap_or_default());
        Advice { patience_s, detour_s, loss_s, text }
    }
}
