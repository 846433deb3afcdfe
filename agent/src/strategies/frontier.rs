use super::{Pick, Stay, Strategy};
use crate::settings::AgentSettings;
use crate::situation::Situation;
use crate::visibility::ViewHistory;
use interfaces::{Cell, CellState, Values};
use mapper::Mapper;

/// The duration of the stop at a goal, in the time unit of the readings. The stop is part of the time of a visit:
/// without it, the next cell would always be worth more than the next room.
const WATCH: f64 = 1.0;

/// The maximum number of visits for a cell that stays unknown although it should have been in view: after these
/// visits the cell counts as impossible to see. The number is above one: a map may need several observations, and
/// an obstacle may have been in between.
const MAX_VISITS: u8 = 3;

/// Goes to the cell from which most unknown cells come into view per time to get there (frontiers: Yamauchi 1997;
/// the value of a goal: González-Baños and Latombe 2002).
///
/// When no unknown cell is left that can be seen, the robot goes to the cell with the longest time since it was
/// last seen, per time to get there. The strategy therefore also works in an environment that changes.
#[derive(Clone, Debug)]
pub struct Frontier {
    history: ViewHistory,
}

impl Frontier {
    /// The strategy of a robot whose sensor has the range `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self { history: ViewHistory::new(settings.sensor_radius_m) }
    }
}

impl Strategy for Frontier {
    fn name(&self) -> &'static str {
        "frontier"
    }

    fn decline(&mut self) {
        self.history.decline();
    }

    fn end(&mut self, situation: &Situation) {
        self.history.end(situation);
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        self.history.values(mapper)
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
        // The cells that are still unknown may be unreachable.
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
