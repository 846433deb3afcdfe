//! A simulator, a bag and a live robot with the same readings: the same scans, maps, goals and commands.
//!
//! What a format changes: the angles of a `LaserScan` have 32 bits, so that the simulator reads scans as a message has them;
//! times have nanoseconds, and rotations are quaternions, so that poses and commands differ in their last bits. All else is
//! the same, bit for bit.

use super::*;
use crate::message::{Header, Pose, TransformStamped, Transforms};
use interfaces::{LaserReading, PoseMode, Scan, World};
use logs::{Log, McapWriter, TopicChoice};
use mapper::{Mapper, NoReturn};
use nalgebra::Isometry2;
use robot::{Pilot, Settings};
use ros::{scan_message, scan_of};
use sim::physics::PhysicsWorld;
use std::fs::File;
use std::ops::ControlFlow;
use survey::{LogEntry, Survey, SurveySettings};

const SECONDS: f64 = 30.0;
/// Poses and commands differ by less than this, m, rad, m/s and rad/s.
const ROUNDING: f64 = 1e-9;

fn ns(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}

/// The reading with its scan as a message has it.
fn as_sent(reading: &LaserReading) -> LaserReading {
    let message = scan_message(reading, "laser".to_owned(), ns(reading.time_s));
    LaserReading { scan: scan_of(message, false).unwrap(), ..reading.clone() }
}

fn transform(time_s: f64, (parent, child): (&str, &str), pose: &Isometry2<f64>) -> Message {
    let header = Header { stamp: Time::from_ns(ns(time_s)), frame_id: parent.to_owned() };
    let transform =
        TransformStamped { header, child_frame_id: child.to_owned(), transform: Pose::in_plane(pose) };
    Message::Transforms(Transforms { transforms: vec![transform] })
}

/// Sends a reading to a node.
fn send(node: &mut CuriousNode<FakeLink>, others: &FakeLink, reading: &LaserReading) {
    let time_s = reading.time_s;
    others.sends(Topic::StaticTransforms, transform(time_s, ("base_footprint", "laser"), &reading.mount));
    others.sends(Topic::Transforms, transform(time_s, ("odom", "base_footprint"), &reading.pose));
    others.sends(Topic::Scan, Message::Scan(scan_message(reading, "laser".to_owned(), ns(time_s))));
    (0..3).for_each(|_| node.turn(Duration::ZERO));
}

/// The largest difference between the points of the last scans of two maps, m.
fn apart_m(one: &Mapper, other: &Mapper) -> f64 {
    assert_eq!(one.points().len(), other.points().len());
    one.points().iter().zip(other.points()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn a_simulator_a_bag_and_a_live_robot_make_the_same_of_the_same_readings() {
    let turned = worldfile::shipped::load("turned_house").unwrap();
    let (spec, _) = turned.around_robot(0.0).unwrap();
    let parameters = Parameters {
        pose: PoseMode::Exact,
        max_laser_range_m: 8.0,
        no_return: NoReturn::Free,
        use_sim_time: true,
        ..parameters(Mode::Explore)
    };
    let settings = setup::settings(&parameters);
    let policy = parameters.policy().unwrap();
    let seed = parameters.seed as u64;
    let pilot = settings.pilot(settings.agent(&policy, seed).unwrap(), seed).unwrap();
    let frame = setup::frame(&parameters).unwrap();
    let mut simulated = settings.robot(frame, None, Isometry2::identity(), pilot).unwrap();
    let (mut node, others, _) = node(&parameters, None);
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("run.mcap");
    let mut writer = McapWriter::new(File::create(&bag).unwrap(), "bag", 1e9).unwrap();

    let mut world = PhysicsWorld::new(&spec, 1);
    world.correct_odometry();
    let (mut scans, mut goals): (Vec<Scan>, usize) = (Vec::new(), 0);
    while world.time_s() < SECONDS {
        let reading = world.sense();
        writer.reading(&reading).unwrap();
        send(&mut node, &others, &reading);
        let turn = simulated.step(as_sent(&reading)).unwrap();
        assert!(apart_m(&simulated.mapper, &node.robot.mapper) < ROUNDING, "at {} s", reading.time_s);
        assert!(simulated.mapper.states() == node.robot.mapper.states(), "at {} s", reading.time_s);
        assert_eq!(simulated.pilot.view().goal, node.robot.pilot.view().goal, "at {} s", reading.time_s);
        let velocities = others.heard(Topic::StampedVelocity);
        let Some(Message::TwistStamped(TwistStamped { twist, .. })) = velocities.last() else { panic!() };
        let off = [twist.linear.x - turn.command.linear_mps, twist.angular.z - turn.command.angular_radps];
        assert!(off.iter().all(|off| off.abs() < ROUNDING), "{off:?} at {} s", reading.time_s);
        others.others(|others| others.heard.clear());
        goals += simulated.pilot.take_messages().len();
        scans.push(turn.reading.scan);
        world.act(&turn.command);
    }
    assert!(goals > 1 && known(simulated.mapper.states()) > 5000);
    writer.finish().unwrap();
    a_survey_makes_the_same(&bag, &settings, &scans, simulated.mapper.states());
}

/// The survey of a bag has the same scans in the same map, as far as the frame of the log reaches.
fn a_survey_makes_the_same(bag: &Path, settings: &Settings, scans: &[Scan], expected: &Grid<CellState>) {
    let log = Log::open(bag, &TopicChoice::default()).unwrap();
    let entry = LogEntry::of(String::new(), &log, &TopicChoice::default()).unwrap();
    let of_log = SurveySettings {
        filter: settings.filter.clone(),
        mapper: settings.mapper.clone(),
        ..SurveySettings::of(PoseMode::Exact)
    };
    let mut survey = Survey::new(of_log, false);
    survey.first_pass(&log, entry, false, |_| ControlFlow::Continue(())).unwrap();
    let mut replay = survey.replay(0, &log).unwrap().unwrap();
    for (number, scan) in scans.iter().enumerate() {
        let turn = survey.turn(&mut replay).unwrap().unwrap();
        assert!(turn.reading.scan.ranges_m == scan.ranges_m, "scan {number}");
    }
    assert!(replay.is_over());
    let map = survey.mapper().unwrap().states();
    let mut compared = 0;
    for index in 0..map.frame().len() {
        let at = map.frame().center(map.frame().cell(index));
        let same = expected.get(expected.frame().cell_at(&at)).copied();
        assert_eq!(Some(map.cells()[index]), same, "{at}");
        compared += usize::from(map.cells()[index] != CellState::Unknown);
    }
    assert_eq!(compared, known(expected));
}
