//! Readings whose numbers cannot be true: no panic, and no more work than a reading that can be true.

use super::state::State;
use super::*;
use crate::constants::MAX_WORK;
use crate::trajectory::TrajectoryFinder;
use crate::work;
use interfaces::{Purpose, RandomStream, Scan, Twist, VelocitySample, heading_rad, pose};
use nalgebra::{Point2, Vector2};

/// The corners of a room of 6 m by 4 m with a corner cut out.
const CORNERS: [(f64, f64); 6] = [(0.0, 0.0), (6.0, 0.0), (6.0, 2.5), (4.5, 2.5), (4.5, 4.0), (0.0, 4.0)];

/// The range from a pose to the walls of a room with these corners.
fn range_m(corners: &[(f64, f64)], at: &Isometry2<f64>, angle_rad: f64) -> f32 {
    let (along, from) = (at.rotation * interfaces::rotation(angle_rad) * Vector2::x(), at.translation.vector);
    let hit_m = |index: usize| {
        let [a, b] =
            [index, (index + 1) % corners.len()].map(|at| Vector2::from(<[f64; 2]>::from(corners[at])));
        let across = along.perp(&(b - a));
        let (range_m, share) = ((a - from).perp(&(b - a)) / across, (a - from).perp(&along) / across);
        if range_m > 0.0 && (0.0..=1.0).contains(&share) { range_m } else { f64::INFINITY }
    };
    (0..corners.len()).map(hit_m).fold(f64::INFINITY, f64::min) as f32
}

/// A reading of a robot that drives in the room, with a scan that sweeps or not.
fn reading(number: u32, sweep_s: f64) -> LaserReading {
    reading_in(&CORNERS, number, sweep_s)
}

fn reading_in(corners: &[(f64, f64)], number: u32, sweep_s: f64) -> LaserReading {
    let at = pose(2.0 + 0.01 * f64::from(number % 40), 1.5, 0.02 * f64::from(number));
    let (mount, twist) = (pose(0.1, 0.0, 0.0), Twist { linear_mps: 0.1, angular_radps: 0.2 });
    let time_s = 0.1 * f64::from(number);
    let mut scan = Scan {
        angle_increment_rad: 2.0_f64.to_radians(),
        range_min_m: 0.05,
        range_max_m: 20.0,
        sweep_s,
        ranges_m: Vec::new(),
        ..Scan::default()
    };
    scan.ranges_m = (0..180).map(|beam| range_m(corners, &(at * mount), scan.angle_rad(beam))).collect();
    let velocities = [0.05, 0.0].map(|age_s| VelocitySample { time_s: time_s - age_s, twist }).to_vec();
    LaserReading { time_s, pose: at, twist, velocities, mount, scan }
}

/// Numbers of readings that cannot be true, among others.
fn numbers() -> Vec<f64> {
    let numbers = "NaN inf -inf 0 -0 5e-324 -1e-310 1e-200 1e-38 1e-9 1e-4 0.5 -1 4 1e3 1e5 -1e6 1e7 1e10 1e30 3e38 1e154 \
                   -1e300 1.7976931348623157e308";
    numbers.split(' ').map(|number| number.parse().unwrap()).collect()
}

/// Replaces a number of a reading.
fn replace(reading: &mut LaserReading, place: usize, number: f64, random: &mut RandomStream) {
    let LaserReading { time_s, pose, twist, velocities, mount, scan } = reading;
    match place {
        0 => *time_s = number,
        1 => pose.translation.x = number,
        2 => pose.translation.y = number,
        3 => pose.rotation = nalgebra::Unit::new_unchecked(nalgebra::Complex::new(number, 0.1)),
        4 => twist.linear_mps = number,
        5 => twist.angular_radps = number,
        6 => velocities[0].time_s = number,
        7 => velocities[0].twist.linear_mps = number,
        8 => velocities[1].twist.angular_radps = number,
        9 => mount.translation.x = number,
        10 => mount.translation.y = number,
        11 => mount.rotation = interfaces::rotation(number),
        12 => scan.angle_min_rad = number,
        13 => scan.angle_increment_rad = number,
        14 => scan.range_min_m = number,
        15 => scan.range_max_m = number,
        16 => scan.sweep_s = number,
        17 => scan.ranges_m.fill(number as f32),
        18 => scan.ranges_m[below(random, 180)] = number as f32,
        19 => scan.ranges_m.iter_mut().skip(1).step_by(2).for_each(|range_m| *range_m = number as f32),
        20 => scan.ranges_m.iter_mut().take(60).for_each(|range_m| *range_m = number as f32),
        21 => scan.ranges_m.iter_mut().for_each(|range_m| *range_m *= number as f32),
        // Beams without a return as far as this.
        22 => {
            scan.range_max_m = number.abs();
            scan.ranges_m[..60].fill(f32::INFINITY);
        }
        _ => *pose = Isometry2::new(Vector2::new(number, number), number),
    }
}

const PLACES: usize = 24;

fn below(random: &mut RandomStream, end: usize) -> usize {
    random.uniform(0.0..end as f64) as usize
}

/// The map, as a localizer sees it that has learned the room.
fn learned(sweep_s: f64) -> (Localizer, Grid<CellState>) {
    let frame = GridFrame::covering(Point2::new(-1.0, -1.0), 8.0, 6.0, 0.05).unwrap();
    let start = reading(0, sweep_s).pose;
    let mut localizer = Localizer::from_nothing(&LocalizerSettings::default(), &frame, start).unwrap();
    let mut map = Grid::filled(frame, CellState::Free);
    // Something that beams without a return pass.
    (3000..3040).for_each(|index| map.cells_mut()[index] = CellState::Blocked);
    for number in 0..30 {
        localizer.localize(&reading(number, sweep_s), &map);
    }
    assert_eq!(localizer.builder.matcher.state, State::Tracking);
    (localizer, map)
}

/// The robot is lost, and searches at the next reading.
fn get_lost(localizer: &mut Localizer) {
    let matcher = &mut localizer.builder.matcher;
    (matcher.state, matcher.relocalization.scans) = (State::Lost, u32::MAX);
    matcher.times.supported_s = f64::NEG_INFINITY;
}

/// The largest number of steps of a reading of a robot that is lost.
fn max_steps(learned: &Localizer, map: &Grid<CellState>, sweep_s: f64) -> usize {
    let mut localizer = learned.clone();
    get_lost(&mut localizer);
    let steps = (30..40).map(|number| {
        work::take();
        localizer.localize(&reading(number, sweep_s), map);
        work::take()
    });
    steps.max().unwrap()
}

#[test]
fn no_number_of_a_reading_makes_it_take_longer_or_panic() {
    let (mut random, numbers) = (RandomStream::new(110, Purpose::Agent), numbers());
    for sweep_s in [0.0, 0.1] {
        let (learned, map) = learned(sweep_s);
        // A search uses up its work, however little the scan shows.
        let most = (10 * max_steps(&learned, &map, sweep_s)).max(MAX_WORK + MAX_WORK / 8);
        for case in 0..PLACES * numbers.len() * 3 {
            let mut localizer = learned.clone();
            let mut what = Vec::new();
            for number in 30..34 {
                let mut reading = reading(number, sweep_s);
                let (place, index) = match number {
                    30 => (case % PLACES, case / PLACES % numbers.len()),
                    _ => (below(&mut random, PLACES), below(&mut random, numbers.len())),
                };
                // Beyond every pair: several together.
                if number == 30 || case >= PLACES * numbers.len() {
                    replace(&mut reading, place, numbers[index], &mut random);
                    what.push((place, numbers[index]));
                }
                work::take();
                let localized = localizer.localize(&reading, &map);
                let steps = work::take();
                assert!(steps <= most, "{what:?}: {steps} steps, {most} at most");
                let pose = localized.estimate.pose;
                let numbers = [pose.translation.x, pose.translation.y, heading_rad(&pose)];
                assert!(numbers.iter().all(|x| x.is_finite()), "{what:?}: {pose}");
            }
        }
    }
}

#[test]
fn a_trajectory_of_numbers_that_cannot_be_true_takes_no_longer() {
    let (mut random, numbers) = (RandomStream::new(111, Purpose::Agent), numbers());
    for case in 0..200 {
        let mut finder = TrajectoryFinder::new(&LocalizerSettings::of_logs()).unwrap();
        for number in 0..12 {
            let mut reading = reading(number * 5, 0.1 * f64::from(case % 2));
            if number > 2 && below(&mut random, 2) == 0 {
                let (place, index) = (below(&mut random, PLACES), below(&mut random, numbers.len()));
                replace(&mut reading, place, numbers[index], &mut random);
            }
            work::take();
            finder.add(reading);
            assert!(work::take() < 20_000_000, "case {case}");
        }
        finder.finish();
    }
}

/// A map of a place of this side, m, with the room at a point, and a larger one of the same shape elsewhere.
fn place(side_m: f64, room: Vector2<f64>) -> Grid<CellState> {
    let frame = GridFrame::covering(Point2::origin(), side_m, side_m, 0.1).unwrap();
    let mut map = Grid::filled(frame, CellState::Free);
    let is_inside =
        |x: f64, y: f64| (0.0..6.0).contains(&x) && (0.0..4.0).contains(&y) && (x < 4.5 || y < 2.5);
    for (scale, corner) in [(1.0, room), (1.5, Vector2::new(40.0, 20.0))] {
        for (column, row) in (-3..93).flat_map(|row| (-3..93).map(move |column| (column, row))) {
            let to = Vector2::new(0.1 * f64::from(column) + 0.05, 0.1 * f64::from(row) + 0.05);
            let is_near = to.x < 6.0 * scale + 0.3 && to.y < 4.0 * scale + 0.3;
            if is_near && !is_inside(to.x / scale, to.y / scale) {
                *map.get_mut(frame.cell_at(&(corner + to).into())).unwrap() = CellState::Blocked;
            }
        }
    }
    map
}

#[test]
fn a_robot_finds_itself_in_a_place_of_any_size_with_bounded_work_per_scan() {
    for side_m in [70.0, 430.0] {
        let room = Vector2::repeat(side_m - 22.0);
        let map = place(side_m, room);
        let mut localizer = Localizer::in_map(&LocalizerSettings::default(), &map, Start::Unknown).unwrap();
        let (mut most, mut scans) = (0, 0);
        while localizer.builder.matcher.state != State::Tracking && scans < 120 {
            work::take();
            // A search that goes on is saved with the rest.
            if scans % 4 == 3 {
                let snapshot = localizer.snapshot();
                let settings = LocalizerSettings::default();
                localizer = Localizer::from_nothing(&settings, map.frame(), Isometry2::identity()).unwrap();
                localizer.restore(&snapshot).unwrap();
                assert_eq!(localizer.snapshot(), snapshot);
            }
            localizer.localize(&reading(scans, 0.0), &map);
            (most, scans) = (most.max(work::take()), scans + 1);
        }
        let mut at = reading(scans - 1, 0.0).pose;
        at.translation.vector += room;
        let off = at.inv_mul(&localizer.builder.track.pose);
        assert_eq!(localizer.builder.matcher.state, State::Tracking, "{side_m} m: after {scans} scans");
        assert!(off.translation.vector.norm() < 0.05 && heading_rad(&off).abs() < 0.02, "{side_m} m: {off}");
        // The two tables of a part of 102.4 m by 102.4 m at all levels, and what the search looks up.
        let cells = 2 * (2048 + 64) * (2048 + 64) * 10 / 3;
        assert!(most < cells + MAX_WORK, "{side_m} m: {most} steps");
        println!("{side_m} m: found after {scans} scans, at most {most} steps in one");
    }
}

/// Whether the pose is certain again after a robot was carried through a small room to one that looks like the first but for a tenth.
fn is_certain_elsewhere(mut localizer: Localizer, map: &Grid<CellState>) -> bool {
    let small = [(1.5, 1.0), (3.0, 1.0), (3.0, 2.2), (1.5, 2.2)];
    let mut similar = CORNERS.to_vec();
    similar.extend([(0.0, 2.4), (0.5, 2.4), (0.5, 1.1), (0.0, 1.1)]);
    for (corners, numbers) in [(&small[..], 30..35), (&similar[..], 35..65)] {
        for number in numbers {
            localizer.localize(&reading_in(corners, number, 0.0), map);
        }
    }
    localizer.builder.matcher.state == State::Tracking
}

#[test]
fn a_place_that_looks_like_the_last_one_is_verified_longer_where_the_map_may_not_contain_it() {
    let (unfinished, map) = learned(0.0);
    let mut finished = unfinished.clone();
    finished.builder.matcher.from_nothing = false;
    assert!(!is_certain_elsewhere(unfinished, &map));
    assert!(is_certain_elsewhere(finished, &map));
}

#[test]
fn the_covariance_of_a_lost_robot_follows_the_motion_from_where_it_was() {
    let (mut localizer, map) = learned(0.0);
    get_lost(&mut localizer);
    localizer.builder.track.pose = pose(2.0, 1.5, 0.3);
    localizer.builder.track.covariance =
        Matrix3::new(0.02, 0.003, 0.001, 0.003, 0.01, -0.002, 0.001, -0.002, 0.04);
    let before = localizer.builder.track.clone();
    localizer.builder.matcher.state = State::Searching;
    let reading = reading(30, 0.0);
    let mut motion_prior = localizer.builder.motion_prior.clone();
    let measured = motion_prior.measure(&reading.pose);
    let motion = motion_prior.motion(&measured, &before.last_motion);
    let expected = motion.propagate(&before.pose, &before.covariance);
    // No hypothesis is left.
    localizer.localize(&reading, &map);
    assert_eq!(localizer.builder.track.covariance, expected);
}
