use super::{Pick, Stay, Strategy};
use crate::settings::AgentSettings;
use crate::situation::Situation;
use crate::visibility::ViewHistory;
use interfaces::{Cell, CellState};

/// The stop at a goal, in the unit of the readings' times. It is part of the time of a visit: without it, the
/// next cell would always be worth more than the next room.
const WATCH: f64 = 1.0;

/// A cell that stayed unknown after this number of visits from which it should have been in view cannot be
/// seen. More than one: a map may need several sightings, and an obstacle may have been in the way.
const MAX_VISITS: u8 = 3;

/// Goes where most unknown cells come into view per time to get there (frontiers after Yamauchi 1997, their
/// worth after González-Baños and Latombe 2002).
///
/// When no cell is left to find, the robot goes to the cell that was not seen for longest, per time to get
/// there; the strategy therefore stays useful in an environment that changes.
#[derive(Clone, Debug)]
pub struct Frontier {
    history: ViewHistory,
}

impl Frontier {
    /// For a robot that sees as far as `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self { history: ViewHistory::new(settings.sensor_radius_m) }
    }
}

impl Strategy for Frontier {
    fn name(&self) -> &'static str {
        "frontier"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let mapper = situation.mapper;
        let regions = self.history.update(mapper);
        let is_unknown = |cell: usize| mapper.states().cells()[cell] == CellState::Unknown;
        let mut hidden = vec![0.0; regions.count()];
        for cell in 0..weights.len() {
            if is_unknown(cell) && self.history.visits(cell) < MAX_VISITS {
                hidden[regions.of(cell)] += 1.0;
            }
        }
        self.history.weigh(situation, &regions, &hidden, WATCH, weights);
        // The cells left to find may be unreachable.
        if weights.iter().all(|&weight| weight == 0.0) {
            for (cell, weight) in weights.iter_mut().enumerate().filter(|(cell, _)| !is_unknown(*cell)) {
                *weight = mapper.recency(cell) / (situation.travel_to(cell) + WATCH);
            }
        }
    }

    fn pick(&self) -> Pick {
        Pick::Best
    }

    fn stay(&mut self, goal: Cell) -> Stay {
        self.history.go_to(goal);
        Stay::Watch(WATCH)
    }
}
