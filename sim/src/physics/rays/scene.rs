use super::beams::{Beams, Hits};
use super::circles::{Disc, Discs};
use super::edges::{Edge, visible_edges};
use super::index_lists::IndexLists;
use super::nearest::Nearest;
use super::polygons::{Polygons, SortedPolygons, Tested};
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
    discs: Discs,
    tested: Tested,
}

/// Everything that a laser can see. A clone shares everything until a body moves.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Scene {
    walls: Arc<Walls>,
    moving: Arc<Moving>,
}

/// The bodies that never move.
#[derive(Debug)]
struct Walls {
    solids: Vec<[Edge; 4]>,
    edges: Vec<Edge>,
    visible: PotentiallyVisibleSet,
}

/// The other bodies.
#[derive(Debug)]
struct Moving {
    /// The convex bodies that appear, disappear or move.
    polygons: Polygons,
    /// The robots, by index.
    discs: Vec<Disc>,
    /// The same bodies by position, as soon as a ray is cast.
    sorted: OnceLock<Sorted>,
}

impl Clone for Moving {
    /// A clone is made because a body moves.
    fn clone(&self) -> Self {
        Self { polygons: self.polygons.clone(), discs: self.discs.clone(), sorted: OnceLock::new() }
    }
}

#[derive(Debug)]
struct Sorted {
    /// The robots by the cell of their center; at the end those beyond the borders.
    robots: IndexLists<(u32, Disc)>,
    polygons: SortedPolygons,
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
        let moving = Moving { polygons: Polygons::new(polygons), discs, sorted: OnceLock::new() };
        Self { walls: Arc::new(Walls { solids, edges, visible }), moving: Arc::new(moving) }
    }

    /// Sets the corners of the convex body with an index (counter-clockwise, m). No corners: the body is absent.
    /// The lasers of `robot`, whose body it is, never see the body.
    pub(in crate::physics) fn set_polygon(
        &mut self,
        index: usize,
        robot: Option<usize>,
        corners: impl ExactSizeIterator<Item = Point2<f64>>,
    ) {
        let moving = Arc::make_mut(&mut self.moving);
        moving.polygons.set(index, robot, corners);
        moving.sorted.take();
    }

    /// Sets the center of a robot, m.
    pub(in crate::physics) fn move_disc(&mut self, robot: usize, center: Point2<f64>) {
        let moving = Arc::make_mut(&mut self.moving);
        moving.discs[robot].center = center;
        moving.sorted.take();
    }

    /// The moving bodies, sorted into cells.
    fn sorted(&self) -> &Sorted {
        let Moving { polygons, discs, sorted } = &*self.moving;
        sorted.get_or_init(|| {
            let visible = &self.walls.visible;
            // A disc of radius 0 stands for a robot with corners, whose polygon hides its center.
            let round = discs.iter().enumerate().filter(|(_, disc)| disc.radius_m > 0.0);
            let cells = round.map(|(robot, disc)| {
                (visible.cell_at(&disc.center).unwrap_or(visible.len()), (robot as u32, *disc))
            });
            let mut robots = IndexLists::default();
            robots.sort(visible.len() + 1, cells);
            Sorted { robots, polygons: SortedPolygons::new(polygons, visible) }
        })
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
        let Walls { solids, edges, visible } = &*self.walls;
        let Sorted { robots, polygons } = self.sorted();
        let Scratch { inverse, discs, tested } = scratch;
        let mut hits = Hits::new(beams, laser, inverse);
        discs.clear(robots.all().len() + polygons.len());
        let at = Point2::from(laser.translation.vector);
        let own_cell = visible.cell_at(&at);
        let has_polygons = polygons.len() > 0;
        tested.begin(polygons.len());
        match own_cell {
            Some(cell) => {
                visible.edges(cell).iter().for_each(|seen| hits.add_edge(&edges[seen.edge as usize]));
                let cells = visible.cells(cell).iter().map(|&cell| cell as usize);
                for cell in cells.chain([visible.len()]) {
                    add_robots(discs, &mut hits, robots.get(cell), own);
                    if has_polygons {
                        for &index in polygons.in_cell(cell).iter().filter(|index| tested.is_first(**index)) {
                            discs.push_polygon(index, polygons, own, &mut hits);
                        }
                    }
                }
            }
            None => {
                edges.iter().for_each(|edge| hits.add_edge(edge));
                add_robots(discs, &mut hits, robots.all(), own);
                for index in 0..polygons.len() as u32 {
                    discs.push_polygon(index, polygons, own, &mut hits);
                }
            }
        }
        // Last, since other bodies hide most of them.
        discs.add_to(polygons, &mut hits);
        if is_inside(solids, visible, polygons, own_cell, own, &at) {
            hits.add_inside();
        }
    }

    /// One over the shortest range of all `beams` of a sensor at the pose `sensor` on the robot `own`, 1/m; 0 without a
    /// hit. The value is the largest one of [`Scene::cast`].
    pub(in crate::physics) fn nearest(&self, beams: &Beams, sensor: &Isometry2<f64>, own: usize) -> f64 {
        let Walls { solids, edges, visible } = &*self.walls;
        let Sorted { robots, polygons } = self.sorted();
        let at = Point2::from(sensor.translation.vector);
        let own_cell = visible.cell_at(&at);
        if is_inside(solids, visible, polygons, own_cell, own, &at) {
            return f64::INFINITY;
        }
        let mut nearest = Nearest::new(beams, sensor);
        let add_cell = |cell: usize, nearest: &mut Nearest<'_>| {
            for (_, disc) in robots.get(cell).iter().filter(|(robot, _)| *robot as usize != own) {
                nearest.add_disc(disc);
            }
            for &index in polygons.in_cell(cell) {
                let polygon = polygons.get(index);
                if polygon.is_seen_by(own) && nearest.may_meet(&polygon.around) {
                    polygons.edges(polygon).iter().for_each(|edge| nearest.add_edge(edge));
                }
            }
        };
        match own_cell {
            Some(cell) => {
                let edges_in_reach = visible.edges(cell).iter();
                for seen in edges_in_reach {
                    if f64::from(seen.nearest_m) > nearest.reach_m() {
                        break;
                    }
                    nearest.add_edge(&edges[seen.edge as usize]);
                }
                for &other in visible.cells(cell) {
                    if visible.apart_m(cell, other as usize) > nearest.reach_m() {
                        break;
                    }
                    add_cell(other as usize, &mut nearest);
                }
                add_cell(visible.len(), &mut nearest);
            }
            None => {
                edges.iter().for_each(|edge| nearest.add_edge(edge));
                (0..=visible.len()).for_each(|cell| add_cell(cell, &mut nearest));
            }
        }
        nearest.inverse()
    }
}

/// Whether a point is inside of a solid that is not the body of the robot `own`.
fn is_inside(
    solids: &[[Edge; 4]],
    visible: &PotentiallyVisibleSet,
    polygons: &SortedPolygons,
    cell: Option<usize>,
    own: usize,
    at: &Point2<f64>,
) -> bool {
    let contains = |sides: &[Edge; 4]| sides.iter().all(|side| side.gap_m(at) <= 0.0);
    let is_in_wall = match cell {
        Some(cell) => visible.boxes(cell).iter().any(|&wall| contains(&solids[wall as usize])),
        None => solids.iter().any(contains),
    };
    is_in_wall || polygons.len() > 0 && polygons.contains(cell, own, at)
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

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream, pose};
    use nalgebra::{Rotation2, Vector2};
    use std::f64::consts::TAU;

    /// Without any culling: every edge and every disc is compared with all beams that could hit it.
    fn slow(scene: &Scene, beams: &Beams, laser: &Isometry2<f64>, own: usize) -> Vec<f64> {
        let (Walls { solids, edges, visible }, Sorted { polygons, .. }) = (&*scene.walls, scene.sorted());
        let mut inverse = Vec::new();
        let mut hits = Hits::new(beams, laser, &mut inverse);
        edges.iter().for_each(|edge| hits.add_edge(edge));
        let seen = (0..polygons.len() as u32).map(|index| polygons.get(index));
        for polygon in seen.filter(|polygon| polygon.is_seen_by(own)) {
            polygons.edges(polygon).iter().for_each(|edge| hits.add_edge(edge));
        }
        let discs = scene.moving.discs.iter().enumerate().filter(|(robot, _)| *robot != own);
        for (_, disc) in discs.filter(|(_, disc)| disc.radius_m > 0.0) {
            let to = disc.center - laser.translation.vector;
            let power = to.coords.norm_squared() - disc.radius_m * disc.radius_m;
            if power <= 0.0 {
                hits.add_inside();
                continue;
            }
            let center = laser.rotation.inverse() * to.coords;
            hits.add_disc_to(0..beams.count, &center, power, f64::INFINITY);
        }
        let at = Point2::from(laser.translation.vector);
        if is_inside(solids, visible, polygons, visible.cell_at(&at), own, &at) {
            hits.add_inside();
        }
        inverse
    }

    /// A hall with walls at any angle, round robots, and convex bodies, some of them of robots; some reach beyond the
    /// border.
    fn scene(random: &mut RandomStream, range_m: f64) -> Scene {
        let mut point = || Point2::new(random.uniform(-0.2..12.2), random.uniform(-0.2..9.2));
        let places: Vec<_> = (0..60).map(|_| point()).collect();
        let (walls, discs, bodies) = (&places[..12], &places[12..30], &places[30..]);
        let mut walls: Vec<Rectangle> = walls
            .iter()
            .map(|at| {
                Rectangle::around(*at, Vector2::new(random.uniform(0.1..3.0), 0.1), random.uniform(0.0..3.0))
            })
            .collect();
        walls.push(Rectangle::between(Point2::new(0.0, 4.0), Point2::new(7.0, 4.1)));
        let discs = discs.iter().enumerate().map(|(robot, center)| {
            // The last six robots have corners.
            Disc { center: *center, radius_m: if robot < 12 { random.uniform(0.05..0.4) } else { 0.0 } }
        });
        let discs: Vec<Disc> = discs.collect();
        let mut scene =
            Scene::new((Point2::origin(), Point2::new(12.0, 9.0)), &walls, discs, bodies.len() + 6, range_m);
        for (index, at) in bodies.iter().chain(&places[24..30]).enumerate() {
            let robot = index.checked_sub(bodies.len()).map(|robot| robot + 12);
            let (corners, radius_m) = (random.uniform(3.0..21.0) as usize, random.uniform(0.05..0.8));
            let (turn_rad, flat) = (random.uniform(0.0..TAU), random.uniform(0.3..1.0));
            let corner = |i: usize| {
                let (sin, cos) = libm::sincos(TAU * i as f64 / corners as f64);
                at + Rotation2::new(turn_rad) * Vector2::new(cos, flat * sin) * radius_m
            };
            scene.set_polygon(index, robot, (0..corners).map(corner));
        }
        // An absent body.
        scene.set_polygon(3, None, [].into_iter());
        scene
    }

    #[test]
    fn what_is_left_out_changes_no_bit() {
        let mut random = RandomStream::new(11, Purpose::Agent);
        let (mut inside, mut nothing) = (0, 0);
        for _ in 0..40 {
            let range_m = random.uniform(0.5..12.0);
            let scene = scene(&mut random, range_m);
            for place in 0..120 {
                let count = random.uniform(1.0..200.0) as usize;
                let is_full = place % 3 == 0 && count > 1;
                let fov_rad = if is_full { TAU } else { random.uniform(0.01..6.2) };
                let gaps = if is_full { count } else { count.max(2) - 1 };
                let first_rad = if is_full { -std::f64::consts::PI } else { -fov_rad / 2.0 };
                let first_rad = if count == 1 { 0.0 } else { first_rad };
                let beams = Beams::new(first_rad, fov_rad / gaps as f64, count, range_m);
                let own = place % 18;
                // In a robot, anywhere in the hall, or beyond its border.
                let center = scene.moving.discs[own].center;
                let at = match place % 4 {
                    0 => Point2::new(random.uniform(-1.0..13.0), random.uniform(-1.0..10.0)),
                    _ => center + Vector2::new(random.uniform(-0.2..0.2), random.uniform(-0.2..0.2)),
                };
                let laser = pose(at.x, at.y, random.uniform(-4.0..4.0));
                // Beyond the range of the sensor everything counts as nothing.
                let counted = |inverse: f64| if inverse * range_m < 1.0 { 0.0 } else { inverse };
                let expected: Vec<f64> = slow(&scene, &beams, &laser, own).into_iter().map(counted).collect();
                scene.cast(&beams, &laser, own, |inverse| {
                    let found: Vec<f64> = inverse.iter().copied().map(counted).collect();
                    assert_eq!(found, expected, "at {laser}");
                });
                let most = expected.iter().fold(0.0, |most: f64, inverse| most.max(*inverse));
                let nearest = counted(scene.nearest(&beams, &laser, own));
                assert_eq!(nearest, most, "at {laser}, {count} beams over {fov_rad} rad");
                inside += usize::from(most == f64::INFINITY);
                nothing += usize::from(most == 0.0);
            }
        }
        assert!(inside > 100 && nothing > 100, "{inside} inside, {nothing} saw nothing");
    }
}
