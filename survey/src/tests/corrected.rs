//! Several logs along the poses of another SLAM, which began a map of its own in each of them.

use super::*;

/// The logs of two drives through one house, with these poses, and the true poses.
fn surveyed_drives(
    pose: PoseMode,
    poses: impl Fn(usize, usize, &LaserReading, &Isometry2<f64>) -> Isometry2<f64>,
) -> (Survey, [Vec<Isometry2<f64>>; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let drives = [drive(2, 60.0), drive(3, 60.0)];
    let log = |number: usize| {
        let (readings, truth) = &drives[number];
        let with_pose = |(index, (reading, truth)): (usize, (&LaserReading, &Isometry2<f64>))| LaserReading {
            pose: poses(number, index, reading, truth),
            ..reading.clone()
        };
        let readings: Vec<_> = readings.iter().zip(truth).enumerate().map(with_pose).collect();
        bag(&folder.path().join(format!("{number}.mcap")), &readings)
    };
    let logs = [log(0), log(1)];
    let mut survey =
        surveyed(&logs.each_ref(), &SurveySettings::of(pose), |_| ControlFlow::Continue(())).unwrap();
    for (number, log) in logs.iter().enumerate() {
        let mut replay = survey.replay(number, log).unwrap().unwrap();
        while survey.turn(&mut replay).unwrap().is_some() {}
    }
    (survey, drives.map(|(_, truth)| truth))
}

#[test]
fn corrected_logs_are_aligned_and_mapped_as_localized_ones() {
    let (localized, truth) = surveyed_drives(PoseMode::Localized, |_, _, reading, _| reading.pose);
    // The first map begins at the first pose, as that of localized logs does.
    let frames = [truth[0][0].inverse(), interfaces::pose(7.0, -4.0, 1.9)];
    let (corrected, _) = surveyed_drives(PoseMode::Corrected, |log, index, _, truth| {
        let sway_m = 0.01 * (index as f64 * 0.02).sin();
        frames[log] * truth * interfaces::pose(sway_m, -sway_m, 0.0)
    });
    for (survey, enough_m) in [(&localized, 0.03), (&corrected, 0.03)] {
        for (log, truth_of_log) in survey.logs().iter().zip(&truth) {
            let error_m = largest_error_m(log.route(), &truth[0][0], truth_of_log);
            assert!(error_m < enough_m, "{error_m} m");
        }
    }
    // Cells of what is permanent: the same in both maps, and nothing moves in this house.
    let [one, other] = [&localized, &corrected].map(|survey| permanent(survey.mapper().unwrap()));
    let mut agree = [0, 0];
    for index in 0..one.frame().len() {
        let at = one.frame().center(one.frame().cell(index));
        let Some(state) = other.get(other.frame().cell_at(&at)) else { continue };
        if one.cells()[index] != CellState::Unknown && *state != CellState::Unknown {
            agree[usize::from(one.cells()[index] == *state)] += 1;
        }
    }
    assert!(agree[1] > 5000 && agree[0] * 50 < agree[1], "{agree:?}");
    for survey in [&localized, &corrected] {
        let scans: usize = truth.iter().map(Vec::len).sum();
        let changes = survey.changes().events();
        assert!(changes as f64 <= 0.02 * scans as f64, "{changes} changes in {scans} scans");
    }
}
