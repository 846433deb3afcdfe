use super::unchanged::UnchangedCells;
use super::{Pick, Stay, Strategy};
use crate::settings::AgentSettings;
use crate::situation::Situation;
use crate::visibility::ViewHistory;
use interfaces::{Cell, CellState, Values};
use mapper::Mapper;

/// The duration of the stop at a goal, in the time unit of the readings. The stop is part of the time of a visit.
const WATCH: f64 = 8.0;

/// Revisits every cell at the interval that is best for its rates of change.
///
/// Each cell has a best interval between visits. The longer the time since the last observation exceeds this
/// interval, the more the cell is worth. The value of a goal is the sum over the cells in view from there, per time
/// to get there.
///
/// A cell that leaves its state at rate α and returns at rate β, and was last seen a time t ago, is worth U = π [(1
/// − e^(−st)) / s − t e^(−st)] with s = α + β and π = α / s, the share of time in the other state. U is the
/// marginal value by which optimal schedules revisit changing web pages (Cho and Garcia-Molina 2003; Azar et al.
/// 2018), here for a page that changes back: if the time between visits becomes a little longer, the share of time
/// in which the map is wrong grows in proportion to U.
///
/// The rate of a cell that never changed is not known. Such a cell is worth as much as a cell with half an event in
/// its observation time, times the share of cells that ever changed. Without this term the robot would stay with
/// the first moving thing. The map is certainly wrong for an unknown cell; its value is t.
#[derive(Clone, Debug)]
pub struct OptimalRevisiting {
    history: ViewHistory,
}

impl OptimalRevisiting {
    /// The strategy of a robot whose sensor has the range `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self { history: ViewHistory::new(settings.sensor_radius_m) }
    }
}

/// U of a cell that was last seen a time `elapsed` ago. `leave` is the rate at which the cell leaves the state in
/// which it was last seen, `back` the rate at which it returns.
fn worth(leave: f64, back: f64, elapsed: f64) -> f64 {
    let sum = leave + back;
    let x = sum * elapsed;
    // 1 − e^(−x) − x e^(−x). For small x the terms cancel, and the beginning of the series is used.
    let curve = if x < 1e-4 { x * x * (0.5 - x / 3.0) } else { -libm::expm1(-x) - x * libm::exp(-x) };
    leave / sum * (curve / sum)
}

impl Strategy for OptimalRevisiting {
    fn name(&self) -> &'static str {
        "optimal-revisiting"
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
        let states = mapper.states().cells();
        let unchanged = UnchangedCells::of(mapper);
        let mut due = vec![0.0; regions.count()];
        for cell in (0..weights.len()).filter(|&cell| mapper.is_candidate(cell)) {
            let elapsed = self.history.elapsed(mapper, cell);
            due[regions.of(cell)] += match (states[cell], mapper.transition_rates(cell)) {
                (CellState::Unknown, _) => elapsed,
                (CellState::Free, Some((block, free))) => worth(block, free, elapsed),
                (CellState::Blocked, Some((block, free))) => worth(free, block, elapsed),
                (_, None) => {
                    let (probability, rate) = unchanged.rate(mapper, cell);
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
