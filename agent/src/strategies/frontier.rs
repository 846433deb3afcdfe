use crate::survey::Survey;
use crate::{AgentSettings, Pick, Situation, Stay, Strategy};
use interfaces::{Cell, CellState};

/// How long to look around at a goal, in the unit of the readings' times. It counts as part of the
/// way: without it, the next cell would always be worth more than the next room.
const WATCH: f64 = 1.0;

/// A cell that stayed unknown in so many visits of places that should show it cannot be seen. More
/// than one: a map may believe only several sightings, and something may have stood in the way.
const MAX_LOOKS: u8 = 3;

/// Go where most of what is unknown comes into view per time to get there (frontiers after Yamauchi
/// 1997, their worth after González-Baños and Latombe 2002).
///
/// When nothing is left to find, go where nobody looked for longest, per time to get there: so it
/// stays of use in a place that changes.
#[derive(Clone, Debug)]
pub struct Frontier {
    survey: Survey,
}

impl Frontier {
    /// For a robot that sees as far as `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self { survey: Survey::new(settings.sensor_radius_m) }
    }
}

impl Strategy for Frontier {
    fn name(&self) -> &'static str {
        "frontier"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let mapper = situation.mapper;
        let places = self.survey.follow(mapper);
        let is_unknown = |cell: usize| mapper.states().cells()[cell] == CellState::Unknown;
        let mut hidden = vec![0.0; places.count()];
        for cell in 0..weights.len() {
            if is_unknown(cell) && self.survey.looks(cell) < MAX_LOOKS {
                hidden[places.of(cell)] += 1.0;
            }
        }
        self.survey.weigh(situation, &places, &hidden, WATCH, weights);
        // What is left to find may lie where no way leads.
        if weights.iter().all(|&weight| weight == 0.0) {
            for (cell, weight) in weights.iter_mut().enumerate().filter(|(cell, _)| !is_unknown(*cell)) {
                *weight = mapper.recency(cell) / (situation.travel_to(cell) + WATCH);
            }
        }
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
