use super::discs::Discs;
use super::fan::{Beams, Hits};
use super::hulls::{Hulls, Seen};
use super::outline::{Edge, outline};
use super::sight::{Reach, Sight};
use crate::physics::shape::Rectangle;
use nalgebra::{Isometry2, Point2};
use std::ops::Range;
use std::sync::Arc;

/// A round body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Disc {
    /// Its middle, m.
    pub(in crate::physics) center: Point2<f64>,
    /// Its radius, m.
    pub(in crate::physics) radius_m: f64,
}

/// Memory to look with, kept from look to look.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Scratch {
    /// What was seen: one over the range for each beam, 1/m; 0 where there is no hit.
    pub(in crate::physics) inverse: Vec<f64>,
    discs: Discs,
    seen: Seen,
}

/// Everything that a laser can see.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Scene {
    walls: Arc<Walls>,
    /// Whatever else comes, goes or moves.
    hulls: Hulls,
    /// The robots, in their order.
    discs: Vec<Disc>,
    /// The robots by the cell in which their middles are; last those beyond the borders.
    sorted: Vec<(u32, Disc)>,
    /// Where each cell's robots start in `sorted`.
    starts: Vec<u32>,
    is_sorted: bool,
}

/// What never moves.
#[derive(Debug)]
struct Walls {
    solids: Vec<[Edge; 4]>,
    edges: Vec<Edge>,
    sight: Sight,
}

impl Scene {
    /// The walls between two corners (m), for lasers that see `range_m` far, with round robots, and
    /// room for `hulls` convex bodies that are not there yet.
    pub(in crate::physics) fn new(
        (low, high): (Point2<f64>, Point2<f64>),
        walls: &[Rectangle],
        discs: Vec<Disc>,
        hulls: usize,
        range_m: f64,
    ) -> Self {
        let edges = outline(walls);
        let radius_m = discs.iter().fold(0.0, |most: f64, disc| most.max(disc.radius_m));
        let sight = Sight::new(low, high, walls, &edges, &Reach { range_m, radius_m });
        let solids = walls.iter().map(Edge::of_box).collect();
        Self {
            starts: vec![0; sight.len() + 2],
            walls: Arc::new(Walls { solids, edges, sight }),
            hulls: Hulls::new(hulls),
            discs,
            sorted: Vec::new(),
            is_sorted: false,
        }
    }

    /// Puts a convex body with these corners (counter-clockwise, m) into a place of its own; no
    /// corners take it away. Lasers of `robot`, whose body it is, never see it.
    pub(in crate::physics) fn set_hull(
        &mut self,
        place: usize,
        robot: Option<usize>,
        corners: &[Point2<f64>],
    ) {
        self.hulls.set(place, robot, corners);
    }

    /// A robot is somewhere else (m).
    pub(in crate::physics) fn move_disc(&mut self, robot: usize, center: Point2<f64>) {
        self.discs[robot].center = center;
        self.is_sorted = false;
    }

    /// Sorts what moves into cells, if any has moved; to be called before [`Scene::look`].
    pub(in crate::physics) fn sort(&mut self) {
        self.hulls.sort(&self.walls.sight);
        if self.is_sorted {
            return;
        }
        let outside = self.walls.sight.len();
        let cell = |disc: &Disc| self.walls.sight.cell_at(&disc.center).unwrap_or(outside);
        // Counting sort: the number of robots per cell, summed up to where each cell ends; filled
        // from the back, ends become starts.
        self.starts.fill(0);
        self.discs.iter().for_each(|disc| self.starts[cell(disc)] += 1);
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        let nothing = Disc { center: Point2::origin(), radius_m: 0.0 };
        self.sorted.resize(self.discs.len(), (0, nothing));
        for (robot, disc) in self.discs.iter().enumerate().rev() {
            let start = &mut self.starts[cell(disc)];
            *start -= 1;
            self.sorted[*start as usize] = (robot as u32, *disc);
        }
        self.is_sorted = true;
    }

    /// What `beams` at `laser` hit, on the robot in place `own`, which they never see.
    pub(in crate::physics) fn look(
        &self,
        beams: &Beams,
        laser: &Isometry2<f64>,
        own: usize,
        scratch: &mut Scratch,
    ) {
        debug_assert!(self.is_sorted);
        let Walls { solids, edges, sight } = &*self.walls;
        let Scratch { inverse, discs, seen } = scratch;
        let mut hits = Hits::new(beams, laser, inverse);
        discs.clear(self.sorted.len());
        let at = Point2::from(laser.translation.vector);
        let contains = |sides: &[Edge; 4]| sides.iter().all(|side| side.gap_m(&at) <= 0.0);
        let own_cell = sight.cell_at(&at);
        let has_hulls = !self.hulls.is_empty();
        let mut is_inside = has_hulls && self.hulls.contains(own_cell, own, &at);
        self.hulls.begin(seen);
        match own_cell {
            Some(cell) => {
                is_inside |= sight.boxes(cell).iter().any(|&i| contains(&solids[i as usize]));
                sight.edges(cell).iter().for_each(|&i| hits.add_edge(&edges[i as usize]));
                let cells = sight.cells(cell).iter().map(|&cell| cell as usize);
                for cell in cells.chain([sight.len()]) {
                    self.note_robots(discs, &mut hits, self.starts[cell]..self.starts[cell + 1], own);
                    if has_hulls {
                        self.hulls.add_cell(cell, own, seen, &mut hits);
                    }
                }
            }
            None => {
                is_inside |= solids.iter().any(contains);
                edges.iter().for_each(|edge| hits.add_edge(edge));
                self.note_robots(discs, &mut hits, 0..self.sorted.len() as u32, own);
                self.hulls.add_all(own, &mut hits);
            }
        }
        // Last, since most are hidden by what has been added before.
        discs.add_to(&mut hits);
        if is_inside {
            hits.add_inside();
        }
    }

    // For every cell in sight, most of which are empty: as a call it costs 5 % of a simulated second.
    #[inline(always)]
    fn note_robots(&self, discs: &mut Discs, hits: &mut Hits<'_>, sorted: Range<u32>, own: usize) {
        for (robot, disc) in &self.sorted[sorted.start as usize..sorted.end as usize] {
            if *robot as usize != own {
                discs.push(disc, hits);
            }
        }
    }
}
