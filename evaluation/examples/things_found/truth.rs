//! The true doors of a world.

use interfaces::GridFrame;
use mapper::{Mapper, Segment};
use nalgebra::{Point2, Vector2};
use sim::physics::{DoorSpec, Leaf, Motion, ObstacleSpec, WorldSpec};

/// A door, and what it has done.
pub(crate) struct TrueDoor {
    /// The index of the obstacle.
    pub(crate) index: usize,
    /// The corners of the closed leaf, m.
    closed: [Point2<f64>; 4],
    /// The end of the open leaf, m; `None` if it slides.
    pub(crate) open_end: Option<Point2<f64>>,
    /// The cells that the leaf sweeps.
    pub(crate) cells: Vec<usize>,
    is_open: Option<bool>,
    /// How often it was opened.
    pub(crate) openings: u32,
    /// How often it was opened or closed, and how often in view.
    pub(crate) motions: u32,
    pub(crate) motions_in_view: u32,
}

impl TrueDoor {
    /// All doors of a world.
    pub(crate) fn all(spec: &WorldSpec, frame: &GridFrame) -> Vec<Self> {
        let doors =
            spec.obstacles.iter().enumerate().filter_map(|(index, obstacle)| match &obstacle.motion {
                Motion::Door(door) => Some(Self::new(index, obstacle, door, frame)),
                _ => None,
            });
        doors.collect()
    }

    fn new(index: usize, obstacle: &ObstacleSpec, door: &DoorSpec, frame: &GridFrame) -> Self {
        /// Positions of a leaf at which its cells are listed: a leaf is 0.05 m thick and about 1 m long.
        const POSITIONS: usize = 60;
        let position = |step: usize| match door.leaf {
            Leaf::Hinged { .. } => door.shape(&obstacle.shape, step as f64 / POSITIONS as f64),
            Leaf::Sliding { .. } => obstacle.shape,
        };
        let mut cells: Vec<usize> =
            (0..=POSITIONS).flat_map(|step| on_axis(&position(step).corners(), frame)).collect();
        cells.sort_unstable();
        cells.dedup();
        let open_end = match door.leaf {
            Leaf::Hinged { hinge, .. } => {
                let ends = ends(&door.shape(&obstacle.shape, 1.0).corners());
                ends.into_iter().max_by(|a, b| (a - hinge).norm().total_cmp(&(b - hinge).norm()))
            }
            Leaf::Sliding { .. } => None,
        };
        let closed = obstacle.shape.corners();
        Self { index, closed, open_end, cells, is_open: None, openings: 0, motions: 0, motions_in_view: 0 }
    }

    /// Counts, after a reading. `corners` are those of the leaf now.
    pub(crate) fn observe(&mut self, corners: &[Point2<f64>; 4], mapper: &Mapper) {
        let is_open = corners.iter().zip(&self.closed).any(|(now, closed)| (now - closed).norm() > 1e-6);
        if self.is_open.replace(is_open).is_none_or(|was_open| was_open == is_open) {
            return;
        }
        let seen = self.cells.iter().filter(|&&index| mapper.is_in_view(index)).count();
        self.openings += u32::from(is_open);
        self.motions += 1;
        self.motions_in_view += u32::from(4 * seen >= self.cells.len());
    }

    /// The larger distance between the ends of the closed leaf and those of a segment, m.
    pub(crate) fn error_m(&self, found: &Segment) -> f64 {
        let ([a, b], [c, d]) = (ends(&self.closed), found.ends);
        let largest = |c: Point2<f64>, d: Point2<f64>| (a - c).norm().max((b - d).norm());
        largest(c, d).min(largest(d, c))
    }
}

/// The ends of the axis of a leaf.
fn ends(corners: &[Point2<f64>; 4]) -> [Point2<f64>; 2] {
    let middle = |a: usize, b: usize| nalgebra::center(&corners[a], &corners[b]);
    let is_along_first = (corners[1] - corners[0]).norm() > (corners[2] - corners[1]).norm();
    if is_along_first { [middle(0, 3), middle(1, 2)] } else { [middle(0, 1), middle(2, 3)] }
}

/// The cells on the axis of a leaf.
fn on_axis(corners: &[Point2<f64>; 4], frame: &GridFrame) -> Vec<usize> {
    let [from, to] = ends(corners);
    let along: Vector2<f64> = to - from;
    let steps = (2.0 * along.norm() / frame.resolution_m()) as usize;
    let point = |step: usize| from + along * ((step as f64 + 0.5) / steps as f64);
    (0..steps).filter_map(|step| frame.index(frame.cell_at(&point(step)))).collect()
}
