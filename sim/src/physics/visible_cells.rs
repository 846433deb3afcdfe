//! The cells that the driven robot could see, wherever it drives.

use super::free_space::{FreePoses, solids};
use super::ground_truth::start;
use super::rays::{Beams, Scene};
use super::shape::{Rectangle, grid_corners};
use super::spec::WorldSpec;
use interfaces::{Cell, GridFrame, TrueState};
use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};
use std::f64::consts::{PI, TAU};

/// The number of directions in which a line of sight is searched.
const DIRECTIONS: usize = 360;
/// Most lines of sight end within this distance, m. Few walls are that near, so that these lines are searched first.
const NEAR_M: f64 = 1.0;
/// The number of points per side of a cell at which a line of sight is looked at.
const CELL_STEPS: u32 = 2;
/// The largest distance of a cell, in cells: more than any frame has.
const MAX_GAP: u32 = 1 << 24;
/// The distance of the points that see a blocked cell from its sides, as a share of the side.
const OUTSIDE: f64 = 1e-3;

impl WorldSpec {
    /// For every cell of the frame, whether the driven robot could see it from a pose in the [`FreeSpace`](super::FreeSpace) around
    /// its start, within the range of its main laser: with doors open, obstacles at their start, and other moving things
    /// away. Cells that are partly covered then are left out.
    ///
    /// Lines of sight are searched in 360 directions from each cell that no pose of the robot is beside, against the exact
    /// geometry.
    pub fn visible_cells(&self) -> Vec<bool> {
        self.visible_cells_among(not_enclosed)
    }

    /// See [`WorldSpec::visible_cells`]. Lines of sight are searched only from the cells in `candidates`, which receives
    /// the states of all cells and whether the robot can reach them.
    pub(crate) fn visible_cells_among(
        &self,
        candidates: impl Fn(&GridFrame, &[TrueState], &[bool]) -> Vec<bool>,
    ) -> Vec<bool> {
        let (frame, robot) = (&self.frame, self.driven());
        let (solids, mut reached) = (solids(self), vec![false; frame.len()]);
        let states = start::walls_cover(frame, &solids);
        for cell in FreePoses::reachable(self, self.driven_index()).iter().flat_map(FreePoses::cells) {
            reached[cell] = true;
        }
        let range_m = robot.laser.range_max_m;
        let sight = Sight::new(frame, &solids, range_m, robot.radius_m, &reached);
        let candidates = candidates(frame, &states, &reached);
        let is_visible = |index: usize| match states[index] {
            _ if reached[index] => true,
            TrueState::Free => candidates[index] && sight.reaches(frame.center(frame.cell(index))),
            TrueState::PartlyCovered => false,
            TrueState::Blocked => {
                let cell = frame.cell(index);
                let mut sides = frame.beside(index).filter(|side| candidates[*side]);
                sides.any(|side| sight.reaches(before(frame, cell, side)))
            }
        };
        (0..frame.len()).map(is_visible).collect()
    }
}

/// The cells that are not blocked and that others of this kind connect, by sides or corners, with a reached cell. Every
/// line of sight from another cell to a reached cell meets a blocked cell.
fn not_enclosed(frame: &GridFrame, states: &[TrueState], reached: &[bool]) -> Vec<bool> {
    let mut is_connected = reached.to_vec();
    let mut open: Vec<usize> = (0..frame.len()).filter(|index| reached[*index]).collect();
    while let Some(index) = open.pop() {
        for near in frame.cell(index).neighbours8().into_iter().filter_map(|cell| frame.index(cell)) {
            if states[near] != TrueState::Blocked && !is_connected[near] {
                is_connected[near] = true;
                open.push(near);
            }
        }
    }
    is_connected
}

/// The point just outside of a cell, before the middle of the side that it shares with the cell `side`.
fn before(frame: &GridFrame, cell: Cell, side: usize) -> Point2<f64> {
    let (center, other) = (frame.center(cell), frame.center(frame.cell(side)));
    center + (other - center) * (0.5 + OUTSIDE)
}

/// Lines of sight between points and poses that the robot can reach.
struct Sight<'a> {
    frame: &'a GridFrame,
    reached: &'a [bool],
    /// See [`gaps`].
    gaps: Vec<u32>,
    radius_m: f64,
    /// The ranges in which lines are searched, m, each with its beams.
    beams: [(f64, Beams); 2],
    scene: Scene,
}

impl<'a> Sight<'a> {
    fn new(
        frame: &'a GridFrame,
        solids: &[Rectangle],
        range_m: f64,
        radius_m: f64,
        reached: &'a [bool],
    ) -> Self {
        let scene = Scene::new(grid_corners(frame), solids, Vec::new(), 0, range_m);
        let beams = [NEAR_M.min(range_m), range_m]
            .map(|range_m| (range_m, Beams::new(-PI, TAU / DIRECTIONS as f64, DIRECTIONS, range_m)));
        Self { frame, reached, gaps: gaps(frame, reached), radius_m: radius_m.min(range_m), beams, scene }
    }

    /// Whether a straight line from a point to a reached cell meets nothing.
    fn reaches(&self, from: Point2<f64>) -> bool {
        let mut beams = self.beams.iter();
        self.is_near(from) || beams.any(|(range_m, beams)| self.finds_a_line(from, *range_m, beams))
    }

    /// Whether the robot's disc in a reached cell covers a point. Nothing is between the point and the center then. This
    /// is so for most points, and much faster than a search.
    fn is_near(&self, point: Point2<f64>) -> bool {
        let Self { frame, reached, radius_m, .. } = self;
        let (low, high) = (point - Vector2::repeat(*radius_m), point + Vector2::repeat(*radius_m));
        let (low, high) = (frame.cell_at(&low), frame.cell_at(&high));
        let mut cells = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| Cell::new(x, y)));
        cells.any(|cell| {
            let is_reached = frame.index(cell).is_some_and(|index| reached[index]);
            is_reached && nalgebra::distance(&frame.center(cell), &point) <= *radius_m
        })
    }

    fn finds_a_line(&self, from: Point2<f64>, range_m: f64, beams: &Beams) -> bool {
        let Self { frame, gaps, scene, .. } = self;
        let step_m = frame.resolution_m() / f64::from(CELL_STEPS);
        let meets_one = |((x, y), inverse): ((f64, f64), &f64)| {
            let (steps, mut step) = ((range_m.min(1.0 / inverse) / step_m) as u32, 0);
            while step < steps {
                let at = from + Vector2::new(x, y) * (f64::from(step) * step_m);
                match frame.index(frame.cell_at(&at)).map(|index| gaps[index]) {
                    None => return false,
                    Some(0) => return true,
                    // One step less than to the side of the nearest cell that may be one: rounding does not matter.
                    Some(gap) => step += (CELL_STEPS * (gap - 1)).saturating_sub(1).max(1),
                }
            }
            false
        };
        let laser = Isometry2::from_parts(from.into(), UnitComplex::identity());
        // No robot is left out: there is none.
        scene.cast(beams, &laser, usize::MAX, |inverse| beams.directions().zip(inverse).any(meets_one))
    }
}

/// The chessboard distance of each cell to the nearest reached one, in cells.
fn gaps(frame: &GridFrame, reached: &[bool]) -> Vec<u32> {
    let mut gaps: Vec<u32> = reached.iter().map(|reached| if *reached { 0 } else { MAX_GAP }).collect();
    let mut lower = |index: usize| {
        let near = frame.cell(index).neighbours8().into_iter().filter_map(|cell| frame.index(cell));
        let nearest = near.map(|near| gaps[near]).min().unwrap_or(MAX_GAP);
        gaps[index] = gaps[index].min(nearest + 1);
    };
    // Every shortest way to a cell comes down in one of the two orders.
    (0..frame.len()).for_each(&mut lower);
    (0..frame.len()).rev().for_each(&mut lower);
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn gaps_are_chessboard_distances(
            (width, height) in (1..12_usize, 1..12_usize),
            reached in prop::collection::vec(prop::bool::weighted(0.05), 144),
        ) {
            let frame = GridFrame::new(Point2::origin(), 0.1, width, height).unwrap();
            let reached = &reached[..frame.len()];
            for (index, gap) in gaps(&frame, reached).into_iter().enumerate() {
                let at = frame.cell(index);
                let apart = |other: usize| at.x.abs_diff(frame.cell(other).x).max(at.y.abs_diff(frame.cell(other).y));
                let nearest = (0..frame.len()).filter(|other| reached[*other]).map(apart).min();
                prop_assert!(nearest.is_none_or(|nearest| u64::from(gap) == u64::from(nearest)), "{index}: {gap}");
            }
        }
    }
}
