//! Convex bodies that appear, disappear and move. Each body is listed in the cells that it overlaps, so that a
//! laser tests only the bodies in the cells that it may see.

use super::beams::Hits;
use super::disc::Disc;
use super::edges::Edge;
use super::index_lists::IndexLists;
use super::visibility::PotentiallyVisibleSet;
use crate::physics::form::bounds;
use nalgebra::Point2;
use std::ops::Range;

/// A convex body.
#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    /// Its corners, counter-clockwise, m; none while the body is absent.
    pub(super) corners: Vec<Point2<f64>>,
    /// The robot that the body belongs to: its lasers never see the body.
    pub(super) robot: Option<usize>,
}

/// The bodies that are present, prepared for rays.
#[derive(Debug)]
pub(super) struct SortedPolygons {
    edges: Vec<Edge>,
    bodies: Vec<Polygon>,
    /// The bodies in each cell; at the end the bodies that reach beyond the borders. No lists if there are few bodies.
    cells: IndexLists,
}

/// A body that is present.
#[derive(Clone, Debug)]
pub(super) struct Polygon {
    /// A disc that contains the body.
    pub(super) around: Disc,
    edges: Range<usize>,
    robot: Option<usize>,
}

impl Polygon {
    /// Whether the lasers of a robot see the body.
    pub(super) fn is_seen_by(&self, robot: usize) -> bool {
        self.robot != Some(robot)
    }
}

impl SortedPolygons {
    /// These bodies, sorted into the cells, if there are cells.
    pub(super) fn new(polygons: &[Body], visible: Option<&PotentiallyVisibleSet>) -> Self {
        let (mut edges, mut bodies, mut in_cells) = (Vec::new(), Vec::new(), Vec::new());
        for Body { corners, robot } in polygons.iter().filter(|body| !body.corners.is_empty()) {
            let index = bodies.len() as u32;
            let (low, high) = bounds(corners);
            let center = nalgebra::center(&low, &high);
            let radius2 = corners.iter().map(|corner| (corner - center).norm_squared()).fold(0.0, f64::max);
            let start = edges.len();
            edges.extend(Edge::around(corners.iter().copied()));
            // A little larger, because of rounding.
            let around = Disc { center, radius_m: radius2.sqrt() * (1.0 + 1e-9) };
            bodies.push(Polygon { around, edges: start..edges.len(), robot: *robot });
            if let Some(visible) = visible {
                let beyond = visible.reaches_out(&low, &high).then_some(visible.len());
                in_cells.extend(visible.around(&low, &high).chain(beyond).map(|cell| (cell, index)));
            }
        }
        let cells = visible.map(|visible| IndexLists::sorted(visible.len() + 1, in_cells.iter().copied()));
        Self { edges, bodies, cells: cells.unwrap_or_default() }
    }

    /// The number of bodies.
    pub(super) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// The indices of the bodies that overlap a cell.
    pub(super) fn in_cell(&self, cell: usize) -> &[u32] {
        self.cells.get(cell)
    }

    /// The body with an index.
    pub(super) fn get(&self, index: u32) -> &Polygon {
        &self.bodies[index as usize]
    }

    /// The sides of a body.
    pub(super) fn edges(&self, polygon: &Polygon) -> &[Edge] {
        &self.edges[polygon.edges.clone()]
    }

    /// Adds the body with an index to the hits of a laser of the robot `own`, if the laser sees it.
    pub(super) fn add_to(&self, index: u32, own: usize, hits: &mut Hits<'_>) {
        let polygon = self.get(index);
        if polygon.is_seen_by(own) {
            hits.add_polygon_in(&polygon.around, self.edges(polygon));
        }
    }

    /// Whether a point is inside of a body that overlaps the cell of the point (none: of any body).
    pub(super) fn contains(&self, cell: Option<usize>, own: usize, point: &Point2<f64>) -> bool {
        let is_in = |polygon: &Polygon| {
            polygon.is_seen_by(own) && self.edges(polygon).iter().all(|edge| edge.gap_m(point) <= 0.0)
        };
        match cell {
            Some(cell) => self.in_cell(cell).iter().any(|&index| is_in(self.get(index))),
            None => self.bodies.iter().any(is_in),
        }
    }
}

/// The bodies that the present cast has tested.
#[derive(Debug, Default)]
pub(super) struct Tested {
    cast: u64,
    last: Vec<u64>,
}

impl Tested {
    /// Starts a new cast among a number of bodies: no body has been tested yet.
    pub(super) fn begin(&mut self, bodies: usize) {
        self.cast += 1;
        self.last.resize(bodies.max(self.last.len()), 0);
    }

    /// Whether this is the first test of a body in this cast.
    pub(super) fn is_first(&mut self, index: u32) -> bool {
        std::mem::replace(&mut self.last[index as usize], self.cast) != self.cast
    }
}
