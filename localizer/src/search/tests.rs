use super::squares::cells;
use super::*;
use crate::constants::{MAX_WORK, TOP};
use crate::surfel_map::{Surfel, SurfelMap};
use interfaces::{CellState, Grid, Purpose, RandomStream};
use interfaces::{GridFrame, heading_rad};
use nalgebra::Vector2;

/// A map of random walls, and the points that a scan at a pose has of it.
fn random_room(seed: u64) -> (ScoreGrid, Vec<ScanPoint>) {
    let (surfels, grid, _, points) = room(seed);
    (ScoreGrid::around(&surfels, &grid, &Point2::new(2.0, 1.5), 4.0), points)
}

/// The surfels, the states, the pose, and the points that a scan has there.
fn room(seed: u64) -> (SurfelMap, Grid<CellState>, Isometry2<f64>, Vec<ScanPoint>) {
    let mut random = RandomStream::new(seed, Purpose::WorldGenerator);
    let frame = GridFrame::covering(Point2::origin(), 4.0, 3.0, 0.1).unwrap();
    let mut grid = Grid::filled(frame, CellState::Free);
    for _ in 0..6 {
        let (x, y) = (random.uniform(0.0..35.0) as i32, random.uniform(0.0..25.0) as i32);
        for cell in (0..8).map(|step| if x % 2 == 0 { (x + step, y) } else { (x, y + step) }) {
            if let Some(state) = grid.get_mut(Cell::new(cell.0, cell.1)) {
                *state = CellState::Blocked;
            }
        }
    }
    let surfels = SurfelMap::from_grid(&grid);
    let pose = interfaces::pose(2.0, 1.5, random.uniform(-3.0..3.0));
    let point = |surfel: &Surfel| ScanPoint::new(pose.inverse_transform_point(&surfel.at), Vector2::x());
    let points = surfels.usable().map(point).collect();
    (surfels, grid, pose, points)
}

#[test]
fn a_search_finds_the_pose_in_cells_of_any_size() {
    for (seed, cell_m) in (200..206).flat_map(|seed| [0.05, 0.07, 0.1].map(move |cell_m| (seed, cell_m))) {
        let (surfels, _, pose, points) = room(seed);
        let frame = GridFrame::covering(surfels.frame.origin(), 4.2, 3.2, cell_m).unwrap();
        let grid = ScoreGrid::of_frame(&surfels, frame);
        let found = search(&mut { MAX_WORK }, &grid, &points, &Window::of(&frame), (0.5, 1.0))[0];
        let off = pose.inv_mul(&found);
        let is_right = off.translation.vector.norm() < 2.0 * cell_m && heading_rad(&off).abs() < cell_m;
        assert!(is_right, "seed {seed}, {cell_m} m: {off}");
    }
}

#[test]
fn branch_and_bound_finds_what_exhaustive_search_finds() {
    for seed in 200..206 {
        let (grid, points) = random_room(seed);
        let window = Window { pose: interfaces::pose(1.8, 1.4, 0.3), reach_m: 0.8, reach_rad: 0.4 };
        for window in [Window::of(&grid.frame), window] {
            let search = || Search::new(&points, window, 0.0, 1.0);
            let mut found = search();
            assert!(found.pass(&grid, &mut { usize::MAX }));
            assert_eq!(found.found[0].bound, exhaustive(&grid, &search()), "{seed}: {window:?}");
        }
    }
}

/// The best score of all poses.
fn exhaustive(grid: &ScoreGrid, search: &Search) -> u32 {
    let (squares, (low, high)) = (Squares::new(search, grid), cells(&grid.frame, &search.window));
    let positions = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (x, y)));
    let at = |(x, y)| {
        let headings = 0..headings(&search.window, grid).len();
        headings
            .filter_map(|heading| squares.node(0, heading, (x, y), 0, &mut { usize::MAX }))
            .collect::<Vec<_>>()
    };
    positions.flat_map(at).map(|node| node.bound).max().unwrap_or(0)
}

#[test]
fn every_bound_is_above_all_scores_in_its_square() {
    let (grid, _) = random_room(210);
    for level in 0..=TOP {
        for (x, y) in [(-40, -30), (0, 0), (3, 17), (41, 29)] {
            let most = |from: i32, to: i32| {
                let cells = (from..to).flat_map(|down| (from..to).map(move |right| (x + right, y + down)));
                cells.map(|(x, y)| grid.scores[0].bound(x, y)).max().unwrap()
            };
            let (side, beyond) = (1 << level, (1 << level) / 4 - 1);
            let bound = grid.scores[level].bound(x, y);
            assert!(bound >= most(0, side), "level {level} at {x}, {y}");
            assert!(bound <= most(-beyond.max(0), side + beyond.max(0)), "level {level} at {x}, {y}");
        }
    }
}

#[test]
fn a_search_that_is_interrupted_finds_the_same() {
    let (grid, points) = random_room(203);
    let begin = || Search::new(&points, Window::of(&grid.frame), 0.5, 0.5);
    let (mut once, mut search) = (begin(), begin());
    assert!(once.pass(&grid, &mut { usize::MAX }));
    let (mut left, mut scans) = (20_000, 1);
    while !search.pass(&grid, &mut left) {
        (left, scans) = (20_000, scans + 1);
    }
    let poses = once.candidates(&grid);
    assert!(scans > 10 && poses.len() > 1, "{scans} scans");
    assert_eq!(search.candidates(&grid), poses);
}
