use crate::laser_check::{LaserCheck, MAX_LASERS};
use interfaces::{LaserReading, Scan, heading_rad, pose, wrap_rad};
use nalgebra::Isometry2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A rectangle with its lower left corner at the origin, m.
#[derive(Clone, Copy)]
struct Room([f64; 2]);

impl Room {
    /// The range from a point inside, m.
    fn range_m(&self, from: &Isometry2<f64>, along_rad: f64) -> f64 {
        let (sin, cos) = (heading_rad(from) + along_rad).sin_cos();
        let to_wall = |at: f64, length: f64, along: f64| {
            if along > 0.0 { (length - at) / along } else { at / along.abs().max(1e-9) }
        };
        let at = &from.translation;
        to_wall(at.x, self.0[0], cos).min(to_wall(at.y, self.0[1], sin))
    }
}

/// A route along these points: straight in steps of 0.05 m with a heading that sways, then a turn on the spot in steps of 0.08 rad.
fn route(points: &[[f64; 2]], sway_rad: f64) -> Vec<Isometry2<f64>> {
    let mut poses: Vec<Isometry2<f64>> = Vec::new();
    for pair in points.windows(2) {
        let [[x, y], [to_x, to_y]] = [pair[0], pair[1]];
        let (dx, dy) = (to_x - x, to_y - y);
        let heading = dy.atan2(dx);
        let before = poses.last().map_or(heading, heading_rad);
        let turn = wrap_rad(heading - before);
        let turns = (turn.abs() / 0.08) as usize;
        poses.extend((1..turns).map(|step| pose(x, y, before + turn * step as f64 / turns as f64)));
        let steps = (dx.hypot(dy) / 0.05) as usize;
        poses.extend((0..steps).map(|step| {
            let share = step as f64 / steps as f64;
            pose(x + dx * share, y + dy * share, heading + sway_rad * (0.3 * step as f64).sin())
        }));
    }
    poses
}

/// Readings of a laser with 360 beams and an error of up to 1 cm. `near_m`: what a beam meets before the wall, by its angle and
/// the number of the scan.
fn readings(
    room: Room,
    route: &[Isometry2<f64>],
    near_m: impl Fn(f64, usize) -> f64,
) -> impl Iterator<Item = LaserReading> {
    route.iter().enumerate().map(move |(number, at)| {
        let range_m = |beam: usize| {
            let angle_rad = -PI + TAU * beam as f64 / 360.0;
            let error_m = 0.01 * ((number * 7919 + beam * 104_729) as f64).sin();
            (room.range_m(at, angle_rad).min(near_m(angle_rad, number)) + error_m) as f32
        };
        let scan = Scan {
            angle_min_rad: -PI,
            angle_increment_rad: TAU / 360.0,
            range_min_m: 0.05,
            range_max_m: 12.0,
            ranges_m: (0..360).map(range_m).collect(),
            ..Scan::default()
        };
        // The odometry begins at the origin.
        LaserReading {
            time_s: number as f64 * 0.1,
            pose: route[0].inv_mul(at),
            scan,
            ..LaserReading::default()
        }
    })
}

fn learned(readings: impl Iterator<Item = LaserReading>) -> (LaserCheck, Vec<String>) {
    let mut check = LaserCheck::default();
    readings.for_each(|reading| check.add(&reading));
    let notes = check.judge();
    (check, notes)
}

const NOTHING: fn(f64, usize) -> f64 = |_, _| f64::INFINITY;
/// A post behind on the left; its edge is met in every other scan.
const POST: fn(f64, usize) -> f64 = |angle_rad, number| {
    let width_rad = if number.is_multiple_of(2) { 0.095 } else { 0.06 };
    if (angle_rad - 2.5).abs() < width_rad { 0.2 } else { f64::INFINITY }
};
const HALL: Room = Room([8.0, 6.0]);

fn around() -> Vec<Isometry2<f64>> {
    route(&[[1.5, 1.5], [6.5, 1.5], [6.5, 4.5], [1.5, 4.5], [1.5, 1.5]], 0.1)
}

#[test]
fn ranges_up_to_a_post_are_left_out_and_said() {
    let (check, notes) = learned(readings(HALL, &around(), POST));
    insta::assert_snapshot!(notes.join("\n"), @"the laser sees parts of the robot itself, up to 0.20 m away, in the directions 140° to 146° from the front of the robot: these ranges are left out, and what is behind them is not observed; laser_filters/LaserScanBoxFilter does the same in ROS, with the frame of the robot as box_frame and min_x: -0.22, max_x: -0.10, min_y: 0.06, max_y: 0.18, min_z: -1.0, max_z: 1.0");
    for (mut reading, free) in readings(HALL, &around(), POST).zip(readings(HALL, &around(), NOTHING)) {
        // A post that swallows a beam does not show free space.
        let behind = reading.scan.ranges_m.iter().position(|range_m| *range_m < 0.25).unwrap();
        reading.scan.ranges_m[behind] = f32::INFINITY;
        check.apply(&mut reading);
        for (found, wall) in reading.scan.ranges_m.iter().zip(&free.scan.ranges_m) {
            assert!(found.is_nan() || found == wall, "{found} {wall}");
        }
        // What is between two posts, and what is seen past one, stays.
        assert!(reading.scan.ranges_m.iter().filter(|range_m| range_m.is_nan()).count() <= 14);
    }
}

#[test]
fn a_robot_must_drive_and_turn_before_anything_is_a_part_of_it() {
    let straight = route(&[[0.5, 3.0], [7.5, 3.0]], 0.3);
    assert!(learned(readings(HALL, &straight, POST)).1.is_empty());
    let on_the_spot: Vec<_> = (0..300).map(|step| pose(4.0, 3.0, 0.1 * f64::from(step))).collect();
    assert!(learned(readings(HALL, &on_the_spot, POST)).1.is_empty());
    assert!(learned(readings(HALL, &vec![pose(1.0, 0.3, 0.0); 1000], POST)).1.is_empty());
}

#[test]
fn walls_beside_a_route_are_no_parts() {
    // Along a narrow corridor, many times.
    let ends = [[0.5, 0.5], [14.5, 0.5]];
    let up_and_down: Vec<[f64; 2]> = (0..20).map(|way| ends[way % 2]).collect();
    // Around a room with the wall always on the right.
    let corners = [[0.5, 0.5], [7.5, 0.5], [7.5, 5.5], [0.5, 5.5]];
    let rounds: Vec<[f64; 2]> = (0..20).map(|corner| corners[corner % 4]).collect();
    for sway_rad in [0.0, 0.05, 0.3] {
        for (room, points) in [(Room([15.0, 1.0]), &up_and_down), (HALL, &rounds)] {
            let (_, notes) = learned(readings(room, &route(points, sway_rad), NOTHING));
            assert!(notes.is_empty(), "{sway_rad} {notes:?}");
        }
    }
}

#[test]
fn a_person_who_follows_is_no_part() {
    // 0.5 m behind, as people walk.
    let follows = |angle_rad: f64, number: usize| {
        let time_s = number as f64 * 0.1;
        let (away_m, side_rad) = (0.5 + 0.1 * (2.1 * time_s).sin(), 0.1 * (0.7 * time_s).sin());
        if wrap_rad(angle_rad - PI - side_rad).abs() < 0.25 { away_m } else { f64::INFINITY }
    };
    assert!(learned(readings(HALL, &around(), follows)).1.is_empty());
}

#[test]
fn parts_are_known_while_the_robot_drives_and_are_said_once() {
    let (mut check, mut notes) = (LaserCheck::default(), Vec::new());
    let mut known = None;
    for (number, reading) in readings(HALL, &around(), POST).enumerate() {
        check.add(&reading);
        notes.extend(check.judge());
        known = known.or(notes.first().map(|_| number));
    }
    // After half a round.
    let half = around().iter().position(|at| heading_rad(at).abs() > FRAC_PI_2 + 0.5).unwrap();
    assert!(notes.len() == 1 && known.is_some_and(|known| known >= half), "{known:?} {half} {notes:?}");
}

#[test]
fn lasers_that_move_on_the_robot_fill_no_memory() {
    let mut check = LaserCheck::default();
    for (number, reading) in readings(HALL, &around(), POST).enumerate() {
        check.add(&LaserReading { mount: pose(0.001 * number as f64, 0.0, 0.0), ..reading });
    }
    assert_eq!((check.lasers.len(), check.judge().len()), (MAX_LASERS, 0));
}
