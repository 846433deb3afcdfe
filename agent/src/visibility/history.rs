use super::{Regions, Visibility};
use crate::Situation;
use interfaces::{Cell, GridFrame, Values, runs, value};
use mapper::Mapper;

/// Visibility, and for each cell the last visit from which it should have been in view. For strategies that select a
/// goal by the number of cells that come into view.
///
/// The history is needed because an obstacle that hides a cell is not always on the map. Without the history the
/// robot would return again and again to see a cell that cannot be seen.
#[derive(Clone, Debug)]
pub(crate) struct ViewHistory {
    visibility: Visibility,
    frame: Option<GridFrame>,
    /// For each cell, the end of the last visit from which it should have been in view, whether or not it was seen.
    visited: Vec<f64>,
    /// The index of the cell of the last goal, until the visit is over.
    goal: Option<usize>,
}

impl ViewHistory {
    /// For a robot whose sensor has the range `radius_m`.
    pub(crate) fn new(radius_m: f64) -> Self {
        Self { visibility: Visibility::new(radius_m), frame: None, visited: Vec::new(), goal: None }
    }

    /// Applies the present map, and the finished visit of the last goal. Returns the regions of the map.
    pub(crate) fn update(&mut self, mapper: &Mapper) -> Regions {
        let regions = self.visibility.update(mapper);
        self.set_frame(*mapper.frame());
        self.end_visit(&regions, mapper.time());
        regions
    }

    /// Ends the visit of the last goal, where no other goal follows for a while. On the way to its goal, the robot has
    /// been called away: there was no visit.
    pub(crate) fn end(&mut self, situation: &Situation) {
        let mapper = situation.mapper;
        let regions = self.visibility.update(mapper);
        self.set_frame(*mapper.frame());
        let is_there = |goal: &usize| regions.are_near(situation.cell(), mapper.frame().cell(*goal));
        self.goal = self.goal.filter(is_there);
        self.end_visit(&regions, mapper.time());
    }

    fn end_visit(&mut self, regions: &Regions, time: f64) {
        let Some(goal) = self.goal.take() else { return };
        for &region in self.visibility.seen_from(regions.of(goal)) {
            for cell in regions.cells(region as usize) {
                self.visited[cell] = time;
            }
        }
    }

    fn set_frame(&mut self, frame: GridFrame) {
        if self.frame != Some(frame) {
            self.frame = Some(frame);
            self.visited = vec![0.0; frame.len()];
            self.goal = None;
        }
    }

    /// The visits so far, and the present one.
    pub(crate) fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        self.set_frame(*mapper.frame());
        vec![runs(&mut self.visited), value(&mut self.goal)]
    }

    /// Begins the visit of a goal.
    pub(crate) fn go_to(&mut self, goal: Cell) {
        self.goal = self.frame.and_then(|frame| frame.index(goal));
    }

    /// The time since the cell was last seen or should have been seen.
    #[inline]
    pub(crate) fn elapsed(&self, mapper: &Mapper, cell: usize) -> f64 {
        mapper.recency(cell).min(mapper.time() - self.visited[cell])
    }

    /// Writes the weight of each candidate: the sum of `worth` (one value per region) over the regions in view from
    /// there, divided by the time to get there and to stop for `watch`.
    pub(crate) fn weigh(
        &mut self,
        situation: &Situation,
        regions: &Regions,
        worth: &[f64],
        watch: f64,
        weights: &mut [f64],
    ) {
        for region in 0..regions.count() {
            let mut in_view = None; // Not computed for regions that the robot cannot enter.
            for cell in regions.cells(region) {
                let time = situation.travel_to(cell) + watch;
                if time < f64::INFINITY && situation.mapper.is_candidate(cell) {
                    let in_view = *in_view.get_or_insert_with(|| {
                        let seen = self.visibility.seen_from(region).iter();
                        seen.map(|&seen| worth[seen as usize]).sum::<f64>()
                    });
                    weights[cell] = in_view / time;
                }
            }
        }
    }
}
