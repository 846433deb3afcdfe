//! The share of a view that is really seen.

use crate::visibility::{Regions, Visibility};
use interfaces::Cell;
use mapper::Mapper;

/// The pseudo-observation of a complete view, in the time unit of the readings.
const TRUST: f64 = 10.0;

/// A visit: the index of the cell of the goal, the planned duration, and for each region in view the time that it had
/// been observed before.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
struct Visit {
    goal: usize,
    duration: f64,
    watched: Vec<f64>,
}

/// For each region, the observations from there: for each region in view, the time for which it should have been
/// seen, and the time for which it was seen. Without this record the robot could stay forever at a place from which
/// it cannot see the cells that it came for, for example behind an obstacle that waits for the robot itself.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct ViewReliability {
    observations: Vec<Vec<[f32; 2]>>,
    visit: Option<Visit>,
}

/// The time that a region has been in view: the mean over its cells.
pub(super) fn watched(mapper: &Mapper, regions: &Regions, region: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for cell in regions.cells(region) {
        let seen = mapper.statistics(cell);
        sum += seen.watched_free + seen.watched_blocked;
        count += 1.0;
    }
    sum / count
}

impl ViewReliability {
    /// Begins the visit of a goal, the index of a cell from which the regions in `view` can be seen. `watched` is the time that each
    /// region was observed before.
    pub(super) fn begin(
        &mut self,
        view: impl Iterator<Item = usize>,
        watched: &[f64],
        goal: usize,
        duration: f64,
    ) {
        let watched = view.map(|seen| watched[seen]).collect();
        self.visit = Some(Visit { goal, duration, watched });
    }

    /// Ends the last visit. If the robot did not reach the goal, nothing was seen from its region; if it `was_called_away` before, that
    /// says nothing of the view from there.
    pub(super) fn end(
        &mut self,
        mapper: &Mapper,
        visibility: &mut Visibility,
        regions: &Regions,
        robot: Cell,
        was_called_away: bool,
    ) {
        if self.observations.len() != regions.count() {
            self.observations = vec![Vec::new(); regions.count()];
            self.visit = None;
        }
        let Some(Visit { goal, duration, watched: before }) = self.visit.take() else { return };
        let region = regions.of(goal);
        let view: Vec<usize> = visibility.seen_from(region).collect();
        // The nearest cell of a region is at its border, and the robot stops shortly before its goal: in a fine grid, it
        // mostly stops in another region, with the same view.
        let is_there = regions.are_near(robot, mapper.frame().cell(goal));
        // If a wall appeared or disappeared since then, the view is another one.
        if before.len() != view.len() || was_called_away && !is_there {
            return;
        }
        let observations = &mut self.observations[region];
        if observations.len() != view.len() {
            *observations = vec![[0.0; 2]; view.len()];
        }
        for ((observation, before), seen) in observations.iter_mut().zip(before).zip(view) {
            observation[0] += duration as f32;
            if is_there {
                observation[1] += (watched(mapper, regions, seen) - before).clamp(0.0, duration) as f32;
            }
        }
    }

    /// For each region of the view, in order, the share of the time for which it is seen from a region; the view has `seen` regions.
    /// `None` for a region that was never visited: then the whole view counts as seen.
    pub(super) fn share(&self, region: usize, seen: usize) -> Option<impl Iterator<Item = f64>> {
        let observations = &self.observations[region];
        let share = |[due, seen]: &[f32; 2]| (f64::from(*seen) + TRUST) / (f64::from(*due) + TRUST);
        (observations.len() == seen && !observations.is_empty()).then(|| observations.iter().map(share))
    }
}
