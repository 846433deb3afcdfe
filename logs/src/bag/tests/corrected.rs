use super::builder::*;
use crate::summary::TopicChoice;
use interfaces::{LaserReading, heading_rad};
use ros::Pose;

/// How a robot of a bag is localized by another SLAM.
struct Slam {
    /// The frames from the map to the robot.
    frames: [&'static str; 3],
    /// The pose of the odometry in the map at a time, if it is published then.
    correction: fn(f64) -> Option<Pose>,
    /// Whether the odometry is in tf; otherwise it is a topic.
    odometry_in_tf: bool,
}

const SLAM: Slam = Slam {
    frames: ["map", "odom", "base_link"],
    // Known from 0.5 s on; at 2 s, a loop is closed.
    correction: |time_s| {
        (time_s > 0.45).then(|| if time_s < 1.95 { pose(0.0, 1.0, 0.0) } else { pose(0.0, 0.0, 0.1) })
    },
    odometry_in_tf: true,
};

/// A robot that drives 1 m/s along x by its odometry for 4 s, with a scan between two poses. As those of slam_toolbox and AMCL, the
/// corrections have later stamps; each follows from the scan before it.
fn bag(Slam { frames: [map, odom, base], correction, odometry_in_tf }: &Slam) -> Builder {
    let mut bag = Builder::default();
    bag.tf("/tf_static", 0.0, &[transform(0.0, base, "laser", pose(0.2, 0.0, 0.0))]);
    for time_s in times(40, 0.1) {
        if let Some(correction) = correction(time_s) {
            bag.tf("/tf", time_s, &[transform(time_s + 0.5, map, odom, correction)]);
        }
        match odometry_in_tf {
            true => bag.tf("/tf", time_s, &[transform(time_s, odom, base, pose(time_s, 0.0, 0.0))]),
            false => bag.odometry("/odom", time_s, time_s, 0.0),
        };
        bag.laser(time_s + 0.05);
    }
    bag
}

fn corrected() -> TopicChoice {
    TopicChoice { is_corrected: true, ..TopicChoice::default() }
}

fn refused(bag: &Builder) -> String {
    bag.open(&corrected()).expect_err("the bag should be refused").to_string()
}

fn near(reading: &LaserReading, expected: [f64; 3]) -> bool {
    let at = [reading.pose.translation.x, reading.pose.translation.y, heading_rad(&reading.pose)];
    at.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-6)
}

/// The readings from 0.45 s on of the robot that drives along x by its odometry, in the map.
fn assert_in_map(readings: &[LaserReading]) {
    for (step, reading) in (4..).zip(readings) {
        let ahead = f64::from(step) * 0.1 + 0.05;
        let expected = match step {
            ..19 => [ahead, 1.0, 0.0],
            _ => [ahead * 0.1_f64.cos(), ahead * 0.1_f64.sin(), 0.1],
        };
        assert!(near(reading, expected), "step {step}: {:?} instead of {expected:?}", reading.pose);
        let speed_mps = reading.twist.linear_mps;
        assert!((speed_mps - 1.0).abs() < 1e-6, "a correction is no motion: {speed_mps} m/s");
    }
    assert_eq!(readings.len(), 35);
}

#[test]
fn poses_of_another_slam_are_those_of_its_map_and_a_jump_is_no_motion() {
    let [in_tf, on_topic] = [true, false].map(|odometry_in_tf| {
        let mut bag = bag(&Slam { odometry_in_tf, ..SLAM });
        // The last scan must not wait for a pose.
        bag.messages.pop();
        let opened = bag.open(&corrected()).unwrap();
        assert_in_map(&readings(&opened));
        assert_eq!((opened.summary().scans, opened.summary().stands), (35, false));
        notes(&opened)
    });
    assert_eq!(in_tf, on_topic);
    insta::assert_snapshot!(in_tf, @"
    the poses are those of another SLAM: 1 correction, by 0.81 m and 5.7° at 1.5 s; a correction is no motion, and scans before it keep their poses
    4 scans are left out, since another SLAM gives no pose at their times (or in the 2 s before)
    ");
}

/// The corrections never reach the poses of the odometry.
#[test]
fn poses_of_another_slam_are_used_on_request_only() {
    let opened = bag(&SLAM).log();
    assert!(opened.summary().notes.is_empty());
    for (step, reading) in (0..39).zip(readings(&opened)) {
        assert!(near(&reading, [f64::from(step) * 0.1 + 0.05, 0.0, 0.0]), "{:?}", reading.pose);
    }
}

#[test]
fn frames_have_other_names() {
    let mut bag = bag(&Slam { frames: ["/slam_map", "wheels", "robot"], ..SLAM });
    bag.messages.pop();
    let choice = TopicChoice { map_frame: Some("slam_map".to_owned()), ..corrected() };
    assert_in_map(&readings(&bag.open(&choice).unwrap()));
    insta::assert_snapshot!(refused(&bag), @"test: no transform (tf) has the frame `map`, in which another SLAM would have corrected the poses; --map-frame names it; the frames are laser, robot, slam_map, wheels");
    // A SLAM that publishes its corrections more often than the robot its odometry.
    let mut often = self::bag(&Slam { frames: ["map", "robot1_odom", "base_link"], ..SLAM });
    often.messages.pop();
    let all = often.messages.clone();
    let is_correction = |index: usize| all[index..].iter().take(2).all(|(topic, ..)| topic == "/tf");
    let copies = |index: usize| if is_correction(index) { 2 } else { 1 };
    let repeated = (0..all.len()).flat_map(|index| vec![all[index].clone(); copies(index)]);
    often.messages = repeated.collect();
    assert!(often.messages.len() > all.len() + 30);
    assert_in_map(&readings(&often.open(&corrected()).unwrap()));
}

/// Some SLAMs have no frame of odometry: their poses jump themselves.
#[test]
fn the_motion_before_a_jump_goes_on_until_the_jump() {
    let mut bag = Builder::default();
    bag.mount();
    for step in 0..40 {
        let time_s = f64::from(step) * 0.1;
        let y = if step < 20 { 1.0 } else { 0.0 };
        bag.tf("/tf", time_s, &[transform(time_s, "map", "base_link", pose(time_s, y, 0.0))]);
        let sweeping = ros::LaserScan { time_increment: 0.02, ..scan(time_s + 0.03, "laser") };
        bag.scan("/scan", time_s + 0.05, &sweeping);
    }
    let opened = bag.open(&corrected()).unwrap();
    for (step, reading) in (0..39).zip(readings(&opened)) {
        let y = if step < 20 { 1.0 } else { 0.0 };
        assert!(near(&reading, [f64::from(step) * 0.1 + 0.07, y, 0.0]), "step {step}: {:?}", reading.pose);
        assert!(reading.velocities.iter().all(|sample| sample.twist.linear_mps < 1.01), "{reading:?}");
    }
    let note = &opened.summary().notes[0];
    assert!(note.starts_with("the poses are those of another SLAM: 1 correction, by "), "{note}");
}

#[test]
fn bags_without_poses_of_another_slam_are_refused() {
    let mut none = Builder::default();
    none.odometry("/odom", 0.0, 0.0, 0.0).laser(0.0);
    insta::assert_snapshot!(refused(&none), @"test: the bag has no transforms (tf), which would have the corrected poses of another SLAM");
    let uncorrected = bag(&Slam { correction: |_| None, ..SLAM });
    insta::assert_snapshot!(refused(&uncorrected), @"test: no transform (tf) has the frame `map`, in which another SLAM would have corrected the poses; --map-frame names it; the frames are base_link, laser, odom");
    let mut apart = bag(&Slam { correction: |_| None, ..SLAM });
    apart.tf("/tf", 0.0, &[still("map", "other")]);
    insta::assert_snapshot!(refused(&apart), @"test: no transforms (tf) lead from the map of another SLAM, `map`, to `laser`; the frames are base_link, laser, map, odom, other (--map-frame and --base-frame name those of the map and of the robot)");
    let mut unmoved = Builder::default();
    unmoved.mount().tf("/tf_static", 0.0, &[still("map", "base_link")]).laser(0.0);
    insta::assert_snapshot!(refused(&unmoved), @"test: no transform between `map` and `laser` moves: another SLAM gives no poses there");
    // Only before the first scan, and long after the last one.
    let mut late = bag(&SLAM);
    late.messages.retain(|(_, type_name, log_ns, _)| {
        let time_s = *log_ns as f64 * 1e-9 - BEGIN_S;
        (type_name == SCAN) == (time_s < 0.4) || time_s == 0.0
    });
    insta::assert_snapshot!(refused(&late), @"test: at none of the times of 4 scans there is a pose of another SLAM");
}
