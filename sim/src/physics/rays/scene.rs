use super::beams::{Beams, Hits};
use super::circles::{Disc, Discs};
use super::edges::{Edge, visible_edges};
use super::index_lists::IndexLists;
use super::polygons::{Polygons, Tested};
use super::visibility::PotentiallyVisibleSet;
use crate::physics::shape::Rectangle;
use nalgebra::{Isometry2, Point2};
use std::sync::Arc;

/// Memory for casting rays, kept from cast to cast.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct Scratch {
    /// The result: one over the range for each beam, 1/m; 0 where there is no hit.
    pub(in crate::physics) inverse: Vec<f64>,
    discs: Discs,
    tested: Tested,
}

/// Everything that a laser can see.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Scene {
    walls: Arc<Walls>,
    /// The convex bodies that appear, disappear or move.
    polygons: Polygons,
    /// The robots, by index.
    discs: Vec<Disc>,
    /// The robots by the cell of their center; at the end those beyond the borders.
    sorted: IndexLists<(u32, Disc)>,
    is_sorted: bool,
}

/// The bodies that never move.
#[derive(Debug)]
struct Walls {
    solids: Vec<[Edge; 4]>,
    edges: Vec<Edge>,
    visible: PotentiallyVisibleSet,
}

impl Scene {
    /// The walls between two corners (m), for lasers with a range of `range_m`, with round robots, and room for
    /// a number of convex bodies that are absent at first.
    pub(in crate::physics) fn new(
        (low, high): (Point2<f64>, Point2<f64>),
        walls: &[Rectangle],
        discs: Vec<Disc>,
        polygons: usize,
        range_m: f64,
    ) -> Self {
        let edges = visible_edges(walls);
        let radius_m = discs.iter().fold(0.0, |most: f64, disc| most.max(disc.radius_m));
        let visible = PotentiallyVisibleSet::new(low, high, walls, &edges, range_m, radius_m);
        let solids = walls.iter().map(Edge::of_rectangle).collect();
        Self {
            walls: Arc::new(Walls { solids, edges, visible }),
            polygons: Polygons::new(polygons),
            discs,
            sorted: IndexLists::default(),
            is_sorted: false,
        }
    }

    /// Sets the corners of the convex body with an index (counter-clockwise, m). No corners: the body is absent.
    /// The lasers of `robot`, whose body it is, never see the body.
    pub(in crate::physics) fn set_polygon(
        &mut self,
        index: usize,
        robot: Option<usize>,
        corners: &[Point2<f64>],
    ) {
        self.polygons.set(index, robot, corners);
    }

    /// Sets the center of a robot, m.
    pub(in crate::physics) fn move_disc(&mut self, robot: usize, center: Point2<f64>) {
        self.discs[robot].center = center;
        self.is_sorted = false;
    }

    /// Sorts the moving bodies into cells, if any has moved. Must be called before [`Scene::cast`].
    pub(in crate::physics) fn sort(&mut self) {
        self.polygons.sort(&self.walls.visible);
        if self.is_sorted {
            return;
        }
        let visible = &self.walls.visible;
        let robots = self.discs.iter().enumerate().map(|(robot, disc)| {
            (visible.cell_at(&disc.center).unwrap_or(visible.len()), (robot as u32, *disc))
        });
        self.sorted.sort(visible.len() + 1, robots);
        self.is_sorted = true;
    }

    /// Computes what `beams` of a laser at the pose `laser` hit. The laser never sees the robot `own`.
    pub(in crate::physics) fn cast(
        &self,
        beams: &Beams,
        laser: &Isometry2<f64>,
        own: usize,
        scratch: &mut Scratch,
    ) {
        debug_assert!(self.is_sorted);
        let Walls { solids, edges, visible } = &*self.walls;
        let Scratch { inverse, discs, tested } = scratch;
        let mut hits = Hits::new(beams, laser, inverse);
        discs.clear(self.sorted.all().len());
        let at = Point2::from(laser.translation.vector);
        let contains = |sides: &[Edge; 4]| sides.iter().all(|side| side.gap_m(&at) <= 0.0);
        let own_cell = visible.cell_at(&at);
        let has_polygons = !self.polygons.is_empty();
        let mut is_inside = has_polygons && self.polygons.contains(own_cell, own, &at);
        self.polygons.begin(tested);
        match own_cell {
            Some(cell) => {
                is_inside |= visible.boxes(cell).iter().any(|&i| contains(&solids[i as usize]));
                visible.edges(cell).iter().for_each(|&i| hits.add_edge(&edges[i as usize]));
                let cells = visible.cells(cell).iter().map(|&cell| cell as usize);
                for cell in cells.chain([visible.len()]) {
                    add_robots(discs, &mut hits, self.sorted.get(cell), own);
                    if has_polygons {
                        self.polygons.add_cell(cell, own, tested, &mut hits);
                    }
                }
            }
            None => {
                is_inside |= solids.iter().any(contains);
                edges.iter().for_each(|edge| hits.add_edge(edge));
                add_robots(discs, &mut hits, self.sorted.all(), own);
                self.polygons.add_all(own, &mut hits);
            }
        }
        // Last, since other bodies hide most of them.
        discs.add_to(&mut hits);
        if is_inside {
            hits.add_inside();
        }
    }
}

// Runs for every visible cell, most of which are empty: a call would cost 5 % of a simulated second.
#[inline(always)]
fn add_robots(discs: &mut Discs, hits: &mut Hits<'_>, robots: &[(u32, Disc)], own: usize) {
    for (robot, disc) in robots {
        if *robot as usize != own {
            discs.push(disc, hits);
        }
    }
}
