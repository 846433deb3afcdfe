//! A localizer in places that it was not tuned on: how many scans a robot at an unknown pose of a large place needs, and the
//! CPU time of the slowest of them (Linux; the time of this thread, not that of the clock).
//!
//! ```text
//! cargo run -p curious-localizer --example attack -- [SIDE_M CELL_M RANGE_MAX_M SEED]
//! ```

use interfaces::{Cell, CellState, Grid, GridFrame, LaserReading, Purpose, RandomStream, Scan, Twist, pose};
use localizer::{Localizer, LocalizerSettings, PoseState, Start};
use nalgebra::{Isometry2, Point2, Vector2};

/// The CPU time of this thread so far, ms.
fn cpu_ms() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e6
}

fn reading(time_s: f64, odometry: Isometry2<f64>, range_max_m: f64, ranges_m: Vec<f32>) -> LaserReading {
    let angle_increment_rad = std::f64::consts::TAU / ranges_m.len() as f64;
    let (range_min_m, sweep_s) = (0.05, 0.0);
    let scan = Scan { angle_min_rad: 0.0, angle_increment_rad, range_min_m, range_max_m, sweep_s, ranges_m };
    let (twist, velocities, mount) = (Twist::STOP, Vec::new(), Isometry2::identity());
    LaserReading { time_s, pose: odometry, twist, velocities, mount, scan }
}

/// Rooms of about 12 m with doors, and boxes; all at random.
fn place(side_m: f64, cell_m: f64, seed: u64) -> Grid<CellState> {
    let mut random = RandomStream::new(seed, Purpose::WorldGenerator);
    let frame = GridFrame::covering(Point2::origin(), side_m, side_m, cell_m).expect("a valid frame");
    let mut map = Grid::filled(frame, CellState::Free);
    let mut block = |x: f64, y: f64, width: f64, height: f64| {
        let cells = |m: f64| (m / cell_m).round() as i32;
        for (y, x) in (cells(y)..cells(y + height).max(cells(y) + 1))
            .flat_map(|y| (cells(x)..cells(x + width).max(cells(x) + 1)).map(move |x| (y, x)))
        {
            if let Some(state) = map.get_mut(Cell::new(x, y)) {
                *state = CellState::Blocked;
            }
        }
    };
    let rooms = (side_m / 12.0) as u32;
    for (row, column) in (0..=rooms).flat_map(|row| (0..=rooms).map(move |column| (row, column))) {
        let (x, y) = (12.0 * f64::from(column), 12.0 * f64::from(row));
        for is_upright in [false, true] {
            let (wall_m, door_m) = (random.uniform(-1.5..1.5), random.uniform(1.0..9.0));
            for (from_m, to_m) in [(0.0, door_m), (door_m + 1.2, 12.0)] {
                let length_m = to_m - from_m;
                if is_upright {
                    block(x + wall_m, y + from_m, 0.2, length_m);
                } else {
                    block(x + from_m, y + wall_m, length_m, 0.2);
                }
            }
        }
        for _ in 0..4 {
            let [x, y] = [x, y].map(|m| m + random.uniform(2.0..10.0));
            block(x, y, random.uniform(0.3..1.5), random.uniform(0.3..1.5));
        }
    }
    map
}

fn cast(map: &Grid<CellState>, at: &Isometry2<f64>, range_max_m: f64) -> Vec<f32> {
    let step_m = map.frame().resolution_m().min(0.1) / 4.0;
    let range = |beam: u32| {
        let along = at.rotation * interfaces::rotation(f64::from(beam).to_radians()) * Vector2::x();
        let point = |step: u32| Point2::from(at.translation.vector + along * (f64::from(step) * step_m));
        let is_hit = |step: &u32| map.get(map.frame().cell_at(&point(*step))) != Some(&CellState::Free);
        let hit = (1..(range_max_m / step_m) as u32).find(is_hit);
        hit.map_or(f32::INFINITY, |step| (f64::from(step) * step_m) as f32)
    };
    (0..360).map(range).collect()
}

/// The next pose of a robot that drives slowly ahead where its scan shows free space, and turns where it does not.
fn driven(at: &Isometry2<f64>, ranges_m: &[f32]) -> Isometry2<f64> {
    let ahead = ranges_m[..45].iter().chain(&ranges_m[315..]);
    let is_free = ahead.fold(f32::INFINITY, |nearest, range_m| nearest.min(*range_m)) > 0.6;
    at * if is_free { pose(0.03, 0.0, 0.0) } else { pose(0.0, 0.0, 0.1) }
}

/// A robot that starts at an unknown pose, with perfect odometry.
fn search(side_m: f64, cell_m: f64, range_max_m: f64, seed: u64) {
    let map = place(side_m, cell_m, seed);
    let mut random = RandomStream::new(seed + 1, Purpose::WorldGenerator);
    let is_free = |at: &Isometry2<f64>| cast(&map, at, 1.0).iter().all(|range_m| *range_m > 0.5);
    let mut draw = || {
        pose(random.uniform(2.0..side_m - 2.0), random.uniform(2.0..side_m - 2.0), random.uniform(-3.0..3.0))
    };
    let start = (0..1000).map(|_| draw()).find(is_free).expect("a free place");
    let begin_ms = cpu_ms();
    let mut localizer =
        Localizer::in_map(&LocalizerSettings::default(), &map, Start::Unknown).expect("a valid map");
    let build_ms = cpu_ms() - begin_ms;
    let (mut times_ms, mut estimate, mut at) = (Vec::new(), None, start);
    for scan in 0..6000 {
        let ranges_m = cast(&map, &at, range_max_m);
        let next = driven(&at, &ranges_m);
        let reading = reading(0.1 * f64::from(scan), start.inv_mul(&at), range_max_m, ranges_m);
        let begin_ms = cpu_ms();
        let found = localizer.localize(&reading, &map).estimate;
        times_ms.push(cpu_ms() - begin_ms);
        let is_over = found.state == PoseState::Tracking;
        estimate = Some(found);
        if is_over {
            break;
        }
        at = next;
    }
    let (is_found, off_m, spread_m) = estimate.map_or((false, 0.0, 0.0), |found| {
        let off_m = (found.pose.translation.vector - at.translation.vector).norm();
        (found.state == PoseState::Tracking, off_m, found.position_std_m())
    });
    let off =
        if is_found { format!("{off_m:.2}") } else { format!("not found ({off_m:.2} ± {spread_m:.0})") };
    let scans = times_ms.len();
    times_ms.sort_by(f64::total_cmp);
    let [median, most] = [times_ms[scans / 2], times_ms[scans - 1]];
    println!(
        "| {side_m} | {cell_m} | {range_max_m} | {off} | {scans} | {median:.0} | {most:.0} | {build_ms:.0} |"
    );
}

fn main() {
    let arguments: Vec<f64> = std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    if let [side_m, cell_m, range_max_m, seed] = arguments[..] {
        return search(side_m, cell_m, range_max_m, seed as u64);
    }
    println!(
        "| side, m | cell, m | range, m | off, m | scans | CPU per scan, ms: median | most | to build |\n|---|---|---|---|---|---|---|---|"
    );
    for (side_m, cell_m) in [
        (60.0, 0.02),
        (60.0, 0.05),
        (200.0, 0.05),
        (350.0, 0.1),
        (420.0, 0.1),
        (700.0, 0.1),
        (1000.0, 0.2),
        (1000.0, 0.5),
    ] {
        for (range_max_m, seed) in [(30.0, 1), (8.0, 2)] {
            search(side_m, cell_m, range_max_m, seed);
        }
    }
}
