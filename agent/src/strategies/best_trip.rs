use super::{Pick, Stay, Strategy};
use crate::settings::AgentSettings;
use crate::situation::Situation;
use crate::travel::travel_past_obstacles;
use crate::trips::Trips;
use crate::unseen::{UnseenLook, UnseenSpace};
use interfaces::{Cell, Values, value};
use mapper::Mapper;
use std::fmt::Debug;

/// The duration of the look at a goal, in the time unit of the readings.
const LOOK: f64 = 1.0;
/// Before the first looks into unseen space, each is expected to show this area, m², which counts as this number of looks.
const SHOWN_M2: f64 = 8.0;
const SHOWN_LOOKS: f64 = 3.0;

/// The time since a cell, by its index, was last seen, or should have been seen.
pub type Elapsed<'a> = &'a dyn Fn(usize) -> f64;

/// What a look at a cell is worth.
pub trait Worth: Debug + Send {
    /// The name of the strategy in tables, files and recordings.
    fn name(&self) -> &'static str;

    /// Gives the worth of a look at each cell of the map that is worth one to `take`, by the index of the cell, in any unit: zero or
    /// more. Returns the worth of the first look at a cell that was never seen.
    fn of_looks(&self, mapper: &Mapper, elapsed: Elapsed, take: &mut dyn FnMut(usize, f64)) -> f64;
}

/// Goes where a trip is worth most per time: all that comes into view on the way and at the goal counts, each part of the map once. A
/// look into unseen space is worth what may be behind the frontier.
#[derive(Clone, Debug)]
pub struct BestTrip<W> {
    worth: W,
    trips: Trips,
    unseen: UnseenSpace,
    /// The look into unseen space that was weighed last.
    look: Option<UnseenLook>,
    shown: Shown,
}

/// What looks into unseen space showed.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Shown {
    looks: f64,
    cells: f64,
    /// The number of cells that were known at the last decision, and whether a look began there.
    known: usize,
    has_begun: bool,
}

impl Shown {
    /// Ends the present look. Returns the number of cells that the next one is expected to show.
    fn update(&mut self, mapper: &Mapper) -> f64 {
        let before = std::mem::replace(&mut self.known, mapper.seen().count());
        if std::mem::take(&mut self.has_begun) {
            self.looks += 1.0;
            self.cells += self.known.saturating_sub(before) as f64;
        }
        let cell_m2 = mapper.frame().resolution_m() * mapper.frame().resolution_m();
        (self.cells + SHOWN_LOOKS * SHOWN_M2 / cell_m2) / (self.looks + SHOWN_LOOKS)
    }
}

impl<W: Worth> BestTrip<W> {
    /// The strategy of a robot whose sensor has the range `settings.sensor_radius_m`.
    pub fn new(worth: W, settings: &AgentSettings) -> Self {
        let trips = Trips::new(settings.sensor_radius_m);
        let unseen = UnseenSpace::new(settings.patch_cells, settings.sensor_radius_m);
        Self { worth, trips, unseen, look: None, shown: Shown::default() }
    }
}

impl<W: Worth> Strategy for BestTrip<W> {
    fn name(&self) -> &'static str {
        self.worth.name()
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let travel = travel_past_obstacles(situation);
        let (mapper, situation) = (situation.mapper, &situation.with_travel(&travel));
        let regions = self.trips.update(mapper);
        let mut worth = vec![0.0; regions.count()];
        let elapsed = |cell: usize| self.trips.elapsed(mapper, cell);
        let first = self.worth.of_looks(mapper, &elapsed, &mut |cell, look| worth[regions.of(cell)] += look);
        self.trips.weigh(situation, &regions, &worth, LOOK, weights);
        self.look = if self.unseen.update(mapper) { self.unseen.look(situation) } else { None };
        let shown = self.shown.update(mapper);
        let Some(look) = self.look else { return };
        let Some(weight) = regions.index(look.from).map(|from| &mut weights[from]) else { return };
        let of_look = first * shown / look.time;
        self.look.take_if(|_| of_look < *weight);
        *weight = weight.max(of_look);
    }

    fn pick(&self) -> Pick {
        Pick::Best
    }

    fn stay(&mut self, goal: Cell) -> Stay {
        match self.look.take().filter(|look| look.from == goal) {
            Some(look) => {
                self.shown.has_begun = true;
                Stay::Watch(self.unseen.begin(look))
            }
            None => {
                self.trips.begin(goal);
                Stay::Watch(LOOK)
            }
        }
    }

    fn end(&mut self, situation: &Situation) {
        self.trips.end(situation);
        self.unseen.end(situation);
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        let mut values = self.trips.values(mapper);
        values.extend(self.unseen.values(mapper));
        values.push(value(&mut self.shown));
        values
    }
}
