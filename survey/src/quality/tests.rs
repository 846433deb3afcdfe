use super::*;
use interfaces::pose;

fn along(truth: &[Isometry2<f64>]) -> Vec<TrajectoryPose> {
    let placed = |(number, pose): (usize, &Isometry2<f64>)| TrajectoryPose {
        time_s: number as f64,
        pose: *pose,
        state: PoseState::Tracking,
    };
    truth.iter().enumerate().map(placed).collect()
}

fn quality(readings: &[LaserReading], poses: &[Isometry2<f64>]) -> Quality {
    let mut check = QualityCheck::default();
    readings.iter().zip(poses).for_each(|(reading, pose)| check.add(reading, pose));
    check.finish(&along(poses)).0
}

/// Along its true poses, a map is good.
#[test]
fn true_poses_are_good() {
    let (readings, truth) = crate::tests::drive(2, 180.0);
    let found = quality(&readings, &truth);
    assert!(
        found.verdict() == Verdict::Good && found.reasons().is_empty() && found.doubts.is_empty(),
        "{found:?}"
    );
    assert!(found.scans > 50 && found.seen_once < 0.3, "{found:?}");
}

/// A route that turns too much with every meter has walls twice.
#[test]
fn a_bent_route_is_not_usable() {
    let (readings, truth) = crate::tests::drive(2, 180.0);
    let mut bent = vec![truth[0]];
    for pair in truth.windows(2) {
        let motion = pair[0].inv_mul(&pair[1]);
        let bend_rad = 0.1 * motion.translation.vector.norm();
        bent.push(bent[bent.len() - 1] * motion * pose(0.0, 0.0, bend_rad));
    }
    let found = quality(&readings, &bent);
    assert_eq!(found.verdict(), Verdict::NotUsable, "{found:?}");
    assert!(found.doubts.iter().all(|doubt| doubt.from_s <= doubt.to_s) && !found.doubts.is_empty());
}

/// A turn that is missing breaks the route at one place.
#[test]
fn a_missing_turn_is_a_weak_link() {
    let (readings, truth) = crate::tests::drive(2, 180.0);
    let half = truth.len() / 2;
    let swing = truth[half] * pose(0.0, 0.0, 1.4) * truth[half].inverse();
    let mut broken = truth;
    broken[half..].iter_mut().for_each(|pose| *pose = swing * *pose);
    let found = quality(&readings, &broken);
    assert!(found.weak_links >= 1 && found.verdict() > Verdict::Good, "{found:?}");
    let mut weak = found.doubts.iter().filter(|doubt| doubt.kind == DoubtKind::WeakLink);
    assert!(weak.all(|doubt| (half as f64..half as f64 + 60.0).contains(&doubt.from_s)), "{found:?}");
}

/// A turn that the odometry contradicts is in doubt until another pass confirms it; without an odometry that holds, nothing is said.
#[test]
fn a_turn_against_the_odometry_needs_another_pass() {
    let scan = |seen_once: f64| Judged { in_free: 0.0, link: 0.7, seen_once };
    let mut judged = vec![scan(0.9); 100];
    let mut turned = vec![0.01; 100];
    (turned[40], turned[70]) = (0.8, 0.6);
    judged[70] = scan(0.1);
    let weak = |judged: &[Judged], turned: &[f64]| -> Vec<usize> {
        let weak = weak_links(judged, turned);
        (0..weak.len()).filter(|number| weak[*number]).collect()
    };
    assert_eq!(weak(&judged, &turned), [40]);
    turned.iter_mut().step_by(10).for_each(|turn| *turn = 0.5);
    assert_eq!(weak(&judged, &turned), Vec::<usize>::new());
    judged[5].link = 0.1;
    assert_eq!(weak(&judged, &turned), [5]);
}

/// Of an odometry with rare poses, a turn can come a scan late; one that it misses stays missed.
#[test]
fn a_turn_that_the_odometry_has_late_is_not_missed() {
    let along = |turns_rad: [f64; 6]| -> Vec<Isometry2<f64>> {
        let mut at = Isometry2::identity();
        let mut step = |turn_rad| {
            at *= pose(0.5, 0.0, turn_rad);
            at
        };
        turns_rad.into_iter().map(&mut step).collect()
    };
    let missed = |found: [f64; 6], odometry: [f64; 6]| {
        let scan = |(reading, odometry)| CountedScan {
            reading,
            odometry,
            laser: Point2::origin(),
            hits: Vec::new(),
        };
        let counted: Vec<CountedScan> = along(odometry).into_iter().enumerate().map(scan).collect();
        turned(&counted, &super::tests::along(&along(found)))
            .iter()
            .filter(|turn| **turn > TURNED_RAD)
            .count()
    };
    let found = [0.0, 0.7, 0.7, 1.0, 0.3, 0.0];
    assert_eq!(missed(found, [0.0, 0.7, 0.9, 0.6, 0.5, 0.0]), 0);
    assert_eq!(missed(found, [0.0, 0.7, 0.7, 0.0, 0.3, 0.0]), 1);
}

/// In a narrow place, several hits of a scan are in one cell. What another pass saw as well stays confirmed.
#[test]
fn hits_beside_each_other_do_not_hide_another_pass() {
    let seen_once = |beams: usize, passes: usize| -> Vec<f64> {
        let scan =
            |at: Point2<f64>| PlacedScan::new(&Isometry2::identity(), &Point2::origin(), &vec![at; beams]);
        let (near, far) = (scan(Point2::new(1.05, 0.05)), scan(Point2::new(9.05, 0.05)));
        let pass = [vec![near; 5], vec![far; 40]].concat();
        Evidence::judge(&vec![pass; passes].concat()).iter().map(|scan| scan.seen_once).collect()
    };
    for beams in [1, 4] {
        assert_eq!(seen_once(beams, 2)[..5], [0.0; 5], "{beams} beams per cell, seen on two passes");
        assert_eq!(seen_once(beams, 1)[..5], [1.0; 5], "{beams} beams per cell, seen on one pass");
    }
}

/// Scans that show nothing have no link, and neither has the first one that shows something.
#[test]
fn a_log_may_begin_with_scans_that_show_nothing() {
    let scan = |hits: &[Point2<f64>]| PlacedScan::new(&Isometry2::identity(), &Point2::origin(), hits);
    let (at, elsewhere) = (Point2::new(1.05, 0.05), Point2::new(9.05, 0.05));
    let scans = [scan(&[]), scan(&[]), scan(&[at]), scan(&[at]), scan(&[elsewhere])];
    let links: Vec<f64> = Evidence::judge(&scans).iter().map(|scan| scan.link).collect();
    assert_eq!(links, [1.0, 1.0, 1.0, 1.0, 0.0]);
}

/// What a drive finds that sees nothing for some time, while the odometry turns by an angle that the robot does not.
fn found_after(blind_s: f64, slip_rad: f64) -> Quality {
    let (mut readings, _) = crate::tests::drive(2, 180.0);
    let blind = 60.0..60.0 + blind_s;
    let slip = pose(3.0 * slip_rad, 0.0, slip_rad);
    let mut begin = None;
    for reading in &mut readings {
        if blind.contains(&reading.time_s) {
            reading.scan.ranges_m.fill(f32::INFINITY);
        } else if reading.time_s > blind.end {
            let begin = *begin.get_or_insert(reading.pose);
            reading.pose = begin * slip * begin.inv_mul(&reading.pose);
        }
    }
    let settings = crate::SurveySettings::of(interfaces::PoseMode::Localized);
    crate::tests::first_pass(&settings, &readings).quality
}

/// Outdoors, the odometry bridges what the laser does not see, if the scans after it confirm it; a robot that is lost after it has no map.
#[test]
fn a_time_without_returns_is_bridged_if_later_scans_agree() {
    let bridged = found_after(20.0, 0.0);
    assert!(bridged.left_out < 0.02 && bridged.verdict() <= Verdict::UsableWithCare, "{bridged:?}");
    let lost = found_after(20.0, 1.0);
    assert!(lost.left_out > 0.1 && lost.verdict() > Verdict::Good, "{lost:?}");
    let long = found_after(40.0, 0.0);
    assert!(long.left_out > 0.2 && long.verdict() == Verdict::NotUsable, "{long:?}");
}

/// Too few scans say nothing.
#[test]
fn a_robot_that_rests_is_not_judged() {
    let (readings, truth) = crate::tests::drive(2, 1.0);
    let found = quality(&readings, &truth);
    assert_eq!((found.verdict(), found.contradicting), (Verdict::Good, 0.0));
}
