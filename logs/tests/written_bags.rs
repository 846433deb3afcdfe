//! Bags that are written and read again.

use interfaces::{Event, Grid, GridFrame, LaserReading, Scan, Twist, VelocitySample, heading_rad, wrap_rad};
use logs::{Log, LogSummary, McapWriter, TopicChoice};
use mcap::MessageStream;
use nalgebra::{Isometry2, Point2};
use ros::cdr::decoded;
use ros::{LaserScan, OccupancyGrid, Odometry, Path, PointCloud2, Pose, PoseStamped, Transforms};
use std::f64::consts::{PI, TAU};
use std::io::Cursor;

const BEGIN_S: f64 = 1_700_000_000.25;

/// A robot that drives an arc with 0.8 m/s and 0.5 rad/s. Every scan sweeps, or none.
fn driven(sweep_s: f64) -> Vec<LaserReading> {
    let start = interfaces::pose(3.0, -2.0, 1.0);
    let twist = Twist { linear_mps: 0.8, angular_radps: 0.5 };
    let pose = |time_s: f64| {
        let turn_rad = twist.angular_radps * time_s;
        let radius_m = twist.linear_mps / twist.angular_radps;
        start * interfaces::pose(radius_m * turn_rad.sin(), radius_m * (1.0 - turn_rad.cos()), turn_rad)
    };
    let reading = |step: u32| {
        let time_s = f64::from(step) * 0.1;
        let mut ranges_m: Vec<f32> = (0..360).map(|beam| 1.0 + (beam + step) as f32 * 0.017).collect();
        ranges_m[7..10].copy_from_slice(&[f32::INFINITY, f32::NEG_INFINITY, f32::NAN]);
        let sample = |part: u32| VelocitySample { time_s: time_s - 0.08 + f64::from(part) * 0.02, twist };
        let velocities = (0..if sweep_s > 0.0 { 5 } else { 0 }).map(sample).collect();
        LaserReading {
            time_s,
            pose: pose(time_s),
            twist,
            velocities,
            mount: interfaces::pose(0.1, -0.05, PI),
            scan: Scan {
                angle_min_rad: f64::from(-3.0_f32),
                angle_increment_rad: f64::from((TAU / 360.0) as f32),
                range_max_m: 12.0,
                sweep_s,
                ranges_m,
                ..Scan::default()
            },
        }
    };
    (0..40).map(reading).collect()
}

fn written(write: impl FnOnce(&mut McapWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    written_from(BEGIN_S, write)
}

fn of_readings(begin_s: f64, readings: &[LaserReading]) -> Vec<u8> {
    written_from(begin_s, |writer| readings.iter().for_each(|reading| writer.reading(reading).unwrap()))
}

fn written_from(begin_s: f64, write: impl FnOnce(&mut McapWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut writer = McapWriter::new(Cursor::new(Vec::new()), "test", begin_s).unwrap();
    write(&mut writer);
    writer.finish().unwrap().into_inner()
}

/// What a recording contains when it is read, and its readings.
fn read(bytes: &[u8]) -> (LogSummary, Vec<LaserReading>) {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let log = Log::open(file.path(), &TopicChoice::default()).unwrap();
    (log.summary().clone(), log.readings().unwrap().map(Result::unwrap).collect())
}

/// The messages of a topic.
fn messages<T: serde::de::DeserializeOwned>(bytes: &[u8], topic: &str) -> Vec<T> {
    let all = MessageStream::new(bytes).unwrap().map(Result::unwrap);
    all.filter(|message| message.channel.topic == topic)
        .map(|message| decoded(&message.data).unwrap())
        .collect()
}

fn assert_same(found: &LaserReading, expected: &LaserReading, origin: &Isometry2<f64>) {
    assert!((found.time_s - expected.time_s).abs() < 1e-9, "{} s", found.time_s);
    for (found, expected) in [(origin * found.pose, expected.pose), (found.mount, expected.mount)] {
        let away = (found.translation.vector - expected.translation.vector).norm();
        let turned = wrap_rad(heading_rad(&found) - heading_rad(&expected)).abs();
        assert!(away < 1e-9 && turned < 1e-9, "{found} instead of {expected}");
    }
    let bits = |reading: &LaserReading| -> Vec<u32> {
        reading.scan.ranges_m.iter().map(|range_m| range_m.to_bits()).collect()
    };
    assert_eq!(bits(found), bits(expected));
    let figures =
        |scan: &Scan| [scan.angle_min_rad, scan.angle_increment_rad, scan.range_min_m, scan.range_max_m];
    assert_eq!(figures(&found.scan), figures(&expected.scan));
    assert!((found.scan.sweep_s - expected.scan.sweep_s).abs() < 1e-8);
}

/// The frame of the poses that are read begins at the first one of the odometry.
fn assert_all_same(found: &[LaserReading], expected: &[LaserReading]) {
    let origin = expected[0].pose * found[0].pose.inverse();
    found.iter().zip(expected).for_each(|(found, expected)| assert_same(found, expected, &origin));
}

#[test]
fn readings_come_back() {
    for sweep_s in [0.0, 0.1] {
        let readings = driven(sweep_s);
        let (summary, found) = read(&of_readings(BEGIN_S, &readings));
        assert_eq!((summary.scans, summary.notes.len()), (readings.len(), 0), "{:?}", summary.notes);
        assert!((summary.begin_s.unwrap() - BEGIN_S).abs() < 1e-6);
        assert_all_same(&found, &readings);
        for (found, expected) in found.iter().zip(&readings) {
            assert_eq!(found.velocities.len(), expected.velocities.len());
            for (found, expected) in found.velocities.iter().zip(&expected.velocities) {
                let is_near = (found.time_s - expected.time_s).abs() < 1e-6
                    && (found.twist.linear_mps - 0.8).abs() < 1e-3
                    && (found.twist.angular_radps - 0.5).abs() < 1e-3;
                assert!(is_near, "{found:?} instead of {expected:?}");
            }
        }
    }
}

/// Clients of ROS refuse times before 0.
#[test]
fn no_stamp_of_a_run_without_a_date_is_negative() {
    let readings = driven(0.1);
    let bytes = of_readings(0.0, &readings);
    let scans: Vec<LaserScan> = messages(&bytes, "/scan");
    let odometry: Vec<Odometry> = messages(&bytes, "/odom");
    assert!((9_000_000_000..10_000_000_000).contains(&scans[0].header.stamp.ns()));
    assert!(odometry.iter().all(|odometry| odometry.header.stamp.sec >= 0));
    let (summary, found) = read(&bytes);
    assert_eq!((summary.begin_s, summary.notes.len()), (None, 0), "{:?}", summary.notes);
    assert_all_same(&found, &readings);
}

#[test]
fn every_scan_has_its_place_on_the_robot() {
    let two: fn(usize) -> [f64; 2] = |step| if step % 2 == 1 { [-0.3, 1.0] } else { [0.1, PI] };
    let pans = |step| [0.1, 0.7 * (step as f64 * 0.4).sin()];
    for mount in [two, pans] {
        let mut readings = driven(0.0);
        for (step, reading) in readings.iter_mut().enumerate() {
            let [ahead_m, turn_rad] = mount(step);
            reading.mount = interfaces::pose(ahead_m, 0.0, turn_rad);
        }
        let (summary, found) = read(&of_readings(BEGIN_S, &readings));
        assert_eq!(summary.scan_topics, ["/scan"]);
        assert_all_same(&found, &readings);
    }
}

#[test]
fn headings_are_exact() {
    for step in -314..=314 {
        let heading = f64::from(step) * 0.01;
        let pose = interfaces::pose(1.0, 2.0, heading);
        let found = Pose::in_plane(&pose).isometry().unwrap().rotation.euler_angles().2;
        assert!(wrap_rad(found - heading).abs() < 1e-14, "{found} instead of {heading}");
    }
    let back = Pose::in_plane(&interfaces::pose(0.0, 0.0, PI)).orientation;
    assert!((back.z.abs() - 1.0).abs() < 1e-15 && back.w.abs() < 1e-15, "{back:?}");
}

#[test]
fn a_map_is_written_when_it_has_changed() {
    let frame = GridFrame::new(Point2::new(-1.0, 2.0), 0.05, 4, 3).unwrap();
    let mut grid = Grid::filled(frame, None);
    let share = |cell: &Option<f64>| *cell;
    let bytes = written(|writer| {
        writer.grid("/map", 0.0, &grid, share).unwrap();
        writer.grid("/map", 1.0, &grid, share).unwrap(); // nothing changed
        grid.cells_mut()[5] = Some(1.0);
        grid.cells_mut()[10] = Some(0.504);
        grid.cells_mut()[0] = Some(0.0);
        writer.grid("/map", 2.0, &grid, share).unwrap();
    });
    let whole: Vec<OccupancyGrid> = messages(&bytes, "/map");
    assert_eq!(whole.len(), 2);
    assert_eq!((whole[0].width, whole[0].height, whole[0].resolution), (4, 3, 0.05));
    assert_eq!((whole[0].origin.position.x, whole[0].origin.position.y), (-1.0, 2.0));
    assert!(whole[0].data.iter().all(|cell| *cell == -1));
    assert_eq!(whole[1].data, [0, -1, -1, -1, -1, 100, -1, -1, -1, -1, 50, -1]);
}

#[test]
fn goals_paths_corrections_and_changes_are_messages_of_the_map() {
    let goal = interfaces::pose(1.0, 2.0, 0.5);
    let bytes = written(|writer| {
        writer.goal(1.0, &goal).unwrap();
        writer.path(1.0, &[goal, goal]).unwrap();
        writer.correction(1.0, &interfaces::pose(0.5, 0.0, 0.0)).unwrap();
        writer
            .events(1.0, &[(Point2::new(0.25, -1.0), Event::Block), (Point2::new(2.0, 3.0), Event::Free)])
            .unwrap();
    });
    let goals: Vec<PoseStamped> = messages(&bytes, "/goal_pose");
    assert_eq!(goals[0].header.frame_id, "map");
    assert_eq!(goals[0].header.stamp.ns(), 1_700_000_001_250_000_000);
    assert_eq!(goals[0].pose, Pose::in_plane(&goal));
    let paths: Vec<Path> = messages(&bytes, "/plan");
    assert_eq!(paths[0].poses.len(), 2);
    let corrections: Vec<Transforms> = messages(&bytes, "/tf");
    assert_eq!(corrections[0].transforms[0].child_frame_id, "odom");
    let clouds: Vec<PointCloud2> = messages(&bytes, "/changes");
    assert_eq!((clouds[0].width, clouds[0].point_step, clouds[0].fields[3].name.as_str()), (2, 16, "change"));
    let values: Vec<f32> =
        clouds[0].data.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
    assert_eq!(values, [0.25, -1.0, 0.0, 1.0, 2.0, 3.0, 0.0, -1.0]);
}

/// Hash maps have another order in every map: without the sorting, two of eight files differ.
#[test]
fn the_same_run_gives_the_same_bytes() {
    let file = || {
        written(|writer| {
            for reading in driven(0.0) {
                writer.reading(&reading).unwrap();
                writer.goal(reading.time_s, &reading.pose).unwrap();
                writer.path(reading.time_s, &[reading.pose]).unwrap();
            }
        })
    };
    let first = file();
    assert!((0..8).all(|_| file() == first));
    // The index is sound: its checksum, and every topic in it.
    let summary = mcap::Summary::read(&first).unwrap().unwrap();
    assert!(summary.channels.len() >= 5, "{}", summary.channels.len());
    let end = first.len() - mcap::MAGIC.len();
    let number = |at: usize| u64::from_le_bytes(first[at..at + 8].try_into().unwrap()) as usize;
    let checksum = u32::from_le_bytes(first[end - 4..end].try_into().unwrap());
    let mut crc = flate2::Crc::new();
    crc.update(&first[number(end - 20)..end - 4]);
    assert_eq!(crc.sum(), checksum);
}
