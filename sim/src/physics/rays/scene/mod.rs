mod ring;
#[cfg(test)]
mod tests;

use super::beams::{Beams, Hits};
use super::disc::Disc;
use super::edges::{Edge, visible_edges};
use super::hiding::add_edges;
use super::index_lists::IndexLists;
use super::polygons::{Body, SortedPolygons, Tested};
use super::visibility::PotentiallyVisibleSet;
use crate::physics::shape::Rectangle;
use nalgebra::{Isometry2, Point2};
use std::cell::RefCell;
use std::sync::{Arc, OnceLock};

thread_local! {
    /// Memory for casting rays, kept from cast to cast.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

#[derive(Default)]
struct Scratch {
    /// The result: one over the range for each beam, 1/m; 0 where there is no hit.
    inverse: Vec<f64>,
    tested: Tested,
}

/// Up to this number of moving bodies, all of them are tested, and not only those in the cells that may be seen: to go
/// through the cells would take longer.
const FEW_BODIES: usize = 16;

/// Everything that a laser can see. A clone shares everything until a body moves.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Scene {
    moving: Arc<Moving>,
}

/// The bodies that never move.
#[derive(Debug)]
struct Walls {
    solids: Vec<[Edge; 4]>,
    edges: Vec<Edge>,
    visible: PotentiallyVisibleSet,
}

/// The walls, and the other bodies.
#[derive(Debug)]
struct Moving {
    /// Here, so that a clone of the scene counts one owner of this world, and not one of the walls that the worlds on all
    /// threads share: all of them would write to the same memory.
    walls: Arc<Walls>,
    /// The convex bodies that appear, disappear or move.
    polygons: Vec<Body>,
    /// The robots, by index.
    discs: Vec<Disc>,
    /// The same bodies by position, as soon as a ray is cast.
    sorted: OnceLock<Sorted>,
}

impl Clone for Moving {
    /// A clone is made because a body moves.
    fn clone(&self) -> Self {
        let Self { walls, polygons, discs, .. } = self;
        let (walls, polygons, discs) = (Arc::clone(walls), polygons.clone(), discs.clone());
        Self { walls, polygons, discs, sorted: OnceLock::new() }
    }
}

#[derive(Debug)]
struct Sorted {
    /// The robots by the cell of their center; at the end those beyond the borders.
    robots: IndexLists<(u32, Disc)>,
    polygons: SortedPolygons,
    /// Whether there are so few bodies that they are not sorted into cells.
    are_few: bool,
}

impl Sorted {
    /// The bodies sorted into cells.
    fn new(moving: &Moving) -> Self {
        let Moving { walls, polygons, discs, .. } = moving;
        let visible = &walls.visible;
        let are_few = discs.len() + polygons.len() <= FEW_BODIES;
        let polygons = SortedPolygons::new(polygons, (!are_few).then_some(visible));
        // A disc of radius 0 stands for a robot with corners, whose polygon hides its center.
        let round = discs.iter().enumerate().filter(|(_, disc)| disc.radius_m > 0.0);
        let cells = round.map(|(robot, disc)| {
            let cell = if are_few { 0 } else { visible.cell_at(&disc.center).unwrap_or(visible.len()) };
            (cell, (robot as u32, *disc))
        });
        let robots = IndexLists::sorted(if are_few { 1 } else { visible.len() + 1 }, cells);
        Self { robots, polygons, are_few }
    }
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
        let (walls, polygons) = (Arc::new(Walls { solids, edges, visible }), vec![Body::default(); polygons]);
        Self { moving: Arc::new(Moving { walls, polygons, discs, sorted: OnceLock::new() }) }
    }

    /// Sets the corners of the convex body with an index (counter-clockwise, m). No corners: the body is absent.
    /// The lasers of `robot`, whose body it is, never see the body.
    pub(in crate::physics) fn set_polygon(
        &mut self,
        index: usize,
        robot: Option<usize>,
        corners: impl Iterator<Item = Point2<f64>>,
    ) {
        let moving = Arc::make_mut(&mut self.moving);
        let body = &mut moving.polygons[index];
        body.robot = robot;
        body.corners.clear();
        body.corners.extend(corners);
        moving.sorted = OnceLock::new();
    }

    /// Sets the center of a robot, m.
    pub(in crate::physics) fn move_disc(&mut self, robot: usize, center: Point2<f64>) {
        let moving = Arc::make_mut(&mut self.moving);
        moving.discs[robot].center = center;
        moving.sorted = OnceLock::new();
    }

    /// The moving bodies, sorted into cells.
    fn sorted(&self) -> &Sorted {
        self.moving.sorted.get_or_init(|| Sorted::new(&self.moving))
    }

    /// Computes what `beams` of a laser at the pose `laser` hit. The laser never sees the robot `own`. `read` receives
    /// one over the range for each beam, 1/m; 0 where there is no hit.
    pub(in crate::physics) fn cast<T>(
        &self,
        beams: &Beams,
        laser: &Isometry2<f64>,
        own: usize,
        read: impl FnOnce(&[f64]) -> T,
    ) -> T {
        SCRATCH.with_borrow_mut(|scratch| {
            self.cast_into(beams, laser, own, scratch);
            read(&scratch.inverse)
        })
    }

    fn cast_into(&self, beams: &Beams, laser: &Isometry2<f64>, own: usize, scratch: &mut Scratch) {
        let Walls { solids, edges, visible } = &*self.moving.walls;
        let Sorted { robots, polygons, are_few } = self.sorted();
        let Scratch { inverse, tested } = scratch;
        let mut hits = Hits::new(beams, laser, inverse);
        let at = Point2::from(laser.translation.vector);
        let own_cell = visible.cell_at(&at);
        let has_polygons = polygons.len() > 0;
        tested.begin(polygons.len());
        match own_cell {
            Some(cell) => add_edges(visible.edges.get(cell), edges, &mut hits),
            None => edges.iter().for_each(|edge| hits.add_edge(edge)),
        }
        match own_cell.filter(|_| !are_few) {
            Some(cell) => {
                let cells = visible.cells.get(cell).iter().map(|&cell| cell as usize);
                for cell in cells.chain([visible.len()]) {
                    add_robots(&mut hits, robots.get(cell), own);
                    if has_polygons {
                        for &index in polygons.in_cell(cell).iter().filter(|index| tested.is_first(**index)) {
                            polygons.add_to(index, own, &mut hits);
                        }
                    }
                }
            }
            None => {
                add_robots(&mut hits, &robots.items, own);
                for index in 0..polygons.len() as u32 {
                    polygons.add_to(index, own, &mut hits);
                }
            }
        }
        let polygon_cell = own_cell.filter(|_| !are_few);
        if is_in_wall(solids, visible, own_cell, &at) || polygons.contains(polygon_cell, own, &at) {
            hits.add_inside();
        }
    }
}

/// Whether a point in a cell (none: beyond the borders) is inside of a wall.
fn is_in_wall(
    solids: &[[Edge; 4]],
    visible: &PotentiallyVisibleSet,
    cell: Option<usize>,
    at: &Point2<f64>,
) -> bool {
    let contains = |sides: &[Edge; 4]| sides.iter().all(|side| side.gap_m(at) <= 0.0);
    match cell {
        Some(cell) => visible.boxes.get(cell).iter().any(|&wall| contains(&solids[wall as usize])),
        None => solids.iter().any(contains),
    }
}

// Runs for every visible cell, most of which are empty: a call would cost 5 % of a simulated second.
#[inline(always)]
fn add_robots(hits: &mut Hits<'_>, robots: &[(u32, Disc)], own: usize) {
    for (robot, disc) in robots {
        if *robot as usize != own {
            hits.add_disc(disc);
        }
    }
}
