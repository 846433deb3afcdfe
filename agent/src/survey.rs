use crate::Situation;
use crate::view::{Outlook, Places};
use interfaces::{Cell, GridFrame};
use mapper::Mapper;

/// For strategies that go where much comes into view: what is in view from where, and what should
/// have come into view from the goals so far.
///
/// The second is needed because what hides a cell now, or for good, need not be on the map: without it
/// the robot would go to see the same cells again and again, and never see them.
#[derive(Clone, Debug)]
pub(crate) struct Survey {
    outlook: Outlook,
    frame: Option<GridFrame>,
    looks: Vec<Look>,
    /// The number of the last goal's cell, until the visit is over.
    goal: Option<usize>,
}

/// The looks at a cell, whether it was seen or not.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    count: u8,
    /// When the last one was over.
    time: f64,
}

impl Survey {
    /// For a robot that sees as far as `radius_m`, m.
    pub(crate) fn new(radius_m: f64) -> Self {
        Self { outlook: Outlook::new(radius_m), frame: None, looks: Vec::new(), goal: None }
    }

    /// Takes the map in, and the visit of the last goal, which is over; gives the places that the map
    /// is cut into.
    pub(crate) fn follow(&mut self, mapper: &Mapper) -> Places {
        let (places, frame) = (self.outlook.follow(mapper), *mapper.frame());
        if self.frame != Some(frame) {
            self.frame = Some(frame);
            self.looks = vec![Look::default(); frame.len()];
            self.goal = None;
        }
        if let Some(goal) = self.goal.take() {
            for &place in self.outlook.seen_from(places.of(goal)) {
                for cell in places.cells(place as usize) {
                    let count = self.looks[cell].count.saturating_add(1);
                    self.looks[cell] = Look { count, time: mapper.time() };
                }
            }
        }
        places
    }

    /// The robot sets out for a goal.
    pub(crate) fn go_to(&mut self, goal: Cell) {
        self.goal = self.frame.and_then(|frame| frame.index(goal));
    }

    /// In how many visits the cell was looked at, up to 255.
    #[inline]
    pub(crate) fn looks(&self, cell: usize) -> u8 {
        self.looks[cell].count
    }

    /// The time since the cell was last seen, or last looked at in vain.
    #[inline]
    pub(crate) fn elapsed(&self, mapper: &Mapper, cell: usize) -> f64 {
        mapper.recency(cell).min(mapper.time() - self.looks[cell].time)
    }

    /// Weighs each candidate by what comes into view from there, per time to get there and stand there
    /// for `watch`; `worth` is what it is worth to see each place.
    pub(crate) fn weigh(
        &mut self,
        situation: &Situation,
        places: &Places,
        worth: &[f64],
        watch: f64,
        weights: &mut [f64],
    ) {
        for place in 0..places.count() {
            let mut in_view = None; // of the places where the robot cannot be, nobody asks
            for cell in places.cells(place) {
                let time = situation.travel_to(cell) + watch;
                if time < f64::INFINITY && situation.mapper.is_candidate(cell) {
                    let in_view = *in_view.get_or_insert_with(|| {
                        let seen = self.outlook.seen_from(place).iter();
                        seen.map(|&seen| worth[seen as usize]).sum::<f64>()
                    });
                    weights[cell] = in_view / time;
                }
            }
        }
    }
}
