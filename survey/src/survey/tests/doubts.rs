//! Changes in stretches whose poses are in doubt, and changes elsewhere.

use super::{add, bag, learn};
use crate::quality::Verdict;
use crate::settings::SurveySettings;
use crate::survey::Survey;
use crate::tests::drive;
use interfaces::{LaserReading, PoseMode, pose};
use localizer::PoseState;
use nalgebra::{Isometry2, Point2, Vector2};
use std::ops::Range;

/// The radius of a thing that is put down, m.
const RADIUS_M: f64 = 0.2;

/// The readings of a still house with a thing that stands at a place from a reading on, by exact poses, which are 0.5 m too far to
/// the side in a stretch.
fn readings(put_down: usize, place: &Point2<f64>, off: &Range<usize>) -> Vec<LaserReading> {
    let (mut readings, truth) = drive(2, 240.0);
    for (number, (reading, at)) in readings.iter_mut().zip(&truth).enumerate() {
        if number >= put_down {
            see(reading, at, place);
        }
        let off_m = if off.contains(&number) { 0.5 } else { 0.0 };
        reading.pose = truth[0].inv_mul(&(pose(0.0, off_m, 0.0) * at));
    }
    readings
}

/// Shortens the beams that meet a round thing.
fn see(reading: &mut LaserReading, at: &Isometry2<f64>, place: &Point2<f64>) {
    let to = (at * reading.mount).inverse() * place;
    for beam in 0..reading.scan.ranges_m.len() {
        let direction = interfaces::rotation(reading.scan.angle_rad(beam)) * Vector2::x();
        let along_m = direction.dot(&to.coords);
        let square = RADIUS_M * RADIUS_M - (to.coords.norm_squared() - along_m * along_m);
        let range_m = along_m - square.max(0.0).sqrt();
        if square > 0.0 && range_m > 0.0 && range_m < f64::from(reading.scan.ranges_m[beam]) {
            reading.scan.ranges_m[beam] = range_m as f32;
        }
    }
}

/// The verdict on a survey of these readings, and the number of cells that changed: within 0.5 m of a place, and elsewhere.
/// `all_count`: whether scans in doubt count as well.
fn learned(readings: &[LaserReading], place: &Point2<f64>, all_count: bool) -> (Verdict, [usize; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let log = bag(folder.path(), "a", readings, 0.0);
    let settings = SurveySettings { resolution_m: 0.1, ..SurveySettings::of(PoseMode::Exact) };
    let mut survey = Survey::new(settings, false);
    add(&mut survey, &log, "a", 0.0);
    if all_count {
        survey.logs[0].poses.iter_mut().for_each(|at| at.state = PoseState::Tracking);
    }
    assert!(learn(&mut survey, 0, &log, usize::MAX));
    let (mapper, changes) = (survey.mapper().unwrap(), &survey.changes);
    let frame = mapper.frame();
    let changed = (0..frame.len()).filter(|index| changes.last_s(*index).is_some());
    let (near, elsewhere): (Vec<usize>, Vec<usize>) =
        changed.partition(|index| (frame.center(frame.cell(*index)) - place).norm() < 0.5);
    (survey.verdict(), [near.len(), elsewhere.len()])
}

/// A thing that is put down is a change; the walls that a robot sees twice, since its pose is wrong for five seconds, are none.
#[test]
fn what_only_doubtful_scans_show_is_no_change() {
    let place = Point2::from(drive(2, 30.0).1[300 - 1].translation.vector);
    let [right, wrong] = [0..0, 1500..1550].map(|off| readings(1200, &place, &off));
    let place = drive(2, 0.2).1[0].inverse() * place;
    let (verdict, [near, elsewhere]) = learned(&right, &place, false);
    assert!(verdict == Verdict::Good && near >= 8 && elsewhere == 0, "{verdict:?}: {near}, {elsewhere}");
    let (verdict, [also_near, elsewhere]) = learned(&wrong, &place, false);
    assert!(verdict == Verdict::UsableWithCare, "{verdict:?}");
    assert!(also_near * 10 >= near * 9 && elsewhere == 0, "{also_near} of {near}, {elsewhere} elsewhere");
    let (_, [_, ghosts]) = learned(&wrong, &place, true);
    assert!(ghosts > 50, "{ghosts}");
}
