//! A house is mapped from a log, a robot goes on in this map, another log adds to it, and a forecast reads it: one file.

use super::*;
use interfaces::{Twist, World};
use logs::{Log, McapWriter, TopicChoice};
use robot::state::{StateFile, read_state};
use sim::physics::PhysicsWorld;
use std::fs::File;
use std::ops::ControlFlow;
use survey::{Forecast, LogEntry, Survey, SurveySettings};

const BEGIN_S: f64 = 1.7e9;
const DAY_S: f64 = 86_400.0;

/// A bag of a robot that turns on the spot where the robot of [`Pair`] starts.
fn bag(folder: &Path, name: &str, days: f64) -> Log {
    let path = folder.join(name);
    let mut writer = McapWriter::new(File::create(&path).unwrap(), "bag", BEGIN_S + days * DAY_S).unwrap();
    let mut world = PhysicsWorld::new(&worldfile::shipped::load("house").unwrap(), 1);
    while world.time_s() < 20.0 {
        writer.reading(&world.sense()).unwrap();
        world.act(&Twist { linear_mps: 0.0, angular_radps: 0.7 });
    }
    writer.finish().unwrap();
    Log::open(&path, &TopicChoice::default()).unwrap()
}

/// Adds a log to a state, as `map_log --state`.
fn add(state: &Path, folder: &Path, name: &str, days: f64) {
    let log = bag(folder, name, days);
    let settings = SurveySettings::default();
    let mut file = StateFile::open(state).unwrap();
    let mut survey = match file.load().unwrap() {
        Some(state) => Survey::restored(settings, true, &state).unwrap().0,
        None => Survey::new(settings, true),
    };
    let number = survey.logs().len();
    let mut entry = LogEntry::of(name.to_owned(), &log, &TopicChoice::default()).unwrap();
    (entry.offset_s, entry.content) = (days * DAY_S, log.content_hash().unwrap());
    survey.first_pass(&log, entry, true, |_| ControlFlow::Continue(())).unwrap();
    let mut replay = survey.replay(number, &log).unwrap().unwrap();
    while !replay.is_over() {
        survey.turn(&mut replay).unwrap().unwrap();
    }
    file.save(survey.saved()).unwrap();
    file.wait().unwrap();
}

#[test]
fn a_map_of_logs_goes_to_a_robot_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.state");
    add(&path, folder.path(), "monday", 0.0);
    let of_log = known(read_state(&path).unwrap().map.unwrap().mapper().unwrap().states());

    let mut pair = Pair::new(&parameters(Mode::Map), (BEGIN_S + DAY_S) as i64, Some(&path));
    assert!(pair.is_said("the map goes on from"));
    pair.run(8.0);
    assert_eq!(pair.node.pose_state, PoseState::Tracking, "{:?}", pair.said);
    assert!(pair.node.report().mapped > 30, "{:?}", pair.node.report());
    assert!((pair.node.robot.mapper.time() - DAY_S).abs() < 60.0, "{} s", pair.node.robot.mapper.time());
    pair.node.run(&Signals { stop: Arc::new(true.into()), ..Signals::default() }).unwrap();
    drop(pair);

    add(&path, folder.path(), "friday", 4.0);
    let state = read_state(&path).unwrap();
    let names: Vec<String> = state.sessions.iter().map(|session| session.name.clone()).collect();
    assert_eq!(names, ["monday", "curious_node 2", "friday"]);
    let forecast = Forecast::of_state(&state).unwrap();
    assert!(forecast.why_undated().is_none() && forecast.now_s() > BEGIN_S + 4.0 * DAY_S);
    assert!(known(forecast.mapper().states()) >= of_log, "{of_log}");
}
