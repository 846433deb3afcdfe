use crate::survey::Survey;
use crate::{AgentSettings, Pick, Situation, Stay, Strategy};
use interfaces::{Cell, CellState};

/// How long to stand at a goal, in the unit of the readings' times. Part of the price of a visit.
const WATCH: f64 = 8.0;

/// Events that a cell which never changed is believed to have had: half a one, as in the Jeffreys
/// posterior of a Poisson rate.
const UNSEEN_EVENTS: f64 = 0.5;

/// Go where the next look is due. Every cell has its own best interval between looks, by how fast it
/// changes; a visit is worth how far the cells in view are beyond it, per time to get there.
///
/// A cell that leaves its state at rate α and comes back at rate β, and was last seen a time t ago, is
/// worth U = π [(1 − e^(−st)) / s − t e^(−st)] with s = α + β and π = α / s, the share of time that it
/// spends in the other state. That is the marginal value by which optimal schedules revisit changing web
/// pages (Cho and Garcia-Molina 2003; Azar et al. 2018), here for a page that changes back: what a
/// little more time between looks adds to the share of time in which the map is wrong.
///
/// Of a cell that never changed, no rate is known. It is worth as much as one that changes half as
/// often as once in the time for which it was watched, times the share of cells that ever changed.
/// Without this the robot would stay with the first thing that moves. What is unknown is wrong for
/// certain, and worth t.
#[derive(Clone, Debug)]
pub struct OptimalRevisiting {
    survey: Survey,
}

impl OptimalRevisiting {
    /// For a robot that sees as far as `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self { survey: Survey::new(settings.sensor_radius_m) }
    }
}

/// U of a cell with the rates at which it leaves the state it was seen in and comes back, `elapsed` after
/// it was seen.
fn worth(leave: f64, back: f64, elapsed: f64) -> f64 {
    let sum = leave + back;
    let lost = sum * elapsed;
    // 1 − e^(−x) − x e^(−x); its first terms where these would cancel.
    let curve = if lost < 1e-4 {
        lost * lost * (0.5 - lost / 3.0)
    } else {
        -libm::expm1(-lost) - lost * libm::exp(-lost)
    };
    leave / sum * (curve / sum)
}

impl Strategy for OptimalRevisiting {
    fn name(&self) -> &'static str {
        "optimal-revisiting"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let mapper = situation.mapper;
        let places = self.survey.follow(mapper);
        let candidates = || (0..weights.len()).filter(|&cell| mapper.is_candidate(cell));
        let states = mapper.states().cells();
        let known = candidates().filter(|&cell| states[cell] != CellState::Unknown).count();
        let share = (mapper.changed().count() as f64 + UNSEEN_EVENTS) / (known as f64 + 1.0);
        let mut due = vec![0.0; places.count()];
        for cell in candidates() {
            let elapsed = self.survey.elapsed(mapper, cell);
            due[places.of(cell)] += match (states[cell], mapper.transition_rates(cell)) {
                (CellState::Unknown, _) => elapsed,
                (CellState::Free, Some((block, free))) => worth(block, free, elapsed),
                (CellState::Blocked, Some((block, free))) => worth(free, block, elapsed),
                (_, None) => {
                    let seen = mapper.statistics(cell);
                    let rate = UNSEEN_EVENTS / (seen.watched_free + seen.watched_blocked + 1.0);
                    let chance = if seen.events() > 0 { 1.0 } else { share.min(1.0) };
                    chance * worth(rate, rate, elapsed)
                }
            };
        }
        self.survey.weigh(situation, &places, &due, WATCH, weights);
    }

    fn pick(&self) -> Pick {
        Pick::Best
    }

    fn needs_travel(&self) -> bool {
        true
    }

    fn stay(&mut self, goal: Cell) -> Stay {
        self.survey.go_to(goal);
        Stay::Watch(WATCH)
    }
}
