use super::fixed_length::NextViewpoint;
use super::view::View;
use crate::building::Building;
use interfaces::RandomStream;

/// Goes round all viewpoints, always in the same order, and goes on where the last patrol ended. Rooms whose door was just
/// seen closed are skipped.
pub(super) struct Round {
    tour: Vec<usize>,
    next: usize,
}

impl Round {
    /// A short tour: nearest neighbors from the dock on, then improved by reversing parts while this makes it shorter (2-opt).
    pub(super) fn new(building: &Building) -> Self {
        let steps = &building.steps;
        let count = building.viewpoints.len();
        let mut tour = vec![building.dock];
        let mut left: Vec<usize> = (0..count).filter(|viewpoint| *viewpoint != building.dock).collect();
        while let Some(last) = tour.last().filter(|_| !left.is_empty()) {
            let nearest = (0..left.len()).min_by_key(|at| steps[*last][left[*at]]).unwrap_or(0);
            tour.push(left.remove(nearest));
        }
        let mut is_better = true;
        while is_better {
            is_better = false;
            for (begin, end) in (1..count).flat_map(|begin| (begin + 1..count).map(move |end| (begin, end))) {
                let [before, first, last, after] =
                    [tour[begin - 1], tour[begin], tour[end], tour[(end + 1) % count]];
                if steps[before][last] + steps[first][after] < steps[before][first] + steps[last][after] {
                    tour[begin..=end].reverse();
                    is_better = true;
                }
            }
        }
        Self { tour, next: 0 }
    }

    /// The length of the tour, steps.
    pub(super) fn steps(&self, building: &Building) -> usize {
        let next = self.tour.iter().cycle().skip(1);
        self.tour.iter().zip(next).map(|(from, to)| building.steps[*from][*to]).sum()
    }
}

impl NextViewpoint for Round {
    fn next(&mut self, view: &View<'_>, _: &mut RandomStream) -> Option<usize> {
        let count = self.tour.len();
        let open = (0..count).map(|skipped| (self.next + skipped) % count).find(|at| {
            let viewpoint = self.tour[*at];
            view.is_open(viewpoint) || !view.is_allowed(viewpoint)
        })?;
        let viewpoint = self.tour[open];
        let is_allowed = view.is_allowed(viewpoint);
        self.next = if is_allowed { (open + 1) % count } else { open };
        is_allowed.then_some(viewpoint)
    }
}
