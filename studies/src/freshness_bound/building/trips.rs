use super::doors::Doors;
use super::plan::Prices;
use super::roads::{Roads, Toll};
use std::ops::Range;

/// All steps of the time.
pub(super) struct Clock {
    pub(super) cell: Vec<usize>,
    /// Whether a step is in active hours.
    pub(super) is_active: Vec<bool>,
}

/// The steps of a trip, with what the doors did.
#[derive(Clone, Copy)]
pub(super) struct Stretch<'a> {
    pub(super) cell: &'a [usize],
    pub(super) is_active: &'a [bool],
    pub(super) doors: &'a Doors,
    pub(super) first: usize,
}

impl Clock {
    pub(super) fn stretch<'a>(&'a self, steps: Range<usize>, doors: &'a Doors) -> Stretch<'a> {
        Stretch {
            first: steps.start,
            cell: &self.cell[steps.clone()],
            is_active: &self.is_active[steps],
            doors,
        }
    }
}

/// What limits a trip.
#[derive(Clone, Copy)]
pub(super) struct Rules {
    /// The price of a step outside the dock.
    pub(super) step_price: f64,
    /// The share of a price that is due in the cell after a look.
    pub(super) again: f64,
}

/// The trip that collects most.
pub(super) struct Trip {
    pub(super) collected: f64,
    /// The looks at each thing, those in the cell after a look as a share.
    pub(super) looks: Vec<Prices>,
    /// Steps outside the dock.
    pub(super) steps: usize,
}

/// When the dock was looked at before: states of a robot in addition to the viewpoints.
const STATES_OF_REST: usize = 2;

/// The trip from the dock that collects the most prices of looks, less those of steps.
pub(super) fn best_trip(
    roads: &Roads,
    prices: &[Prices],
    clock: Stretch<'_>,
    rules: Rules,
    with_looks: bool,
) -> Trip {
    let tolls = roads.tolls(prices);
    let mut search = Search::new(roads, &tolls, clock, rules, with_looks);
    for step in (0..clock.cell.len()).rev() {
        search.add(step);
    }
    // The robot begins rested.
    let collected = search.values[roads.from.len() + 1];
    let (looks, steps) = if with_looks { search.looks(prices.len()) } else { (Vec::new(), 0) };
    Trip { collected, looks, steps }
}

/// Shares of prices that are due on a road: of the door at the departure and at the arrival, and of what is seen before and after.
struct Due {
    departure: f64,
    door: f64,
    shared: f64,
}

/// What a robot does in a state: it takes a road, rests, or has ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Move {
    End,
    Rest,
    Road(u16),
}

/// A search backwards over the steps.
struct Search<'a> {
    roads: &'a Roads,
    tolls: &'a [Vec<Toll>],
    clock: Stretch<'a>,
    rules: Rules,
    /// What can be collected from a step on, in each state; steps follow each other.
    values: Vec<f64>,
    moves: Vec<Move>,
}

impl<'a> Search<'a> {
    fn new(
        roads: &'a Roads,
        tolls: &'a [Vec<Toll>],
        clock: Stretch<'a>,
        rules: Rules,
        with_looks: bool,
    ) -> Self {
        let states = roads.from.len() + STATES_OF_REST;
        let steps = clock.cell.len();
        let values = vec![0.0; (steps + 1) * states];
        let moves = vec![Move::End; if with_looks { (steps + 1) * states } else { 0 }];
        Self { roads, tolls, clock, rules, values, moves }
    }

    fn states(&self) -> usize {
        self.roads.from.len() + STATES_OF_REST
    }

    /// The viewpoint of a state, and for how many cells the look there was longer ago than the step.
    fn place(&self, state: usize) -> (usize, usize) {
        match state.checked_sub(self.roads.from.len()) {
            None => (state, 0),
            Some(rest) => (self.roads.dock, rest + 1),
        }
    }

    /// The state after a step of rest.
    fn rested(&self, state: usize, step: usize) -> Option<usize> {
        let (viewpoint, ago) = self.place(state);
        if viewpoint != self.roads.dock {
            return None;
        }
        let cells = self.clock.cell.get(step + 1).map_or(0, |next| next - self.clock.cell[step]);
        let ago = (ago + cells).min(STATES_OF_REST);
        Some(if ago == 0 { self.roads.dock } else { self.roads.from.len() + ago - 1 })
    }

    fn due(&self, toll: &Toll, step: usize, ago: usize) -> Due {
        let cells = self.clock.cell[step + toll.steps] - self.clock.cell[step];
        let due = |cells: usize| [0.0, self.rules.again].get(cells).copied().unwrap_or(1.0);
        Due {
            departure: if toll.is_door_new { 1.0 } else { due(ago) },
            door: due(cells),
            // Inside a room a look in every cell may be needed.
            shared: if toll.is_inside && cells > 1 {
                (cells as f64 * self.rules.again).max(1.0)
            } else {
                due(cells + ago)
            },
        }
    }

    /// What is collected on a road, less its cost; `None` if it ends too late for a look.
    fn collected(&self, toll: &Toll, step: usize, ago: usize) -> Option<f64> {
        let end = step + toll.steps;
        if end >= self.clock.cell.len() {
            return None;
        }
        let doors = &self.clock.doors.is_closed;
        if toll.door_thing.is_some_and(|door| doors[door][self.clock.first + step] != toll.is_closed) {
            return None;
        }
        let due = self.due(toll, step, ago);
        let [before, after] = [step, end].map(|step| usize::from(self.clock.is_active[step]));
        Some(
            due.departure * toll.departure[before]
                + toll.new[after]
                + due.shared * toll.shared[after]
                + due.door * toll.door[after]
                - toll.steps as f64 * self.rules.step_price,
        )
    }

    fn add(&mut self, step: usize) {
        let states = self.states();
        for state in 0..states {
            let (viewpoint, ago) = self.place(state);
            let mut best = (0.0, Move::End);
            if let Some(rested) = self.rested(state, step) {
                let value = self.values[(step + 1) * states + rested];
                if value > best.0 {
                    best = (value, Move::Rest);
                }
            }
            for (index, toll) in self.tolls[viewpoint].iter().enumerate() {
                let Some(collected) = self.collected(toll, step, ago) else { continue };
                let value = collected + self.values[(step + toll.steps) * states + toll.to];
                if value > best.0 {
                    best = (value, Move::Road(index as u16));
                }
            }
            self.values[step * states + state] = best.0;
            if let Some(place) = self.moves.get_mut(step * states + state) {
                *place = best.1;
            }
        }
    }

    /// The looks of the best trip.
    fn looks(&self, things: usize) -> (Vec<Prices>, usize) {
        let mut looks = vec![[0.0; 2]; things];
        let mut outside = 0;
        let (mut step, mut state) = (0, self.roads.from.len() + 1);
        while step < self.clock.cell.len() {
            let (viewpoint, ago) = self.place(state);
            match self.moves[step * self.states() + state] {
                Move::End => break,
                Move::Rest => {
                    state = self.rested(state, step).unwrap_or(state);
                    step += 1;
                }
                Move::Road(index) => {
                    let road = &self.roads.from[viewpoint][usize::from(index)];
                    let toll = &self.tolls[viewpoint][usize::from(index)];
                    let due = self.due(toll, step, ago);
                    let [before, after] =
                        [step, step + road.steps].map(|step| usize::from(self.clock.is_active[step]));
                    road.new.iter().for_each(|thing| looks[*thing][after] += 1.0);
                    road.shared.iter().for_each(|thing| looks[*thing][after] += due.shared);
                    if let Some(door) = road.door {
                        looks[door][before] += due.departure;
                        looks[door][after] += if road.door_is_seen_after { due.door } else { 0.0 };
                    }
                    outside += road.steps;
                    step += road.steps;
                    state = road.to;
                }
            }
        }
        (looks, outside)
    }
}
