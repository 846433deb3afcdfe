use super::builder::*;
use crate::summary::TopicChoice;
use interfaces::{LaserReading, heading_rad};
use mcap::{Compression, WriteOptions};
use ros::{Pose, Rotation};
use std::io::Write;

/// A robot that drives 1 m/s, with a scan between two poses.
fn driving() -> Builder {
    let mut bag = Builder::default();
    bag.mount();
    bag.odometry("/odom", 0.0, 5.0, 0.0).odometry("/odom", 0.1, 5.1, 0.0);
    bag.laser(0.15).odometry("/odom", 0.2, 5.2, 0.0);
    bag.scan("/scan", 0.25, &scan(0.25, "/laser")).odometry("/odom", 0.3, 5.3, 0.0);
    bag
}

pub(super) fn at(reading: &LaserReading) -> [f64; 3] {
    [reading.pose.translation.x, reading.pose.translation.y, heading_rad(&reading.pose)]
}

pub(super) fn assert_near(found: &[f64], expected: &[f64]) {
    let near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-6);
    assert!(near && found.len() == expected.len(), "{found:?} instead of {expected:?}");
}

#[test]
fn poses_are_interpolated_and_begin_at_the_origin() {
    let bag = driving().open(&TopicChoice::default()).unwrap();
    let readings = readings(&bag);
    assert_eq!(readings.len(), 2);
    assert_near(&at(&readings[0]), &[0.15, 0.0, 0.0]);
    assert_near(&at(&readings[1]), &[0.25, 0.0, 0.0]);
    assert_near(&[readings[0].time_s, readings[1].time_s], &[0.0, 0.1]);
    assert_near(&[readings[0].twist.linear_mps, readings[0].mount.translation.x], &[1.0, 0.2]);
    assert_eq!(readings[0].scan.ranges_m, [1.0, 2.0, 3.0]);
    let summary = bag.summary();
    assert_eq!((summary.scans, summary.odometry_poses), (2, 4));
    assert_near(&[summary.begin_s.unwrap() - BEGIN_S, summary.duration_s], &[0.15, 0.1]);
    assert!(summary.notes.is_empty(), "{:?}", summary.notes);
}

#[test]
fn all_formats_give_the_same_readings() {
    let bag = driving();
    let sqlite = bag.sqlite();
    let zstd = zstd::encode_all(&sqlite[..], 0).unwrap();
    let mut by_message = bag.clone();
    by_message.messages.iter_mut().for_each(|(.., data)| *data = zstd::encode_all(&data[..], 0).unwrap());
    let files = [
        bag.mcap(compressed(Compression::Zstd)),
        bag.mcap(compressed(Compression::Lz4)),
        bag.mcap(WriteOptions::new().use_chunks(false)),
        bag.mcap(plain().chunk_size(Some(300))),
        by_message.mcap(plain()),
        sqlite,
        zstd,
    ];
    let choice = TopicChoice::default();
    let expected = readings(&bag.open(&choice).unwrap());
    for (index, file) in files.iter().enumerate() {
        let bag = open(file, &choice).unwrap_or_else(|error| panic!("file {index}: {error}"));
        assert_eq!(readings(&bag), expected, "file {index}");
        assert_eq!(readings(&bag), expected, "file {index}, read again");
    }
}

#[test]
fn a_laser_alone_stands() {
    let mut bag = Builder::default();
    for index in 0..3 {
        let time_s = f64::from(index) * 0.1;
        // The number of beams changes.
        let ranges = vec![1.0; 3 + index as usize];
        let angle_increment = 0.1;
        let message = ros::LaserScan { ranges, angle_increment, ..scan(time_s, "laser") };
        bag.scan("/scan", time_s, &message);
    }
    let bag = bag.log();
    let readings = readings(&bag);
    assert!(readings.iter().all(|reading| at(reading) == [0.0; 3] && reading.mount.translation.x == 0.0));
    assert_eq!(readings[2].scan.ranges_m.len(), 5);
}

#[test]
fn transforms_are_odometry_where_there_is_no_other() {
    let mut bag = Builder::default();
    bag.mount();
    for time_s in times(4, 0.1) {
        let moving = transform(time_s, "odom", "base_link", pose(0.0, time_s, 0.0));
        let correction = transform(time_s, "map", "odom", pose(9.0 * time_s, 0.0, 0.0));
        bag.tf("/tf", time_s, &[correction, moving]);
        bag.laser(time_s + 0.05);
    }
    let bag = bag.log();
    assert_near(&at(&readings(&bag)[1]), &[0.0, 0.15, 0.0]);
}

/// A robot that drives 1 m/s along x in `odom`, with a laser that pans on `base`.
fn by_transforms([map, odom, base]: [&str; 3], corrected_m: f64, pans: bool) -> crate::Log {
    let mut bag = Builder::default();
    for time_s in times(40, 0.1) {
        let pan_rad = if pans { 0.5 * time_s.sin() } else { 0.0 };
        bag.tf("/tf", time_s, &[transform(time_s, base, "laser", pose(0.2, 0.0, pan_rad))]);
        if odom != base {
            let correction = pose(corrected_m * time_s.floor(), 0.0, 0.0);
            bag.tf("/tf", time_s, &[transform(time_s, map, odom, correction)]);
        }
        let parent = if odom == base { map } else { odom };
        bag.tf("/tf", time_s, &[transform(time_s, parent, base, pose(time_s, 0.0, 0.0))]);
        bag.laser(time_s + 0.05);
    }
    bag.log()
}

#[test]
fn odometry_in_transforms_is_below_the_world_whatever_its_name() {
    for odom in ["odom", "robot1_odom", "camera_odom_frame", "wheels"] {
        for (corrected_m, pans) in [(0.0, false), (0.0, true), (0.3, false), (0.3, true)] {
            let bag = by_transforms(["map", odom, "base_link"], corrected_m, pans);
            let found = readings(&bag);
            assert_near(&at(&found[30]), &[3.05, 0.0, 0.0]);
            assert!((found[30].mount.translation.x - 0.2).abs() < 1e-9);
        }
    }
    // Without odometry, the robot is tracked in the world.
    for base in ["base_link", "robot1_base_link", "robot1/base_link"] {
        let bag = by_transforms(["world", base, base], 0.0, true);
        assert_near(&at(&readings(&bag)[30]), &[3.05, 0.0, 0.0]);
    }
}

#[test]
fn a_scan_that_sweeps_ends_later_and_has_velocities() {
    let mut bag = Builder::default();
    bag.mount();
    for step in 0..30 {
        let time_s = f64::from(step) * 0.02;
        // It brakes at 0.2 s.
        bag.odometry("/odom", time_s, time_s.min(0.2), 0.0);
        if step == 8 {
            let sweeping = ros::LaserScan { time_increment: 0.05, ..scan(0.15, "laser") };
            bag.scan("/scan", 0.16, &sweeping);
        }
    }
    let bag = bag.log();
    let [reading] = &readings(&bag)[..] else { panic!("not one reading") };
    // From 0.15 to 0.25 s.
    assert_near(&[reading.scan.sweep_s, bag.summary().begin_s.unwrap() - BEGIN_S], &[0.1, 0.25]);
    assert_near(&at(reading), &[0.2, 0.0, 0.0]);
    let velocities: Vec<f64> =
        reading.velocities.iter().flat_map(|sample| [sample.time_s, sample.twist.linear_mps]).collect();
    let expected =
        [[-0.09, 1.0], [-0.07, 1.0], [-0.05, 1.0], [-0.03, 0.0], [-0.01, 0.0], [0.0, 0.0]].concat();
    assert_near(&velocities, &expected);
}

#[test]
fn several_lasers_take_turns_by_time() {
    let mut bag = Builder::default();
    bag.mount();
    let behind = Pose {
        // Upside down, and turned to the back: a half turn about y.
        orientation: Rotation { x: 0.0, y: 1.0, z: 0.0, w: 0.0 },
        ..pose(-0.3, 0.0, 0.0)
    };
    bag.tf("/tf_static", 0.0, &[transform(0.0, "base_link", "rear", behind)]);
    bag.odometry("/odom", 0.0, 0.0, 0.0);
    for time_s in times(4, 0.1) {
        // The scans of one laser are recorded late.
        bag.scan("/rear/scan", time_s + 0.05, &scan(time_s - 0.03, "rear"));
        bag.scan("/scan", time_s + 0.06, &scan(time_s, "laser"));
    }
    bag.odometry("/odom", 1.0, 1.0, 0.0);
    let bag = bag.log();
    assert_eq!(bag.summary().scan_topics, ["/scan", "/rear/scan"]);
    let readings = readings(&bag);
    let mounts: Vec<f64> = readings.iter().map(|reading| reading.mount.translation.x).collect();
    assert_eq!(mounts, [-0.3, 0.2].repeat(4));
    // Half a turn about y: ahead is behind, left stays left.
    let scan = &readings[2].scan;
    let hit = |beam: usize| {
        let along = interfaces::rotation(scan.angle_rad(beam)) * nalgebra::Vector2::x();
        readings[2].mount.rotation * along
    };
    let beam = scan.ranges_m.iter().position(|range_m| *range_m == 2.0).unwrap();
    assert_near(&[hit(beam).x, hit(beam).y], &[-1.5_f64.cos(), 1.5_f64.sin()]);
}

#[test]
fn lasers_may_scan_at_the_same_time() {
    let mut bag = Builder::default();
    let still = |child: &str| transform(0.0, "base_link", child, pose(0.1, 0.0, 0.0));
    bag.tf("/tf_static", 0.0, &[still("a"), still("b"), still("c")]);
    for time_s in times(4, 0.1) {
        for frame in ["a", "b", "c"] {
            bag.scan(&format!("/{frame}"), time_s, &scan(time_s, frame));
        }
    }
    let bag = bag.log();
    assert!(bag.summary().notes.is_empty(), "{:?}", bag.summary().notes);
    let times_s: Vec<f64> = readings(&bag).iter().map(|reading| reading.time_s).collect();
    assert_near(&times_s[3..6], &[0.1, 0.102, 0.104]);
}

#[test]
fn stamps_that_make_no_sense_give_way_to_the_times_of_the_recording() {
    let mut bag = Builder::default();
    for time_s in times(5, 0.1) {
        let mut message = scan(time_s, "laser");
        message.header.stamp = ros::Time::default();
        bag.scan("/scan", time_s, &message);
    }
    let bag = bag.log();
    insta::assert_snapshot!(notes(&bag), @"the stamps of the scans are unusable: the times of the recording count");
    assert_near(&[bag.summary().duration_s, bag.summary().begin_s.unwrap() - BEGIN_S], &[0.4, 0.0]);
}

#[test]
fn a_clock_that_is_set_back_is_a_note() {
    let mut bag = Builder::default();
    for step in 0..10 {
        let time_s = f64::from(step) * 0.1;
        let stamp_s = if step < 5 { time_s } else { time_s - 5000.0 };
        bag.scan("/scan", time_s, &scan(stamp_s, "laser"));
    }
    let bag = bag.log();
    assert_eq!(bag.summary().scans, 10);
    assert_near(&[bag.summary().duration_s], &[0.9]);
    insta::assert_snapshot!(notes(&bag), @"
    a jump of the clock counts as 0.100 s
    the date and the hours are those of the longest part between jumps of the clock (0.4 s of 0.9 s)
    ");
}

#[test]
fn a_folder_is_read_in_the_order_of_its_metadata_or_of_its_names() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    for (index, name) in [(0, "bag_9.mcap"), (1, "bag_10.db3"), (2, "bag_11.any")] {
        let mut bag = Builder::default();
        let time_s = f64::from(index);
        bag.laser(time_s);
        write(name, &if index == 1 { bag.sqlite() } else { bag.mcap(plain()) });
    }
    write("notes.txt", b"of no concern");
    let open = || crate::Log::open(folder.path(), &TopicChoice::default());
    let log = open().unwrap();
    assert_eq!((log.summary().scans, log.summary().duration_s), (3, 2.0));
    insta::assert_snapshot!(notes(&log), @"metadata.yaml is missing: 3 bag files are read in the order of their names");

    let metadata = |files: &str| {
        let mut file = std::fs::File::create(folder.path().join("metadata.yaml")).unwrap();
        write!(file, "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths: {files}\n").unwrap();
    };
    metadata("[bag_9.mcap, 'old_name/bag_10.db3']");
    let log = open().unwrap();
    assert_eq!((log.summary().scans, log.summary().notes.len()), (2, 0));
    metadata("[bag_9.mcap, bag_12.mcap]");
    let error = open().unwrap_err().to_string();
    assert!(error.ends_with("metadata.yaml: the file `bag_12.mcap` is missing"), "{error}");
    metadata("[../bag_9.mcap]");
    let error = open().unwrap_err().to_string();
    assert!(error.ends_with("`../bag_9.mcap` is not a file of this folder"), "{error}");
    metadata("[notes.txt]");
    let error = open().unwrap_err().to_string();
    assert!(error.ends_with("`notes.txt` is neither MCAP nor SQLite"), "{error}");
    write("metadata.yaml", b"rosbag2_bagfile_information: [");
    let error = open().unwrap_err().to_string();
    assert!(error.contains("without this file, the files of the folder are read by name"), "{error}");
}

#[test]
fn a_parked_robot_stands_although_its_odometry_drifts() {
    let parked = |step_m: f64, range_step_m: f32| {
        let mut bag = Builder::default();
        bag.mount();
        for index in 0..20 {
            let time_s = f64::from(index) * 0.1;
            bag.odometry("/odom", time_s, 5.0 + step_m * f64::from(index), 0.0);
            let ranges = vec![2.0 + range_step_m * index as f32; 90];
            let message = ros::LaserScan { ranges, angle_increment: 0.01, ..scan(time_s, "laser") };
            bag.scan("/scan", time_s + 0.05, &message);
        }
        bag.log()
    };
    let bag = parked(1e-4, 0.0);
    assert!(bag.summary().stands);
    let parked_poses = readings(&bag);
    assert!(parked_poses.iter().all(|reading| at(reading) == [0.0; 3] && reading.mount.translation.x == 0.2));
    // A robot that moves by its odometry, and one whose scans change although its odometry does not.
    assert!(!parked(0.1, 0.0).summary().stands);
    assert!(!parked(0.0, 0.1).summary().stands);
    let moved = parked(0.0, 0.1);
    assert_has(&notes(&moved), &["the odometry stands still, and the scans do not"]);
}

#[test]
fn unusable_times_are_no_date() {
    let mut bag = Builder::default();
    for _ in 0..5 {
        bag.laser(0.0);
    }
    let bag = bag.log();
    assert_eq!((bag.summary().has_times, bag.summary().begin_s), (false, None));
}

/// 40 s at 0.5 m/s, whose stamps pass at another pace than the recording and the speeds.
fn at_pace(pace: f64, speed_mps: f64) -> crate::summary::LogSummary {
    let mut bag = Builder::default();
    bag.mount();
    for step in 0..400 {
        let recorded_s = 0.1 * f64::from(step);
        bag.odometry("/odom", pace * recorded_s, 0.5 * recorded_s, 0.0);
        let data = &mut bag.messages.last_mut().unwrap().3;
        let mut odometry: ros::Odometry = ros::cdr::decoded(data).unwrap();
        odometry.twist.linear.x = speed_mps;
        *data = ros::cdr::encoded(&odometry).unwrap();
        bag.scan("/scan", recorded_s + 0.01, &scan(pace * recorded_s, "laser"));
    }
    bag.log().summary().clone()
}

#[test]
fn doubled_stamps_are_refused_where_the_speeds_show_them_and_noted_where_the_recording_does() {
    assert_eq!((at_pace(1.0, 0.5).impossible, at_pace(1.0, 0.5).notes), (None, vec![]));
    for pace in [0.5, 2.0] {
        let why = at_pace(pace, 0.5).impossible.unwrap();
        assert!(why.starts_with(&format!("the speeds of the odometry are {pace:.2} times those")), "{why}");
        // A log that was recorded while it was played twice as fast looks the same, and is right.
        let unknown = at_pace(pace, 0.0);
        assert!(unknown.impossible.is_none());
        assert_has(&unknown.notes[0], &["unless the log was recorded while it was played"]);
    }
}
