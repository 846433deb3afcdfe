//! Tests of the parts, and of two logs of one simulated place.

mod corrected;
mod own_parts;
mod refused;
mod scaled;

use crate::{FirstPass, LogEntry, Route, Stage, Survey, SurveyError, SurveySettings, masks, permanent};
use interfaces::{
    Cell, CellReading, CellState, Grid, GridFrame, LaserReading, PoseMode, SMALL_GRID, Scan, Twist, World,
    heading_rad,
};
use localizer::{KnownPlace, PlaceError, RouteSearch, Start, TrajectoryPose};
use logs::{Log, McapWriter, TopicChoice};
use mapper::{Mapper, MapperSettings, NoReturn, ScanFilterSettings};
use nalgebra::{Isometry2, Point2};
use sim::physics::{OdometryError, PhysicsWorld, WorldSpec};
use std::f64::consts::TAU;
use std::fs::File;
use std::ops::{ControlFlow, Range};
use std::path::Path;

fn scan(ranges_m: Vec<f32>) -> Scan {
    Scan { angle_increment_rad: TAU / 360.0, range_max_m: 20.0, ranges_m, ..Scan::default() }
}

#[test]
fn movers_are_not_permanent_and_masks_say_where_they_are() {
    for (blocked, is_usually) in [(3, false), (8, true)] {
        let frame = GridFrame::new(Point2::origin(), 0.1, 10, 1).unwrap();
        // The cells from 2 to 4 are blocked in some of 10 seconds.
        let mapper =
            watched(frame, 1000, |cell, time| (2..5).contains(&cell.x) && time % 10 < blocked || cell.x == 9);
        let map = permanent(&mapper);
        assert_eq!(map.cells()[3], CellState::Free);
        assert_eq!(map.cells()[9], CellState::Blocked);
        let [slow, keepout] = masks(&mapper);
        assert_eq!(keepout.cells()[3], if is_usually { 100 } else { 0 });
        assert_eq!(keepout.cells()[9], 0);
        // A cycle in 10 s is far more than one in 10 minutes: the slowest. The value reaches 0.5 m far.
        assert_eq!((slow.cells()[3], slow.cells()[9]), (80, 80));
    }
}

/// A map all cells of which are seen once a second: whether they are blocked.
pub(crate) fn watched(frame: GridFrame, seconds: u32, is_blocked: impl Fn(Cell, u32) -> bool) -> Mapper {
    let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
    for time in 0..seconds {
        let cells = (0..frame.len()).map(|index| (frame.cell(index), is_blocked(frame.cell(index), time)));
        let reading = CellReading { time: time.into(), pose: Isometry2::identity(), cells: cells.collect() };
        mapper.update(&reading).unwrap();
    }
    mapper
}

/// The readings by exact poses.
pub(crate) fn exact(readings: &[LaserReading], truth: &[Isometry2<f64>]) -> Vec<LaserReading> {
    let posed = |(reading, pose): (&LaserReading, &Isometry2<f64>)| LaserReading {
        pose: truth[0].inv_mul(pose),
        ..reading.clone()
    };
    readings.iter().zip(truth).map(posed).collect()
}

/// The readings of a robot that drives through a generated house, by drifting odometry, and its true poses. The house is
/// still; the drive does not depend on the seed.
pub(crate) fn drive(seed: u64, seconds: f64) -> (Vec<LaserReading>, Vec<Isometry2<f64>>) {
    let mut fleet = WorldSpec::generate_house(1003).fleet().clone();
    let mut robot = fleet.robots.swap_remove(WorldSpec::generate_house(1003).driven_index());
    robot.odometry = OdometryError { distance_gain: 0.02, turn_gain: -0.02, ..OdometryError::default() };
    fleet.robots = vec![robot];
    fleet.obstacles.clear();
    let mut world = PhysicsWorld::new(&WorldSpec::new(fleet).unwrap(), seed);
    let (mut readings, mut poses) = (Vec::new(), Vec::new());
    while world.time_s() < seconds {
        let reading = world.sense();
        let scan = &reading.scan;
        // Straight on where there is room, else turn to the left.
        let ahead =
            (0..scan.ranges_m.len()).filter(|beam| interfaces::wrap_rad(scan.angle_rad(*beam)).abs() < 0.6);
        let room_m = ahead.map(|beam| scan.ranges_m[beam]).fold(f32::INFINITY, f32::min);
        let turn = if seed.is_multiple_of(2) { 0.7 } else { -0.7 };
        let command = match room_m > 0.6 {
            true => Twist { linear_mps: 0.3, angular_radps: 0.1 * turn },
            false => Twist { linear_mps: 0.0, angular_radps: turn },
        };
        poses.push(*world.true_pose());
        readings.push(reading);
        world.act(&command);
    }
    (readings, poses)
}

pub(crate) fn first_pass(settings: &SurveySettings, readings: &[LaserReading]) -> Route {
    let mut pass = FirstPass::new(settings).unwrap();
    readings.iter().for_each(|reading| pass.add(reading.clone()));
    pass.finish()
}

/// The largest distance between true poses and those of a route whose frame has the true pose `origin`, m.
fn largest_error_m(route: &[TrajectoryPose], origin: &Isometry2<f64>, truth: &[Isometry2<f64>]) -> f64 {
    let pairs = route.iter().zip(truth);
    let error = |(at, truth): (&TrajectoryPose, &Isometry2<f64>)| {
        ((origin * at.pose).translation.vector - truth.translation.vector).norm()
    };
    pairs.map(error).fold(0.0, f64::max)
}

#[test]
fn a_later_log_finds_its_place_in_the_first_one() {
    // The pose is found on the surfaces: the side of the cells does not matter.
    let settings = SurveySettings { resolution_m: 0.15, ..SurveySettings::of(PoseMode::Localized) };
    let (readings, truth) = drive(2, 120.0);
    let first = first_pass(&settings, &readings);
    assert!(largest_error_m(&first.trajectory.poses, &truth[0], &truth) < 0.1);
    let on_route = |reading: &LaserReading, found: &TrajectoryPose| LaserReading {
        pose: found.pose,
        ..settings.scan_filter().filter(reading.clone())
    };
    let mut place = KnownPlace::new(&first.frame(&settings).unwrap());
    readings
        .iter()
        .zip(&first.trajectory.poses)
        .for_each(|(reading, found)| place.add(on_route(reading, found)));
    // The second log begins where the first one has ended, with another odometry.
    let (all, all_truth) = drive(2, 180.0);
    let (later, later_truth) = (&all[1250..], &all_truth[1250..]);
    let second = first_pass(&settings, later);
    let mut search = RouteSearch::new(&place, Start::Unknown, later.len());
    later
        .iter()
        .zip(&second.trajectory.poses)
        .for_each(|(reading, found)| search.add(on_route(reading, found)));
    let second = second.moved(&search.finish().unwrap());
    let error_m = largest_error_m(&second.trajectory.poses, &truth[0], later_truth);
    assert!(error_m < 0.015, "{error_m}");

    // A place that is another one is refused.
    let mut search = RouteSearch::new(&place, Start::Unknown, 100);
    let blind = LaserReading { scan: scan(vec![1.0; 360]), ..readings[0].clone() };
    (0..100).for_each(|_| search.add(on_route(&blind, &first.trajectory.poses[0])));
    assert_eq!(search.finish(), Err(PlaceError::Other { certain: 0, compared: 100 }));
}

/// A bag with these readings, and the time of the first ones.
pub(crate) fn bag_from(path: &Path, readings: &[LaserReading], begin_s: f64) -> Log {
    let mut writer = McapWriter::new(File::create(path).unwrap(), "bag", begin_s).unwrap();
    readings.iter().for_each(|reading| writer.reading(reading).unwrap());
    writer.finish().unwrap();
    Log::open(path, &TopicChoice::default()).unwrap()
}

fn bag(path: &Path, readings: &[LaserReading]) -> Log {
    bag_from(path, readings, 1e9)
}

fn entry(log: &Log, offset_s: f64) -> LogEntry {
    let entry = LogEntry::of(String::new(), log, &TopicChoice::default()).unwrap();
    LogEntry { offset_s, ..entry }
}

/// Learns a log, or some readings of it. Returns whether it is learned to its end.
pub(crate) fn learn(survey: &mut Survey, number: usize, log: &Log, most: usize) -> bool {
    let mut replay = survey.replay(number, log).unwrap().unwrap();
    for _ in 0..most {
        survey.turn(&mut replay).unwrap().unwrap();
        if replay.is_over() {
            return true;
        }
    }
    false
}

/// The first pass over logs, one after the other.
fn surveyed(
    logs: &[&Log],
    settings: &SurveySettings,
    mut watch: impl FnMut((Stage, usize)) -> ControlFlow<()>,
) -> Result<Survey, SurveyError> {
    let mut survey = Survey::new(settings.clone(), true);
    for (number, log) in logs.iter().enumerate() {
        let entry = entry(log, 1000.0 * number as f64);
        survey.first_pass(log, entry, number + 1 < logs.len(), &mut watch)?;
    }
    Ok(survey)
}

#[test]
fn the_first_pass_finds_the_routes_of_all_logs_in_one_frame() {
    let settings = SurveySettings::of(PoseMode::Localized);
    let (readings, truth) = drive(2, 90.0);
    let folder = tempfile::tempdir().unwrap();
    let parts = [0..600, 300..readings.len()];
    let path = |part: &Range<usize>| folder.path().join(format!("{}.mcap", part.start));
    let logs = parts.each_ref().map(|part| bag(&path(part), &readings[part.clone()]));
    let logs = logs.each_ref();
    let mut stages: Vec<(Stage, usize)> = Vec::new();
    let found = surveyed(&logs, &settings, |(stage, readings)| {
        match stages.last_mut().filter(|_| readings > 0) {
            Some(last) => *last = (stage, readings),
            None => stages.push((stage, readings)),
        }
        ControlFlow::Continue(())
    });
    // The odometry measures 2 % too much: its trajectory is found twice.
    let [trajectory, loops] = [Stage::Trajectory, Stage::Loops];
    let of_a_log = |log: usize, last| {
        [trajectory, loops, trajectory, loops, last].map(|stage| (stage, parts[log].len()))
    };
    assert_eq!(stages, [of_a_log(0, Stage::Map), of_a_log(1, Stage::Search)].concat());
    for (log, part) in found.unwrap().logs().iter().zip(&parts) {
        let error_m = largest_error_m(log.route(), &truth[0], &truth[part.clone()]);
        assert!(error_m < 0.015, "{error_m}");
    }

    let mut calls = 0;
    let interrupted = surveyed(&logs, &settings, |(_, readings)| {
        calls += 1;
        if readings == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(interrupted, Err(SurveyError::Interrupted)));
    assert_eq!(calls, 4);
}

/// A log of a laser that stands where a reading was made, and begins `begin_s` seconds after the first log.
fn standing_log(path: &Path, reading: &LaserReading, begin_s: f64) -> Log {
    let (mount, scan) = (reading.mount, &reading.scan);
    let times_s = (0..60).map(|step| f64::from(step) * 0.1);
    let readings =
        times_s.map(|time_s| LaserReading { time_s, mount, scan: scan.clone(), ..LaserReading::default() });
    bag_from(path, &readings.collect::<Vec<_>>(), 1e9 + begin_s)
}

#[test]
fn lasers_that_stand_are_compared() {
    let settings = SurveySettings::of(PoseMode::Exact);
    let (readings, truth) = drive(2, 60.0);
    let folder = tempfile::tempdir().unwrap();
    let log = |name: &str, reading: &LaserReading, begin_s: f64| {
        standing_log(&folder.path().join(name), reading, begin_s)
    };
    let first = log("first.mcap", &readings[0], 0.0);
    let route_of = |later: &Log| {
        let found = surveyed(&[&first, later], &settings, |_| ControlFlow::Continue(()));
        found.map(|survey| survey.logs()[1].route()[30].pose)
    };
    let same = route_of(&log("same.mcap", &readings[0], 100.0)).unwrap();
    assert!(same.translation.vector.norm() < 0.005 && heading_rad(&same).abs() < 0.002, "{same}");
    // The laser was carried to another place in the same room.
    let (number, expected) = (0..readings.len())
        .map(|number| (number, truth[0].inv_mul(&truth[number])))
        .find(|(_, pose)| pose.translation.vector.norm() > 0.4)
        .unwrap();
    let moved = route_of(&log("moved.mcap", &readings[number], 100.0)).unwrap();
    let off = expected.inv_mul(&moved);
    let is_near = off.translation.vector.norm() < 0.05 && heading_rad(&off).abs() < 0.03;
    assert!(is_near, "{moved}, not {expected}");
    // A place of which the first log shows nothing.
    let other = LaserReading { scan: scan(vec![1.0; 360]), ..readings[0].clone() };
    let refused = route_of(&log("other.mcap", &other, 100.0)).unwrap_err();
    assert!(matches!(refused, SurveyError::Alignment(_)), "{refused}");
}

#[test]
fn a_place_too_large_for_a_map_is_named() {
    let (mut readings, _) = drive(2, 0.2);
    readings[1].pose = interfaces::pose(300.0, 300.0, 0.0);
    let passed = |resolution_m: f64| {
        let settings = SurveySettings { resolution_m, ..SurveySettings::of(PoseMode::Exact) };
        let mut pass = FirstPass::new(&settings).unwrap();
        readings[..2].iter().for_each(|reading| pass.add(reading.clone()));
        (pass.check(), pass.finish().frame(&settings))
    };
    let (check, found) = passed(0.005);
    // Known before the pass is over.
    assert!(matches!(check, Err(SurveyError::TooLarge { .. })));
    let error = found.unwrap_err();
    let says =
        ["the place is too large for a map: at least 3", "(--resolution, at least 0.0", "(--max-range)"];
    assert!(says.iter().all(|says| error.to_string().contains(says)), "{error}");
    // What the error advises is enough.
    let SurveyError::TooLarge { enough_m, .. } = error else { panic!("{error}") };
    assert!(passed(enough_m).1.is_ok());
}

#[test]
fn a_place_of_which_too_much_is_seen_names_a_resolution_that_is_enough() {
    let (readings, _) = drive(3, 60.0);
    let folder = tempfile::tempdir().unwrap();
    let log = bag(&folder.path().join("a.mcap"), &readings);
    let mapped = |resolution_m: f64, max_bytes: usize| {
        let mut settings = SurveySettings { resolution_m, ..SurveySettings::of(PoseMode::Localized) };
        settings.mapper.max_bytes = max_bytes;
        let mut survey = Survey::new(settings, false);
        survey.first_pass(&log, entry(&log, 0.0), false, |_| ControlFlow::Continue(()))?;
        let mut replay = survey.replay(0, &log)?.unwrap();
        while survey.turn(&mut replay)?.is_some() {}
        let mapper = survey.mapper().unwrap();
        Ok::<_, SurveyError>((mapper.bytes(), mapper.frame().len() <= SMALL_GRID))
    };
    let (needed, is_small) = mapped(0.02, usize::MAX).unwrap();
    assert!(!is_small);
    // Known after the first pass, and only found out in the second one.
    for max_bytes in [needed / 3, needed - 1] {
        let error = mapped(0.02, max_bytes).unwrap_err();
        let SurveyError::TooLarge { what, enough_m } = error else { panic!("{error}") };
        let seen_m2: f64 = what.split(' ').nth(1).unwrap().parse().unwrap();
        assert!((20.0..200.0).contains(&seen_m2) && enough_m > 0.02, "{seen_m2} m², {enough_m} m");
        let (used, is_small) = mapped(enough_m, max_bytes).unwrap();
        assert!(is_small || used < max_bytes, "{used} of {max_bytes} bytes with cells of {enough_m} m");
    }
}

#[test]
fn the_second_pass_draws_the_house_without_changes() {
    let filter = ScanFilterSettings { no_return: NoReturn::Free, ..ScanFilterSettings::default() };
    let settings = SurveySettings { filter, ..SurveySettings::of(PoseMode::Localized) };
    let (readings, truth) = drive(3, 90.0);
    let count = readings.len();
    let folder = tempfile::tempdir().unwrap();
    let log = bag(&folder.path().join("a.mcap"), &readings);
    let mut survey = Survey::new(settings, false);
    survey.first_pass(&log, entry(&log, 1000.0), false, |_| ControlFlow::Continue(())).unwrap();
    let mut replay = survey.replay(0, &log).unwrap().unwrap();
    let mut seen = 0;
    while survey.turn(&mut replay).unwrap().is_some() {
        seen += 1;
    }
    let (mapper, changes, route) = (survey.mapper().unwrap(), &survey.changes, survey.logs()[0].route());
    let frame = *mapper.frame();
    assert_eq!((seen, mapper.readings()), (count, count));
    assert!((mapper.time() - 1000.0 - route.last().unwrap().time_s).abs() < 1e-9);
    // The frame covers all that was seen: no border cell is known.
    let known = |cells: &Grid<CellState>, index: usize| cells.cells()[index] != CellState::Unknown;
    let columns = frame.width();
    assert!((0..columns).all(|index| !known(mapper.states(), index)));
    assert!((0..frame.height()).all(|row| !known(mapper.states(), row * columns)));
    // Nothing moves in this house: next to nothing changes.
    let per_1000 = changes.events() as f64 * 1000.0 / count as f64;
    assert!(per_1000 <= 20.0, "{per_1000} changes per 1000 scans");
    // The robot was where the map is free.
    let to_map = route[0].pose * truth[0].inverse();
    let free = |pose: &Isometry2<f64>| {
        let at = Point2::from((to_map * pose).translation.vector);
        mapper.states().get(frame.cell_at(&at)) == Some(&CellState::Free)
    };
    assert!(truth.iter().all(free));
    assert!(heading_rad(&to_map).is_finite());
}

#[test]
fn settings_are_checked() {
    let filtering = |filter| SurveySettings { filter, ..SurveySettings::default() };
    for settings in [
        SurveySettings { resolution_m: 0.0, ..SurveySettings::default() },
        filtering(ScanFilterSettings { max_range_m: f64::NAN, ..ScanFilterSettings::default() }),
        filtering(ScanFilterSettings { min_shadow_angle_rad: -1.0, ..ScanFilterSettings::default() }),
    ] {
        assert!(matches!(FirstPass::new(&settings), Err(SurveyError::Settings(_))));
    }
    let empty = FirstPass::new(&SurveySettings::default()).unwrap().finish();
    assert!(matches!(empty.frame(&SurveySettings::default()), Err(SurveyError::NoPlace)));
}
