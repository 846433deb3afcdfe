use super::{Pick, Stay, Strategy};
use crate::settings::AgentSettings;
use crate::situation::Situation;
use crate::visibility::ViewHistory;
use interfaces::{Cell, CellState};

/// The stop at a goal, in the unit of the readings' times. It is part of the time of a visit.
const WATCH: f64 = 8.0;

/// The number of events assumed for a cell that never changed: a half, as in the Jeffreys posterior of a
/// Poisson rate.
const UNSEEN_EVENTS: f64 = 0.5;

/// Goes where the next visit is due. Every cell has its own best interval between visits, by its rates of
/// change; a visit is worth how far the cells in view are beyond that interval, per time to get there.
///
/// A cell that leaves its state at rate α and returns at rate β, and was last seen a time t ago, is worth
/// U = π [(1 − e^(−st)) / s − t e^(−st)] with s = α + β and π = α / s, the share of time in the other state.
/// That is the marginal value by which optimal schedules revisit changing web pages (Cho and Garcia-Molina
/// 2003; Azar et al. 2018), here for a page that changes back: the share of time in which the map is wrong
/// grows by U with a little more time between visits.
///
/// The rate of a cell that never changed is not known. Such a cell is worth as much as a cell with half an
/// event in the time for which it was observed, times the share of cells that ever changed. Without this the
/// robot would stay with the first moving thing. An unknown cell is certainly wrong, and worth t.
#[derive(Clone, Debug)]
pub struct OptimalRevisiting {
    history: ViewHistory,
}

impl OptimalRevisiting {
    /// For a robot that sees as far as `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self { history: ViewHistory::new(settings.sensor_radius_m) }
    }
}

/// U of a cell with the rates at which it leaves and returns to the state in which it was last seen, `elapsed`
/// ago.
fn worth(leave: f64, back: f64, elapsed: f64) -> f64 {
    let sum = leave + back;
    let x = sum * elapsed;
    // 1 − e^(−x) − x e^(−x); the first terms of its series where these would cancel.
    let curve = if x < 1e-4 { x * x * (0.5 - x / 3.0) } else { -libm::expm1(-x) - x * libm::exp(-x) };
    leave / sum * (curve / sum)
}

impl Strategy for OptimalRevisiting {
    fn name(&self) -> &'static str {
        "optimal-revisiting"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let mapper = situation.mapper;
        let regions = self.history.update(mapper);
        let candidates = || (0..weights.len()).filter(|&cell| mapper.is_candidate(cell));
        let states = mapper.states().cells();
        let known = candidates().filter(|&cell| states[cell] != CellState::Unknown).count();
        let share = (mapper.changed().count() as f64 + UNSEEN_EVENTS) / (known as f64 + 1.0);
        let mut due = vec![0.0; regions.count()];
        for cell in candidates() {
            let elapsed = self.history.elapsed(mapper, cell);
            due[regions.of(cell)] += match (states[cell], mapper.transition_rates(cell)) {
                (CellState::Unknown, _) => elapsed,
                (CellState::Free, Some((block, free))) => worth(block, free, elapsed),
                (CellState::Blocked, Some((block, free))) => worth(free, block, elapsed),
                (_, None) => {
                    let seen = mapper.statistics(cell);
                    let rate = UNSEEN_EVENTS / (seen.watched_free + seen.watched_blocked + 1.0);
                    let probability = if seen.events() > 0 { 1.0 } else { share.min(1.0) };
                    probability * worth(rate, rate, elapsed)
                }
            };
        }
        self.history.weigh(situation, &regions, &due, WATCH, weights);
    }

    fn pick(&self) -> Pick {
        Pick::Best
    }

    fn stay(&mut self, goal: Cell) -> Stay {
        self.history.go_to(goal);
        Stay::Watch(WATCH)
    }
}
