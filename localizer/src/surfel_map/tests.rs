use super::prior::borders;
use super::*;
use crate::constants::{FROZEN_SCANS, USABLE_SCANS};
use crate::scan_points::{PointRules, ScanPoint, ScanPoints};
use crate::work;
use interfaces::{Cell, CellState, Grid, LaserReading, Purpose, RandomStream, Scan};
use nalgebra::Isometry2;

const RULES: PointRules = PointRules { noise_m: 0.01, grazing: true };

fn frame() -> GridFrame {
    GridFrame::new(Point2::new(-1.0, -5.0), 0.05, 200, 200).unwrap()
}

/// The scan of a straight wall: the line with the unit normal at `angle_rad`, `distance_m` from the laser.
fn wall(angle_rad: f64, distance_m: f64, noise: &mut RandomStream) -> LaserReading {
    let angle = |beam: usize| -1.0 + 0.01 * beam as f64;
    let range = |beam: usize| (distance_m / (angle(beam) - angle_rad).cos() + 0.01 * noise.normal()) as f32;
    LaserReading {
        scan: Scan {
            angle_min_rad: -1.0,
            angle_increment_rad: 0.01,
            range_min_m: 0.1,
            range_max_m: 10.0,
            ranges_m: (0..200).map(range).collect(),
            ..Scan::default()
        },
        ..LaserReading::default()
    }
}

/// Updates a map with a scan, as a live match does.
fn learn(map: &mut SurfelMap, points: &[ScanPoint], is_certain: bool) {
    let scans = if map.is_empty() { USABLE_SCANS } else { 1 };
    map.learn(points, &Isometry2::identity(), 0.01, scans, is_certain);
}

#[test]
fn surfels_lie_on_the_line_of_the_wall() {
    let mut noise = RandomStream::new(200, Purpose::LaserNoise(0));
    for (angle_rad, distance_m) in [(0.0, 2.0), (0.3, 3.0), (-0.5, 1.2)] {
        let mut map = SurfelMap::new(&frame());
        let mut points = ScanPoints::default();
        for _ in 0..100 {
            let points = points.of(&wall(angle_rad, distance_m, &mut noise), |_| 1.0, &RULES);
            learn(&mut map, &points, true);
        }
        let normal = interfaces::rotation(angle_rad) * Vector2::x();
        let seen: Vec<&Surfel> = map.usable().filter(|surfel| surfel.scans >= 50).collect();
        assert!(seen.len() > 8, "{}", seen.len());
        for surfel in seen {
            let off_m = surfel.at.coords.dot(&normal) - distance_m;
            assert!(off_m.abs() < 0.004, "{angle_rad}: {off_m} m");
            assert!(surfel.normal.dot(&normal) < -0.9995, "{angle_rad}: {}", surfel.normal.transpose());
        }
    }
}

#[test]
fn a_surfel_freezes() {
    let mut map = SurfelMap::new(&frame());
    see(&mut map, &[on_wall(1.0, 0.55)], FROZEN_SCANS);
    let before = *map.surfel(0);
    see(&mut map, &[on_wall(1.02, 0.55)], 1000);
    assert_eq!(map.surfel(0).at, before.at);
    assert_eq!(map.usable().count(), 1, "a second wall beside the first is an error of the pose");
}

/// A point of a wall across the x axis, from the free side.
fn on_wall(x_m: f64, y_m: f64) -> ScanPoint {
    ScanPoint::new(Point2::new(x_m, y_m), -Vector2::x())
}

/// Learns from some scans of points, at the pose where the robot stands.
fn see(map: &mut SurfelMap, points: &[ScanPoint], scans: u32) {
    (0..scans).for_each(|_| learn(map, points, true));
}

/// A wall, 1 m long.
fn wall_at(x_m: f64) -> Vec<ScanPoint> {
    (0..20).map(|at| on_wall(x_m, 0.05 * f64::from(at))).collect()
}

fn learned(x_m: f64, scans: u32) -> SurfelMap {
    let mut map = SurfelMap::new(&frame());
    see(&mut map, &wall_at(x_m), scans);
    map
}

#[test]
fn a_surfel_follows_its_surface() {
    let mut map = learned(1.0, 100);
    assert!(map.usable().all(|surfel| surfel.is_permanent() && surfel.weight() == 1.0));
    see(&mut map, &wall_at(1.06), 2);
    assert!(map.usable().all(Surfel::is_permanent), "two scans are no proof");
    see(&mut map, &wall_at(1.06), 20);
    assert!(map.usable().count() > 5);
    for surfel in map.usable() {
        assert!((surfel.at.x - 1.06).abs() < 1e-6, "{}", surfel.at.x);
        assert!(surfel.is_suspect() && surfel.weight() < 0.05);
    }
    // It follows at once from now on, and counts fully again after ten minutes in one place.
    see(&mut map, &wall_at(1.0), 6100);
    assert!(map.usable().all(|surfel| (surfel.at.x - 1.0).abs() < 1e-6 && surfel.is_permanent()));
}

#[test]
fn a_surfel_does_not_follow_a_surface_seen_from_an_uncertain_pose_or_far_away() {
    let (mut uncertain, mut far) = (learned(1.0, 100), learned(1.0, 100));
    for _ in 0..50 {
        learn(&mut uncertain, &wall_at(1.06), false);
        learn(&mut far, &wall_at(1.2), true);
    }
    for map in [uncertain, far] {
        assert!(map.usable().all(|surfel| (surfel.at.x - 1.0).abs() < 1e-9 && surfel.is_permanent()));
    }
}

#[test]
fn what_is_out_of_view_of_a_coherent_motion_is_doubted_until_it_is_seen() {
    // Two walls: one is seen to move by 6 cm, the other is seen only later.
    let other: Vec<ScanPoint> = (0..20).map(|at| on_wall(3.0, 2.0 + 0.05 * f64::from(at))).collect();
    let mut map = SurfelMap::new(&frame());
    see(&mut map, &[wall_at(1.0), other.clone()].concat(), 100);
    let follower = Isometry2::translation(-0.06, 0.0);
    map.displace_all(&wall_at(1.06), &Isometry2::identity(), &follower, 0.01);
    assert!(map.usable().all(Surfel::is_suspect));
    let moved = |surfel: &&Surfel| surfel.at.x < 2.0;
    assert!(map.usable().filter(moved).all(|surfel| (surfel.at.x - 1.06).abs() < 1e-9));
    see(&mut map, &other, 1);
    assert!(map.usable().filter(|surfel| !moved(surfel)).all(Surfel::is_permanent));
    assert!(map.usable().filter(moved).all(Surfel::is_suspect));
}

#[test]
fn what_beams_pass_is_removed() {
    let mut noise = RandomStream::new(201, Purpose::LaserNoise(0));
    let (mut map, mut points, mut checker) =
        (SurfelMap::new(&frame()), ScanPoints::default(), Checker::default());
    let mut see = |map: &mut SurfelMap, distance_m: f64| {
        let reading = wall(0.0, distance_m, &mut noise);
        learn(map, &points.of(&reading, |_| 1.0, &RULES), true);
        checker.check(map, &reading, &Isometry2::identity());
    };
    for _ in 0..50 {
        see(&mut map, 2.0);
    }
    let near = |map: &SurfelMap| map.usable().filter(|surfel| surfel.at.x < 2.5).count();
    let stood = near(&map);
    for _ in 0..300 {
        see(&mut map, 4.0);
    }
    assert!(stood > 20 && near(&map) < stood / 5, "{} of {stood} are left", near(&map));
}

#[test]
fn the_surfels_of_a_known_map_lie_on_its_borders() {
    let mut grid = Grid::filled(frame(), CellState::Free);
    let is_wall = |at: Point2<f64>| (at.y - 0.2 * at.x).abs() < 0.15;
    for index in 0..grid.frame().len() {
        if is_wall(grid.frame().center(grid.frame().cell(index))) {
            grid.cells_mut()[index] = CellState::Blocked;
        }
    }
    let map = SurfelMap::from_grid(&grid);
    let normal = Vector2::new(-0.2, 1.0).normalize();
    let offsets: Vec<f64> = map.usable().map(|surfel| surfel.at.coords.dot(&normal).abs()).collect();
    assert!(offsets.len() > 100);
    let half_m = 0.15 * normal.y;
    let close = offsets.iter().filter(|off_m| (*off_m - half_m).abs() < 0.03).count();
    assert!(close * 10 > offsets.len() * 9, "{close} of {}", offsets.len());
}

#[test]
fn the_surfaces_of_a_map_with_large_cells_have_no_gaps() {
    for resolution_m in [0.05, 0.2, 0.25, 0.5, 1.0] {
        let frame = GridFrame::new(Point2::origin(), resolution_m, 20, 20).unwrap();
        let mut grid = Grid::filled(frame, CellState::Free);
        (0..20).for_each(|x| *grid.get_mut(Cell::new(x, 10)).unwrap() = CellState::Blocked);
        let map = SurfelMap::from_grid(&grid);
        for step in 100..1900 {
            let at = Point2::new((f64::from(step) + 0.37) * 0.01, 10.0) * resolution_m;
            let found = map.nearest(&at, &-Vector2::y(), 0.01);
            assert!(found.is_some(), "no surface at {at} with cells of {resolution_m} m");
        }
        // At a corner as well, the surfaces are those of the cells.
        *grid.get_mut(Cell::new(10, 9)).unwrap() = CellState::Blocked;
        let corner = SurfelMap::from_grid(&grid);
        let face = Point2::new(10.5, 9.0) * resolution_m;
        let is_sharp =
            corner.nearest(&face, &-Vector2::y(), 0.01).is_some_and(|(_, off_m)| off_m.abs() < 1e-9);
        assert!(is_sharp || resolution_m < 0.25, "the face at {face} with cells of {resolution_m} m");
    }
}

/// A map of this side, of which a third of the cells are blocked by chance.
fn noisy(cells: usize, resolution_m: f64) -> Grid<CellState> {
    let mut random = RandomStream::new(201, Purpose::WorldGenerator);
    let frame = GridFrame::new(Point2::new(-1.3, 0.7), resolution_m, cells, cells).unwrap();
    let state = |_| if random.bernoulli(0.3) { CellState::Blocked } else { CellState::Free };
    Grid::from_cells(frame, (0..frame.len()).map(state).collect()).unwrap()
}

#[test]
fn the_surfaces_of_a_known_map_are_those_of_all_its_borders() {
    // Up to the size at which a border is one surfel.
    for resolution_m in [0.02, 0.05, 0.1] {
        let grid = noisy(40, resolution_m);
        let (borders, mut simple) = (borders(&grid), SurfelMap::new(grid.frame()));
        let reach = 0.15_f64.max(1.5 * resolution_m);
        for (_, at, outward) in &borders {
            let near = |other: &Point2<f64>| (other - at).norm_squared() <= reach * reach;
            let around =
                borders.iter().filter(|(_, other, normal)| near(other) && normal.dot(outward) >= 0.0);
            let (mut sum, mut normal, mut count) = (Vector2::zeros(), Vector2::zeros(), 0.0);
            around.for_each(|other| {
                (sum, normal, count) = (sum + (other.1 - at), normal + other.2, count + 1.0)
            });
            if count < 2.0 || normal.norm() < 1e-9 {
                continue;
            }
            let (middle, normal) = (at + sum / count, normal / normal.norm());
            let foot = at - normal * normal.dot(&(at - middle));
            if simple.nearest(&foot, &normal, 0.05).is_none() {
                simple.add(foot, normal, 20);
            }
        }
        assert!(simple.surfels.len() > 100);
        assert_eq!(SurfelMap::from_grid(&grid).surfels, simple.surfels, "{resolution_m} m");
    }
}

#[test]
fn a_noisy_map_takes_as_long_as_it_is_large() {
    let steps = |cells: usize| {
        work::take();
        SurfelMap::from_grid(&noisy(cells, 0.05));
        work::take()
    };
    // Sixteen times as many cells.
    let (small, large) = (steps(100), steps(400));
    assert!(large < 18 * small, "{small} steps, {large} of a larger map");
}

#[test]
fn cells_are_as_small_as_a_frame_allows() {
    let origin = Point2::new(3.0, -2.0);
    for (resolution_m, cells, expected_m) in [(0.05, 200, 0.1), (1.0, 2000, 0.4), (8.0, 8192, 12.8)] {
        let frame = GridFrame::new(origin, resolution_m, cells, cells).unwrap();
        let fitted = fitted(&frame, SURFEL_M, 1);
        let end = frame.origin() + Vector2::repeat(resolution_m * cells as f64);
        assert_eq!(fitted.resolution_m(), expected_m);
        assert!(fitted.contains(fitted.cell_at(&origin)) && fitted.contains(fitted.cell_at(&end)));
    }
}
