//! Convex bodies that come, go and move: each lies in the cells that it reaches into, so that a
//! laser asks only those in the cells that it may see.

use super::fan::Hits;
use super::outline::Edge;
use super::sight::Sight;
use crate::physics::convex;
use nalgebra::Point2;
use std::ops::Range;

/// Convex bodies, each in a place of its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Hulls {
    hulls: Vec<Hull>,
    /// The bodies in each cell, one cell after the other; last those that reach beyond the borders.
    sorted: Vec<u32>,
    /// Where each cell's bodies start in `sorted`.
    starts: Vec<u32>,
    is_sorted: bool,
}

#[derive(Clone, Debug, Default)]
struct Hull {
    /// None while it is not there.
    edges: Vec<Edge>,
    /// The robot whose body it is: its lasers never see it.
    robot: Option<u32>,
}

/// Which bodies have been looked at in the present look.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen {
    look: u64,
    last: Vec<u64>,
}

impl Hulls {
    /// Room for `count` bodies, none of which is there yet.
    pub(super) fn new(count: usize) -> Self {
        Self { hulls: vec![Hull::default(); count], ..Self::default() }
    }

    /// Whether there never is any.
    pub(super) fn is_empty(&self) -> bool {
        self.hulls.is_empty()
    }

    /// Puts a body with these corners (counter-clockwise, m) into a place; none: takes it away.
    pub(super) fn set(&mut self, place: usize, robot: Option<usize>, corners: &[Point2<f64>]) {
        let hull = &mut self.hulls[place];
        hull.robot = robot.map(|robot| robot as u32);
        hull.edges.clear();
        hull.edges.extend(convex::sides(corners).map(|(from, to)| Edge::new(*from, *to)));
        self.is_sorted = false;
    }

    /// Sorts the bodies into cells, if any has moved.
    pub(super) fn sort(&mut self, sight: &Sight) {
        if self.is_sorted || self.hulls.is_empty() {
            return;
        }
        // Counting sort, as for robots; but a body may lie in several cells.
        self.starts.clear();
        self.starts.resize(sight.len() + 2, 0);
        let cells: Vec<(u32, u32)> = self
            .hulls
            .iter()
            .enumerate()
            .filter(|(_, hull)| !hull.edges.is_empty())
            .flat_map(|(i, hull)| {
                let (low, high) = hull.bounds();
                let beyond = sight.reaches_out(&low, &high).then_some(sight.len());
                sight.around(&low, &high).chain(beyond).map(move |cell| (cell as u32, i as u32))
            })
            .collect();
        cells.iter().for_each(|(cell, _)| self.starts[*cell as usize] += 1);
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.sorted.resize(cells.len(), 0);
        for (cell, hull) in cells.iter().rev() {
            let start = &mut self.starts[*cell as usize];
            *start -= 1;
            self.sorted[*start as usize] = *hull;
        }
        self.is_sorted = true;
    }

    /// A new look: nothing has been looked at yet.
    pub(super) fn begin(&self, seen: &mut Seen) {
        seen.look += 1;
        seen.last.resize(self.hulls.len().max(seen.last.len()), 0);
    }

    /// Adds the bodies in a cell that have not been added in this look.
    pub(super) fn add_cell(&self, cell: usize, own: usize, seen: &mut Seen, hits: &mut Hits<'_>) {
        for &i in &self.sorted[self.range(cell)] {
            let last = &mut seen.last[i as usize];
            if *last != seen.look {
                *last = seen.look;
                self.hulls[i as usize].add(own, hits);
            }
        }
    }

    /// Adds all bodies.
    pub(super) fn add_all(&self, own: usize, hits: &mut Hits<'_>) {
        self.hulls.iter().for_each(|hull| hull.add(own, hits));
    }

    /// Whether a point is inside of a body that reaches into its cell (none: beyond the borders).
    pub(super) fn contains(&self, cell: Option<usize>, own: usize, point: &Point2<f64>) -> bool {
        let is_in = |hull: &Hull| hull.is_seen(own) && hull.edges.iter().all(|edge| edge.gap_m(point) <= 0.0);
        match cell {
            Some(cell) => self.sorted[self.range(cell)].iter().any(|&i| is_in(&self.hulls[i as usize])),
            None => self.hulls.iter().any(is_in),
        }
    }

    fn range(&self, cell: usize) -> Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }
}

impl Hull {
    /// Whether it is there, and not the body of the robot that looks.
    fn is_seen(&self, own: usize) -> bool {
        !self.edges.is_empty() && self.robot != Some(own as u32)
    }

    fn add(&self, own: usize, hits: &mut Hits<'_>) {
        if self.is_seen(own) {
            self.edges.iter().for_each(|edge| hits.add_edge(edge));
        }
    }

    /// The corners of the upright box around it, m.
    fn bounds(&self) -> (Point2<f64>, Point2<f64>) {
        let first = self.edges[0].from;
        self.edges
            .iter()
            .fold((first, first), |(low, high), edge| (low.inf(&edge.from), high.sup(&edge.from)))
    }
}
