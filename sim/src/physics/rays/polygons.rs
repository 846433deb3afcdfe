//! Convex bodies that appear, disappear and move. Each body is listed in the cells that it overlaps, so that a
//! laser tests only the bodies in the cells that it may see.

use super::beams::Hits;
use super::edges::Edge;
use super::index_lists::IndexLists;
use super::visibility::PotentiallyVisibleSet;
use crate::physics::convex;
use nalgebra::Point2;

/// Convex bodies, each with an index.
#[derive(Clone, Debug, Default)]
pub(super) struct Polygons {
    polygons: Vec<Polygon>,
    /// The bodies in each cell; at the end the bodies that reach beyond the borders.
    sorted: IndexLists,
    is_sorted: bool,
}

#[derive(Clone, Debug, Default)]
struct Polygon {
    /// None while the body is absent.
    edges: Vec<Edge>,
    /// The robot that the body belongs to: its lasers never see the body.
    robot: Option<u32>,
}

/// The bodies that the present cast has tested.
#[derive(Clone, Debug, Default)]
pub(super) struct Tested {
    cast: u64,
    last: Vec<u64>,
}

impl Polygons {
    /// Room for `count` bodies, all absent.
    pub(super) fn new(count: usize) -> Self {
        Self { polygons: vec![Polygon::default(); count], ..Self::default() }
    }

    /// Whether there is room for no body.
    pub(super) fn is_empty(&self) -> bool {
        self.polygons.is_empty()
    }

    /// Sets the corners of a body (counter-clockwise, m). No corners: the body is absent.
    pub(super) fn set(&mut self, index: usize, robot: Option<usize>, corners: &[Point2<f64>]) {
        let polygon = &mut self.polygons[index];
        polygon.robot = robot.map(|robot| robot as u32);
        polygon.edges.clear();
        polygon.edges.extend(convex::sides(corners).map(|(from, to)| Edge::new(*from, *to)));
        self.is_sorted = false;
    }

    /// Sorts the bodies into cells, if any has moved.
    pub(super) fn sort(&mut self, visible: &PotentiallyVisibleSet) {
        if self.is_sorted || self.polygons.is_empty() {
            return;
        }
        let cells: Vec<(usize, u32)> = self
            .polygons
            .iter()
            .enumerate()
            .filter(|(_, polygon)| !polygon.edges.is_empty())
            .flat_map(|(i, polygon)| {
                let (low, high) = polygon.bounds();
                let beyond = visible.reaches_out(&low, &high).then_some(visible.len());
                visible.around(&low, &high).chain(beyond).map(move |cell| (cell, i as u32))
            })
            .collect();
        self.sorted.sort(visible.len() + 1, cells.iter().copied());
        self.is_sorted = true;
    }

    /// Starts a new cast: no body has been tested yet.
    pub(super) fn begin(&self, tested: &mut Tested) {
        tested.cast += 1;
        tested.last.resize(self.polygons.len().max(tested.last.len()), 0);
    }

    /// Adds the bodies in a cell that this cast has not added yet.
    pub(super) fn add_cell(&self, cell: usize, own: usize, tested: &mut Tested, hits: &mut Hits<'_>) {
        for &i in self.sorted.get(cell) {
            let last = &mut tested.last[i as usize];
            if *last != tested.cast {
                *last = tested.cast;
                self.polygons[i as usize].add(own, hits);
            }
        }
    }

    /// Adds all bodies.
    pub(super) fn add_all(&self, own: usize, hits: &mut Hits<'_>) {
        self.polygons.iter().for_each(|polygon| polygon.add(own, hits));
    }

    /// Whether a point is inside of a body that overlaps the cell of the point (none: beyond the borders).
    pub(super) fn contains(&self, cell: Option<usize>, own: usize, point: &Point2<f64>) -> bool {
        let is_in = |polygon: &Polygon| {
            polygon.is_seen(own) && polygon.edges.iter().all(|edge| edge.gap_m(point) <= 0.0)
        };
        match cell {
            Some(cell) => self.sorted.get(cell).iter().any(|&i| is_in(&self.polygons[i as usize])),
            None => self.polygons.iter().any(is_in),
        }
    }
}

impl Polygon {
    /// Whether the body is present and does not belong to the robot that measures.
    fn is_seen(&self, own: usize) -> bool {
        !self.edges.is_empty() && self.robot != Some(own as u32)
    }

    fn add(&self, own: usize, hits: &mut Hits<'_>) {
        if self.is_seen(own) {
            self.edges.iter().for_each(|edge| hits.add_edge(edge));
        }
    }

    /// The corners of the upright box around the body, m.
    fn bounds(&self) -> (Point2<f64>, Point2<f64>) {
        let first = self.edges[0].from;
        self.edges
            .iter()
            .fold((first, first), |(low, high), edge| (low.inf(&edge.from), high.sup(&edge.from)))
    }
}
