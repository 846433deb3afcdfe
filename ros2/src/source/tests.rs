use super::*;
use crate::message::{Header, Pose, TransformStamped};
use interfaces::{Twist, heading_rad};

const SECOND_NS: i64 = 1_000_000_000;

fn source() -> Source {
    let [map, odom, base] = ["map", "odom", "base_footprint"].map(str::to_owned);
    Source::new(FrameNames { map, odom, base, laser: String::new() }, true)
}

fn header(time_s: f64, frame: &str) -> Header {
    let stamp = Time::from_ns(1_700_000_000 * SECOND_NS + (time_s * 1e9).round() as i64);
    Header { stamp, frame_id: frame.to_owned() }
}

fn transform(time_s: f64, parent: &str, child: &str, pose: Isometry2<f64>) -> Message {
    let transform = TransformStamped {
        header: header(time_s, parent),
        child_frame_id: child.to_owned(),
        transform: Pose::in_plane(&pose),
    };
    Message::Transforms(Transforms { transforms: vec![transform] })
}

fn odometry(time_s: f64, child: &str, pose: Isometry2<f64>) -> Message {
    Message::Odometry(Box::new(Odometry::in_plane(header(time_s, "odom"), child, &pose, &Twist::STOP)))
}

fn scan(time_s: f64, frame: &str) -> Message {
    Message::Scan(LaserScan {
        header: header(time_s, frame),
        angle_min: -1.0,
        angle_max: 1.0,
        angle_increment: 1.0,
        time_increment: 0.0,
        scan_time: 0.1,
        range_min: 0.1,
        range_max: 10.0,
        ranges: vec![1.0, 2.0, 3.0],
        intensities: Vec::new(),
    })
}

/// A robot that drives 1 m/s along x, by tf, with a laser 0.2 m ahead of its center.
fn robot(source: &mut Source, now: Instant) {
    source.take(Topic::StaticTransforms, transform(0.0, "base_footprint", "base_link", at(0.0)), now);
    source.take(Topic::StaticTransforms, transform(0.0, "base_link", "laser", at(0.2)), now);
    for step in 0..=10 {
        let time_s = 0.1 * f64::from(step);
        source.take(Topic::Transforms, transform(time_s, "odom", "base_footprint", at(5.0 + time_s)), now);
    }
}

fn at(x: f64) -> Isometry2<f64> {
    interfaces::pose(x, 0.0, 0.0)
}

#[test]
fn a_scan_gets_the_pose_at_its_time() {
    let (mut source, now) = (source(), Instant::now());
    robot(&mut source, now);
    source.take(Topic::Scan, scan(0.75, "laser"), now);
    let live = source.next(now).unwrap();
    assert!((live.in_odom.translation.x - 5.75).abs() < 1e-9, "{}", live.in_odom);
    // The first pose is the origin.
    assert!((live.reading.pose.translation.x - 0.75).abs() < 1e-9);
    assert!((live.reading.time_s - 0.75).abs() < 1e-9);
    assert!((live.reading.mount.translation.x - 0.2).abs() < 1e-12);
    assert!((live.reading.twist.linear_mps - 1.0).abs() < 1e-6);
    assert_eq!(live.reading.scan.ranges_m, [1.0, 2.0, 3.0]);
    assert_eq!(source.next(now), None);
    assert_eq!(source.count, ScanCount { received: 1, ..ScanCount::default() });
}

#[test]
fn a_scan_waits_for_a_later_pose_but_not_for_long() {
    let (mut source, now) = (source(), Instant::now());
    robot(&mut source, now);
    source.take(Topic::Scan, scan(1.05, "laser"), now);
    assert_eq!(source.next(now), None);
    source.take(Topic::Transforms, transform(1.1, "odom", "base_footprint", at(6.1)), now);
    assert!((source.next(now).unwrap().in_odom.translation.x - 6.05).abs() < 1e-9);
    source.take(Topic::Scan, scan(1.15, "laser"), now);
    assert_eq!(source.next(now), None);
    // A pose that is nearly at its time is better than none.
    assert!((source.next(now + PATIENCE).unwrap().in_odom.translation.x - 6.1).abs() < 1e-9);
    source.take(Topic::Scan, scan(1.25, "laser"), now);
    assert_eq!((source.next(now + PATIENCE), source.count.unplaced), (None, 1));
    assert_eq!(source.take_notes(), ["a scan is left out: there is no pose of the robot at its time"]);
}

/// The odometry of many robots starts again at 0 with its driver, on the same clock.
#[test]
fn an_odometry_that_is_reset_is_no_motion() {
    let (mut source, now) = (source(), Instant::now());
    robot(&mut source, now);
    for step in 11..=20 {
        let time_s = 0.1 * f64::from(step);
        source.take(Topic::Transforms, transform(time_s, "odom", "base_footprint", at(time_s - 1.1)), now);
    }
    source.take(Topic::Scan, scan(0.95, "laser"), now);
    source.take(Topic::Scan, scan(1.65, "laser"), now);
    let [before, after] = [source.next(now).unwrap(), source.next(now).unwrap()];
    assert!((before.reading.pose.translation.x - 0.95).abs() < 1e-9);
    assert!((after.reading.pose.translation.x - 1.55).abs() < 1e-9, "{}", after.reading.pose);
    // The odometry has it where it publishes it.
    assert!((after.in_odom.translation.x - 0.55).abs() < 1e-9, "{}", after.in_odom);
    assert!((after.in_first_odom.translation.x - 6.55).abs() < 1e-9, "{}", after.in_first_odom);
    assert!(!after.is_restart);
    let note = "the odometry jumps by 6.00 m and 0.00 rad in 0.10 s: it was reset, and the jump is no motion";
    assert_eq!(source.take_notes(), [note]);
}

#[test]
fn a_robot_without_a_footprint_is_at_its_base_link() {
    let (mut source, now) = (source(), Instant::now());
    source.take(Topic::Transforms, transform(0.0, "odom", "base_link", at(1.0)), now);
    assert_eq!(source.base(), "base_link");
    assert_eq!(source.take_notes(), ["there is no frame `base_footprint`: the robot is at `base_link`"]);
    source.take(Topic::Transforms, transform(0.2, "odom", "base_link", at(1.2)), now);
    source.take(Topic::Scan, scan(0.1, "base_link"), now);
    assert!((source.next(now).unwrap().in_odom.translation.x - 1.1).abs() < 1e-9);
}

#[test]
fn odometry_on_a_topic_is_used_where_tf_has_none() {
    let (mut source, now) = (source(), Instant::now());
    for step in 0..=30 {
        let (time_s, turn) = (0.1 * f64::from(step), interfaces::pose(2.0, 1.0, 0.1 * f64::from(step)));
        source.take(Topic::Odometry, odometry(time_s, "base_link", turn), now);
        source.take(Topic::Scan, scan(time_s - 0.05, "base_link"), now);
    }
    // For two seconds, tf could still come.
    assert_eq!(source.count.unplaced, 20);
    let live = source.next(now).unwrap();
    assert!((heading_rad(&live.in_odom) - 1.95).abs() < 1e-6, "{}", heading_rad(&live.in_odom));
    assert!((live.reading.twist.angular_radps - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_missing_is_said() {
    let (mut source, now) = (source(), Instant::now());
    source.take(Topic::Scan, scan(0.0, "laser"), now);
    assert_eq!(
        source.obstacle().unwrap(),
        "no pose: neither is there a transform from `odom` to `base_footprint`, nor odometry for `base_footprint`; there \
         are no transforms on /tf and /tf_static"
    );
    source.take(Topic::Transforms, transform(0.0, "odom", "base_footprint", at(0.0)), now);
    source.take(Topic::Transforms, transform(0.1, "odom", "base_footprint", at(0.0)), now);
    source.take(Topic::Scan, scan(0.05, "lidar"), now);
    assert_eq!(
        source.obstacle().unwrap(),
        "no place of the laser: `lidar` is not connected with `base_footprint`; the frames in tf are base_footprint, odom"
    );
    assert_eq!(source.next(now), None);
    source.take(Topic::StaticTransforms, transform(0.0, "base_footprint", "lidar", at(0.1)), now);
    source.take(Topic::Scan, scan(0.06, "lidar"), now);
    assert!(source.next(now).is_some());
    assert_eq!(source.obstacle(), None);
}

#[test]
fn frames_that_form_a_cycle_do_no_harm() {
    let (mut source, now) = (source(), Instant::now());
    for (parent, child) in [("a", "b"), ("b", "a"), ("odom", "a"), ("b", "base_footprint")] {
        source.take(Topic::Transforms, transform(0.0, parent, child, at(1.0)), now);
    }
    source.take(Topic::Transforms, transform(0.1, "b", "base_footprint", at(1.0)), now);
    source.take(Topic::Scan, scan(0.05, "base_footprint"), now);
    assert!(source.next(now).is_some());
}

#[test]
fn a_clock_that_starts_anew_begins_another_session() {
    let (mut source, now) = (source(), Instant::now());
    robot(&mut source, now);
    source.take(Topic::Scan, scan(0.5, "laser"), now);
    assert!(!source.next(now).unwrap().is_restart);
    // A scan that comes late is no new clock.
    source.take(Topic::Scan, scan(0.4, "laser"), now);
    assert_eq!((source.next(now), source.count.late), (None, 1));
    for step in 0..3 {
        let time_s = -100.0 + 0.1 * f64::from(step);
        source.take(Topic::Transforms, transform(time_s, "odom", "base_footprint", at(9.0)), now);
    }
    source.take(Topic::Scan, scan(-99.85, "laser"), now);
    let live = source.next(now).unwrap();
    assert!(live.is_restart);
    assert_eq!(live.in_odom.translation.x, 9.0);
    assert_eq!(
        source.take_notes(),
        ["the clock of the scans has gone back by 100.4 s: another session begins"]
    );
    source.take(Topic::Scan, scan(-99.83, "laser"), now);
    assert!(!source.next(now).unwrap().is_restart);
}

#[test]
fn nonsense_is_left_out() {
    let (mut source, now) = (source(), Instant::now());
    robot(&mut source, now);
    let Message::Scan(good) = scan(0.2, "laser") else { unreachable!() };
    let nonsense = [
        LaserScan { ranges: Vec::new(), ..good.clone() },
        LaserScan { range_min: 20.0, ..good.clone() },
        LaserScan { angle_min: f32::NAN, ..good.clone() },
        LaserScan { time_increment: -5.0, ..good.clone() },
    ];
    for message in nonsense {
        source.take(Topic::Scan, Message::Scan(message), now);
    }
    let nan = interfaces::pose(f64::NAN, 0.0, 0.0);
    source.take(Topic::Transforms, transform(1.1, "odom", "base_footprint", nan), now);
    assert_eq!(source.count.invalid, 4);
    assert_eq!(source.take_notes().len(), 5);
    let early = LaserScan {
        header: Header { stamp: Time { sec: i32::MIN, nanosec: u32::MAX }, ..good.header.clone() },
        ..good.clone()
    };
    source.take(Topic::Scan, Message::Scan(early), now);
    let late = LaserScan {
        header: Header { stamp: Time { sec: i32::MAX, nanosec: u32::MAX }, ..good.header.clone() },
        ..good.clone()
    };
    source.take(Topic::Scan, Message::Scan(late), now);
    assert_eq!(source.next(now + PATIENCE), None);
    source.take(Topic::Scan, Message::Scan(good), now);
    assert!(source.next(now + PATIENCE).unwrap().is_restart);
}

#[test]
fn another_localization_is_noticed() {
    let (mut source, now) = (source(), Instant::now());
    source.take(Topic::Transforms, transform(0.0, "map", "odom", at(0.0)), now);
    assert!(source.take_notes()[0].starts_with("another node publishes the transform from `map` to `odom`"));
    source.is_localized = false;
    source.take(Topic::Transforms, transform(0.1, "map", "odom", at(0.0)), now);
    assert_eq!(source.take_notes(), [""; 0]);
}

#[test]
fn of_two_lasers_one_is_used_and_a_sentence_says_which() {
    let scans = |source: &mut Source, begin_s: f64, now: Instant| {
        for step in 0..4 {
            let time_s = begin_s + 0.1 * f64::from(step);
            source.take(Topic::Scan, scan(time_s, "laser"), now);
            source.take(Topic::Scan, scan(time_s + 0.02, "base_link"), now);
        }
    };
    let (mut first, now) = (source(), Instant::now());
    robot(&mut first, now);
    scans(&mut first, 0.2, now);
    assert_eq!((first.count.received, first.count.other, first.count.late), (8, 4, 0));
    assert_eq!(first.assembler.waiting.iter().filter(|waiting| waiting.mount.translation.x > 0.1).count(), 4);
    let expected = "scans come from more than one laser: those of `laser` are used, and those of `base_link` are left out; the \
                    parameter `laser_frame` chooses another one";
    assert_eq!(first.take_notes()[0], expected);
    // A laser that falls silent makes way for the other one.
    source_takes_over(&mut first, now + SILENT);

    let [map, odom, base, laser] = ["map", "odom", "base_footprint", "base_link"].map(str::to_owned);
    let mut chosen = Source::new(FrameNames { map, odom, base, laser }, true);
    robot(&mut chosen, now);
    scans(&mut chosen, 0.2, now);
    assert_eq!(chosen.count.other, 4);
    assert!(chosen.assembler.waiting.iter().all(|waiting| waiting.mount.translation.x.abs() < 1e-9));
}

fn source_takes_over(source: &mut Source, now: Instant) {
    source.take(Topic::Scan, scan(0.9, "base_link"), now);
    assert_eq!((source.count.received, source.count.other), (9, 4));
}
