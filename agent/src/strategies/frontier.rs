use crate::view::{Outlook, Places};
use crate::{Pick, Situation, Stay, Strategy};
use geometry::{Cell, CellState, GridFrame};
use mapper::Mapper;

/// What looking around costs beside the way there, in the unit of the readings' times: without it,
/// the next cell would always be worth more than the next room.
const LOOK: f64 = 1.0;

/// A cell that stayed unknown in so many visits of places that should show it cannot be seen. More
/// than one: a map may believe only several sightings, and something may have stood in the way.
const MAX_MISSES: u8 = 3;

/// Go where most of what is unknown comes into view per time to get there (frontiers after Yamauchi
/// 1997, their worth after González-Baños and Latombe 2002).
///
/// When nothing is left to find, go where nobody looked for longest, per time to get there: so it
/// stays of use in a place that changes.
#[derive(Clone, Debug)]
pub struct Frontier {
    outlook: Outlook,
    /// In how many visits each cell should have come into view and stayed unknown.
    misses: Vec<u8>,
    frame: Option<GridFrame>,
    /// The number of the last goal's cell, until it is judged.
    goal: Option<usize>,
}

impl Frontier {
    /// For a robot that sees as far as `sensor_radius_m`, m.
    pub fn new(sensor_radius_m: f64) -> Self {
        Self { outlook: Outlook::new(sensor_radius_m), misses: Vec::new(), frame: None, goal: None }
    }

    /// Whether a cell is unknown, and not for good.
    fn is_to_find(&self, mapper: &Mapper, cell: usize) -> bool {
        mapper.states().cells()[cell] == CellState::Unknown && self.misses[cell] < MAX_MISSES
    }

    /// Counts what should have been seen from the last goal and is still unknown.
    fn look_back(&mut self, mapper: &Mapper, places: &Places) {
        let frame = *mapper.frame();
        if self.frame != Some(frame) {
            self.frame = Some(frame);
            self.misses = vec![0; frame.len()];
            self.goal = None;
        }
        let Some(goal) = self.goal.take() else { return };
        for &place in self.outlook.from(places.of(goal)) {
            for cell in places.cells(place as usize) {
                if mapper.states().cells()[cell] == CellState::Unknown {
                    self.misses[cell] = self.misses[cell].saturating_add(1);
                }
            }
        }
    }
}

impl Strategy for Frontier {
    fn name(&self) -> &'static str {
        "frontier"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let mapper = situation.mapper;
        let places = self.outlook.follow(mapper);
        self.look_back(mapper, &places);
        let mut unknown = vec![0u32; places.count()];
        for cell in (0..weights.len()).filter(|&cell| self.is_to_find(mapper, cell)) {
            unknown[places.of(cell)] += 1;
        }
        let is_left = unknown.iter().any(|&cells| cells > 0);
        for place in (0..places.count()).filter(|_| is_left) {
            let mut in_view = None;
            for cell in places.cells(place).filter(|&cell| mapper.is_candidate(cell)) {
                let outlook = &mut self.outlook;
                let in_view = *in_view.get_or_insert_with(|| {
                    outlook.from(place).iter().map(|&seen| unknown[seen as usize]).sum::<u32>()
                });
                weights[cell] = f64::from(in_view) / (situation.travel_to(cell) + LOOK);
            }
        }
        // What is left to find may lie where no way leads.
        if weights.iter().all(|&weight| weight == 0.0) {
            for (cell, weight) in weights.iter_mut().enumerate() {
                if mapper.states().cells()[cell] != CellState::Unknown {
                    *weight = mapper.recency(cell) / (situation.travel_to(cell) + LOOK);
                }
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
        self.goal = self.frame.and_then(|frame| frame.index(goal));
        Stay::Watch(LOOK)
    }
}
