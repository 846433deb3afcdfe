use super::*;
use crate::message::{Header, Pose, TransformStamped};
use interfaces::{Twist, heading_rad};

const SECOND_NS: i64 = 1_000_000_000;

fn source() -> Source {
    let [map, odom, base] = ["map", "odom", "base_footprint"].map(str::to_owned);
    Source::new(FrameNames { map, odom, base, laser: String::new(), are_connected: true })
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
        scan_time: 0.1,
        range_min: 0.1,
        range_max: 10.0,
        ranges: vec![1.0, 2.0, 3.0],
        ..LaserScan::default()
    })
}

fn at(x: f64) -> Isometry2<f64> {
    interfaces::pose(x, 0.0, 0.0)
}

/// A source, and the time at which it gets its messages.
struct Heard {
    source: Source,
    now: Instant,
}

impl std::ops::Deref for Heard {
    type Target = Source;

    fn deref(&self) -> &Source {
        &self.source
    }
}

impl Heard {
    fn nothing() -> Self {
        Self { source: source(), now: Instant::now() }
    }

    /// A robot that drives 1 m/s along x, by tf, with a laser 0.2 m ahead of its center.
    fn robot() -> Self {
        let mut heard = Self::nothing();
        heard.drives();
        heard
    }

    fn drives(&mut self) {
        self.take(Topic::StaticTransforms, transform(0.0, "base_footprint", "base_link", at(0.0)));
        self.take(Topic::StaticTransforms, transform(0.0, "base_link", "laser", at(0.2)));
        (0..=10).map(|step| 0.1 * f64::from(step)).for_each(|time_s| self.pose(time_s, 5.0 + time_s));
    }

    fn take(&mut self, topic: Topic, message: Message) {
        self.source.take(topic, message, self.now);
    }

    fn tf(&mut self, time_s: f64, parent: &str, child: &str, x: f64) {
        self.take(Topic::Transforms, transform(time_s, parent, child, at(x)));
    }

    /// A pose of the odometry.
    fn pose(&mut self, time_s: f64, x: f64) {
        self.tf(time_s, "odom", "base_footprint", x);
    }

    fn scan(&mut self, time_s: f64, frame: &str) {
        self.take(Topic::Scan, scan(time_s, frame));
    }

    fn next(&mut self) -> Option<LiveReading> {
        self.source.next(self.now)
    }

    fn notes(&mut self) -> Vec<String> {
        self.source.take_notes()
    }
}

#[test]
fn a_scan_gets_the_pose_at_its_time() {
    let mut heard = Heard::robot();
    heard.scan(0.75, "laser");
    let live = heard.next().unwrap();
    assert!((live.in_odom.translation.x - 5.75).abs() < 1e-9, "{}", live.in_odom);
    // The first pose is the origin.
    assert!((live.reading.pose.translation.x - 0.75).abs() < 1e-9);
    assert!((live.reading.time_s - 0.75).abs() < 1e-9);
    assert!((live.reading.mount.translation.x - 0.2).abs() < 1e-12);
    assert!((live.reading.twist.linear_mps - 1.0).abs() < 1e-6);
    assert_eq!(live.reading.scan.ranges_m, [1.0, 2.0, 3.0]);
    assert_eq!(heard.next(), None);
    assert_eq!(heard.count, ScanCount { received: 1, ..ScanCount::default() });
}

#[test]
fn a_scan_waits_for_a_later_pose_but_not_for_long() {
    let mut heard = Heard::robot();
    heard.scan(1.05, "laser");
    assert_eq!(heard.next(), None);
    heard.pose(1.1, 6.1);
    assert!((heard.next().unwrap().in_odom.translation.x - 6.05).abs() < 1e-9);
    heard.scan(1.15, "laser");
    assert_eq!(heard.next(), None);
    // A pose that is nearly at its time is better than none.
    assert!((heard.source.next(heard.now + PATIENCE).unwrap().in_odom.translation.x - 6.1).abs() < 1e-9);
    heard.scan(1.25, "laser");
    assert_eq!((heard.source.next(heard.now + PATIENCE), heard.count.unplaced), (None, 1));
    assert_eq!(heard.notes(), ["a scan is left out: there is no pose of the robot at its time"]);
}

/// The odometry of many robots starts again at 0 with its driver, on the same clock.
#[test]
fn an_odometry_that_is_reset_is_no_motion() {
    let mut heard = Heard::robot();
    for step in 11..=20 {
        let time_s = 0.1 * f64::from(step);
        heard.pose(time_s, time_s - 1.1);
    }
    heard.scan(0.95, "laser");
    heard.scan(1.65, "laser");
    let [before, after] = [heard.next().unwrap(), heard.next().unwrap()];
    assert!((before.reading.pose.translation.x - 0.95).abs() < 1e-9);
    assert!((after.reading.pose.translation.x - 1.55).abs() < 1e-9, "{}", after.reading.pose);
    // The odometry has it where it publishes it.
    assert!((after.in_odom.translation.x - 0.55).abs() < 1e-9, "{}", after.in_odom);
    assert!((after.in_first_odom.translation.x - 6.55).abs() < 1e-9, "{}", after.in_first_odom);
    assert!(!after.is_restart);
    let note = "the odometry jumps by 6.00 m and 0.00 rad in 0.10 s: it was reset, and the jump is no motion";
    assert_eq!(heard.notes(), [note]);
}

#[test]
fn a_robot_without_a_footprint_is_at_its_base_link() {
    let mut heard = Heard::nothing();
    heard.tf(0.0, "odom", "base_link", 1.0);
    assert_eq!(heard.base(), "base_link");
    assert_eq!(heard.notes(), ["there is no frame `base_footprint`: the robot is at `base_link`"]);
    heard.tf(0.2, "odom", "base_link", 1.2);
    heard.scan(0.1, "base_link");
    assert!((heard.next().unwrap().in_odom.translation.x - 1.1).abs() < 1e-9);
}

#[test]
fn odometry_on_a_topic_is_used_where_tf_has_none() {
    let mut heard = Heard::nothing();
    for step in 0..=30 {
        let (time_s, turn) = (0.1 * f64::from(step), interfaces::pose(2.0, 1.0, 0.1 * f64::from(step)));
        heard.take(Topic::Odometry, odometry(time_s, "base_link", turn));
        heard.scan(time_s - 0.05, "base_link");
    }
    // For two seconds, tf could still come.
    assert_eq!(heard.count.unplaced, 20);
    let live = heard.next().unwrap();
    assert!((heading_rad(&live.in_odom) - 1.95).abs() < 1e-6, "{}", heading_rad(&live.in_odom));
    assert!((live.reading.twist.angular_radps - 1.0).abs() < 1e-6);
}

/// A robot that drives a circle, with a post at the left of its laser.
#[test]
fn a_part_of_the_robot_is_left_out_once_it_is_known() {
    let mut heard = Heard::robot();
    let mut left_m = Vec::new();
    for step in 11..100_u32 {
        let time_s = 0.1 * f64::from(step);
        heard.now += Duration::from_millis(100);
        let pose =
            interfaces::pose(6.0, 0.0, 0.0) * interfaces::pose(time_s.sin(), 1.0 - time_s.cos(), time_s);
        heard.take(Topic::Transforms, transform(time_s, "odom", "base_footprint", pose));
        let Message::Scan(mut message) = scan(time_s - 0.12, "laser") else { panic!() };
        message.ranges = vec![1.0 + time_s as f32, 2.0, 0.3 + 0.004 * (step % 3) as f32];
        heard.take(Topic::Scan, Message::Scan(message));
        left_m.extend(heard.next().map(|live| live.reading.scan.ranges_m[2]));
    }
    let seen = left_m.iter().take_while(|range_m| !range_m.is_nan()).count();
    // Half a turn, with some scans in each direction.
    assert!((25..50).contains(&seen) && left_m[seen..].iter().all(|range_m| range_m.is_nan()), "{left_m:?}");
    let notes = heard.notes();
    assert_eq!(notes.iter().filter(|note| note.contains("57° to 57°")).count(), 1, "{notes:?}");
}

#[test]
fn what_is_missing_is_said() {
    let mut heard = Heard::nothing();
    heard.scan(0.0, "laser");
    insta::assert_snapshot!(heard.obstacle().unwrap(), @"no pose: neither is there a transform from `odom` to `base_footprint`, nor odometry for `base_footprint`; there are no transforms on /tf and /tf_static");
    heard.pose(0.0, 0.0);
    heard.pose(0.1, 0.0);
    heard.scan(0.05, "lidar");
    insta::assert_snapshot!(heard.obstacle().unwrap(), @"no place of the laser: `lidar` is not connected with `base_footprint`; the frames in tf are base_footprint, odom");
    assert_eq!(heard.next(), None);
    heard.take(Topic::StaticTransforms, transform(0.0, "base_footprint", "lidar", at(0.1)));
    heard.scan(0.06, "lidar");
    assert!(heard.next().is_some());
    assert_eq!(heard.obstacle(), None);
}

#[test]
fn frames_that_form_a_cycle_do_no_harm() {
    let mut heard = Heard::nothing();
    for (parent, child) in [("a", "b"), ("b", "a"), ("odom", "a"), ("b", "base_footprint")] {
        heard.tf(0.0, parent, child, 1.0);
    }
    heard.tf(0.1, "b", "base_footprint", 1.0);
    heard.scan(0.05, "base_footprint");
    assert!(heard.next().is_some());
}

#[test]
fn a_clock_that_starts_anew_begins_another_session() {
    let mut heard = Heard::robot();
    heard.scan(0.5, "laser");
    assert!(!heard.next().unwrap().is_restart);
    // A scan that comes late is no new clock.
    heard.scan(0.4, "laser");
    assert_eq!((heard.next(), heard.count.late), (None, 1));
    for step in 0..3 {
        let time_s = -100.0 + 0.1 * f64::from(step);
        heard.pose(time_s, 9.0);
    }
    heard.scan(-99.85, "laser");
    let live = heard.next().unwrap();
    assert!(live.is_restart);
    assert_eq!(live.in_odom.translation.x, 9.0);
    assert_eq!(heard.notes(), ["the clock of the scans has gone back by 100.4 s: another session begins"]);
    heard.scan(-99.83, "laser");
    assert!(!heard.next().unwrap().is_restart);
}

#[test]
fn nonsense_is_left_out() {
    let mut heard = Heard::robot();
    let Message::Scan(good) = scan(0.2, "laser") else { unreachable!() };
    let nonsense = [
        LaserScan { ranges: Vec::new(), ..good.clone() },
        LaserScan { range_min: 20.0, ..good.clone() },
        LaserScan { angle_min: f32::NAN, ..good.clone() },
        LaserScan { time_increment: -5.0, ..good.clone() },
    ];
    nonsense.into_iter().for_each(|message| heard.take(Topic::Scan, Message::Scan(message)));
    let nan = interfaces::pose(f64::NAN, 0.0, 0.0);
    heard.take(Topic::Transforms, transform(1.1, "odom", "base_footprint", nan));
    assert_eq!(heard.count.invalid, 4);
    assert_eq!(heard.notes().len(), 5);
    for sec in [i32::MIN, i32::MAX] {
        let header = Header { stamp: Time { sec, nanosec: u32::MAX }, ..good.header.clone() };
        heard.take(Topic::Scan, Message::Scan(LaserScan { header, ..good.clone() }));
    }
    assert_eq!(heard.source.next(heard.now + PATIENCE), None);
    heard.take(Topic::Scan, Message::Scan(good));
    assert_eq!(heard.source.next(heard.now + PATIENCE), None, "far from the stamp before");
    heard.scan(0.3, "laser");
    assert!(!heard.source.next(heard.now + PATIENCE).unwrap().is_restart);
}

#[test]
fn another_localization_is_noticed() {
    let mut heard = Heard::nothing();
    heard.tf(0.0, "map", "odom", 0.0);
    assert!(heard.notes()[0].starts_with("another node publishes the transform from `map` to `odom`"));
    heard.source.names.are_connected = false;
    heard.tf(0.1, "map", "odom", 0.0);
    assert_eq!(heard.notes(), [""; 0]);
}

#[test]
fn of_two_lasers_one_is_used_and_a_sentence_says_which() {
    let scans = |heard: &mut Heard| {
        for time_s in (0..4).map(|step| 0.2 + 0.1 * f64::from(step)) {
            heard.scan(time_s, "laser");
            heard.scan(time_s + 0.02, "base_link");
        }
    };
    let mut first = Heard::robot();
    scans(&mut first);
    assert_eq!((first.count.received, first.count.other, first.count.late), (8, 4, 0));
    assert_eq!(first.assembler.waiting.iter().filter(|waiting| waiting.mount.translation.x > 0.1).count(), 4);
    insta::assert_snapshot!(first.notes()[0], @"scans come from more than one laser: those of `laser` are used, and those of `base_link` are left out; the parameter `laser_frame` chooses another one");
    // A laser that falls silent makes way for the other one.
    first.now += SILENT;
    first.scan(0.9, "base_link");
    assert_eq!((first.count.received, first.count.other), (9, 4));

    let [map, odom, base, laser] = ["map", "odom", "base_footprint", "base_link"].map(str::to_owned);
    let names = FrameNames { map, odom, base, laser, are_connected: true };
    let mut chosen = Heard { source: Source::new(names), now: first.now };
    chosen.drives();
    scans(&mut chosen);
    assert_eq!(chosen.count.other, 4);
    assert!(chosen.assembler.waiting.iter().all(|waiting| waiting.mount.translation.x.abs() < 1e-9));
}

/// Messages with a wrong clock begin no other session, and all readings around them are complete.
#[test]
fn a_stamp_ahead_of_the_clock_is_left_out() {
    for ahead_s in [1.5, 10.0, 3.1e7] {
        for (is_pose_ahead, is_scan_ahead) in [(false, true), (true, false), (true, true)] {
            let mut heard = Heard::robot();
            let (mut readings, mut left_s) = (Vec::new(), 0.0);
            for step in 11..60 {
                // From here on the clock of the robot is another one.
                let time_s = 0.1 * f64::from(step) + if step < 40 { 0.0 } else { 1000.0 };
                for time_s in [time_s, time_s + ahead_s].into_iter().take(1 + usize::from(step % 3 == 0)) {
                    let is_ahead = time_s > 0.1 * f64::from(step) + 1000.5 || step < 40 && time_s > 6.0;
                    if !is_ahead || is_pose_ahead {
                        heard.pose(time_s, 5.0);
                    }
                    if !is_ahead || is_scan_ahead {
                        heard.scan(time_s - 0.2, "laser");
                    }
                }
                readings.extend(std::iter::from_fn(|| heard.next()));
                left_s = time_s;
            }
            assert!(readings.iter().all(|live| !live.is_restart), "{ahead_s} {:?}", heard.notes());
            assert!(readings.iter().all(|live| live.reading.time_s <= left_s), "{ahead_s}");
            // At the change of the clock, a scan and a pose are left out, and the scan that has no pose then.
            assert!(
                (46..=48).contains(&readings.len()),
                "{ahead_s} {is_pose_ahead} {is_scan_ahead}: {}",
                readings.len()
            );
        }
    }
}
