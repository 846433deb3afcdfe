//! Several logs along the poses of another SLAM, which began a map of its own in each of them.

use super::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;

/// A CARMEN log with the poses of the readings in its FLASER lines, and other ones in its ODOM lines.
fn carmen(path: &Path, readings: &[LaserReading], odometry: &[LaserReading]) -> Log {
    let mut text = String::new();
    let words = |pose: &Isometry2<f64>| {
        format!("{:.6} {:.6} {:.6}", pose.translation.x, pose.translation.y, heading_rad(pose))
    };
    for (LaserReading { time_s, pose, mount, scan, .. }, odometry) in readings.iter().zip(odometry) {
        let time_s = format!("{:.3}", 1e9 + time_s);
        writeln!(text, "ODOM {} 0 0 0 {time_s} h {time_s}", words(&odometry.pose)).unwrap();
        // Half a turn ahead, from right to left.
        let beam = |number: u32| {
            let angle_rad = f64::from(number) * PI / 360.0 - FRAC_PI_2;
            let beam = ((angle_rad - scan.angle_min_rad) / scan.angle_increment_rad).round() as usize;
            format!("{:.3} ", scan.ranges_m[beam % scan.ranges_m.len()].min(81.0))
        };
        let ranges: String = (0..360).map(beam).collect();
        let laser = words(&(pose * mount));
        writeln!(text, "FLASER 360 {ranges}{laser} {laser} {time_s} h {time_s}").unwrap();
    }
    std::fs::write(path, text).unwrap();
    Log::open(path, &TopicChoice { is_corrected: true, ..TopicChoice::default() }).unwrap()
}

/// The logs of two drives through one house, with these poses, and the true poses. `is_carmen`: as CARMEN logs, otherwise as bags.
fn surveyed_drives(
    pose: PoseMode,
    is_carmen: bool,
    poses: impl Fn(usize, usize, &LaserReading, &Isometry2<f64>) -> Isometry2<f64>,
) -> (Survey, [Vec<Isometry2<f64>>; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let drives = [drive(2, 60.0), drive(3, 60.0)];
    let log = |number: usize| {
        let (odometry, truth) = &drives[number];
        let with_pose = |(index, (reading, truth)): (usize, (&LaserReading, &Isometry2<f64>))| LaserReading {
            pose: poses(number, index, reading, truth),
            ..reading.clone()
        };
        let readings: Vec<_> = odometry.iter().zip(truth).enumerate().map(with_pose).collect();
        match is_carmen {
            true => carmen(&folder.path().join(format!("{number}.log")), &readings, odometry),
            false => bag(&folder.path().join(format!("{number}.mcap")), &readings),
        }
    };
    let logs = [log(0), log(1)];
    let mut survey =
        surveyed(&logs.each_ref(), &SurveySettings::of(pose), |_| ControlFlow::Continue(())).unwrap();
    for (number, log) in logs.iter().enumerate() {
        assert!(learn(&mut survey, number, log, usize::MAX));
    }
    (survey, drives.map(|(_, truth)| truth))
}

#[test]
fn corrected_logs_are_aligned_and_mapped_as_localized_ones() {
    let (localized, truth) = surveyed_drives(PoseMode::Localized, false, |_, _, reading, _| reading.pose);
    // The first map begins at the first pose, as that of localized logs does.
    let frames = [truth[0][0].inverse(), interfaces::pose(7.0, -4.0, 1.9)];
    let corrected = [false, true].map(|is_carmen| {
        let (survey, _) = surveyed_drives(PoseMode::Corrected, is_carmen, |log, index, _, truth| {
            let sway_m = 0.01 * (index as f64 * 0.02).sin();
            frames[log] * truth * interfaces::pose(sway_m, -sway_m, 0.0)
        });
        survey
    });
    for survey in [&localized, &corrected[0], &corrected[1]] {
        for (log, truth_of_log) in survey.logs().iter().zip(&truth) {
            let error_m = largest_error_m(log.route(), &truth[0][0], truth_of_log);
            assert!(error_m < 0.03, "{error_m} m");
        }
        let scans: usize = truth.iter().map(Vec::len).sum();
        let changes = survey.changes.events();
        assert!(changes as f64 <= 0.02 * scans as f64, "{changes} changes in {scans} scans");
    }
    corrected.iter().for_each(|corrected| assert_same_walls(&localized, corrected));
}

/// What is permanent has the same cells in both maps: nothing moves in this house.
fn assert_same_walls(one: &Survey, other: &Survey) {
    let [one, other] = [one, other].map(|survey| permanent(survey.mapper().unwrap()));
    let mut agree = [0, 0];
    for index in 0..one.frame().len() {
        let at = one.frame().center(one.frame().cell(index));
        let Some(state) = other.get(other.frame().cell_at(&at)) else { continue };
        if one.cells()[index] != CellState::Unknown && *state != CellState::Unknown {
            agree[usize::from(one.cells()[index] == *state)] += 1;
        }
    }
    assert!(agree[1] > 5000 && agree[0] * 50 < agree[1], "{agree:?}");
}
