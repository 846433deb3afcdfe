//! The managed lifecycle, parameters at run time, and the services of `slam_toolbox`.

use super::*;
use crate::message::Log;
use crate::service::wire::{Deserialize, Labelled, Parameter};
use crate::value::Value;

fn change(pair: &mut Pair, id: u8, label: &str) -> Reply {
    let asked = Labelled { id, label: label.to_owned() };
    pair.call(Service::ChangeState, Call::Transition(asked))
}

fn state(pair: &mut Pair) -> String {
    let reply = pair.call(Service::GetState, Call::Nothing);
    let Reply::State(state) = reply else { panic!("{reply:?}") };
    state.label
}

fn set(pair: &mut Pair, name: &str, value: Value) -> (bool, String) {
    let parameter = Parameter { name: name.to_owned(), value: (&value).into() };
    let reply = pair.call(Service::SetParameters, Call::Parameters(vec![parameter]));
    let Reply::Results(results) = reply else { panic!("{reply:?}") };
    (results[0].successful, results[0].reason.clone())
}

#[test]
fn a_manager_configures_activates_deactivates_and_cleans_up() {
    let waiting = Parameters { autostart: false, ..parameters(Mode::Map) };
    let mut pair = Pair::new(&waiting, 0, None);
    assert_eq!(state(&mut pair), "unconfigured");
    pair.run(2.0);
    assert_eq!((pair.node.report().readings, pair.others.heard(Topic::Map).len()), (0, 0));
    assert_eq!(change(&mut pair, 3, ""), Reply::Success(false), "an unconfigured node cannot be activated");
    assert!(set(&mut pair, "resolution", Value::Float(0.1)).0);
    assert_eq!(change(&mut pair, 1, ""), Reply::Success(true));
    assert_eq!(state(&mut pair), "inactive");
    pair.run(2.0);
    assert_eq!(pair.node.report().readings, 0);
    assert_eq!(change(&mut pair, 3, ""), Reply::Success(true));
    pair.run(4.0);
    let readings = pair.node.report().readings;
    assert!(readings >= 38, "{readings}");
    assert_eq!(pair.node.robot.mapper.frame().resolution_m(), 0.1);
    // A name goes before a number.
    assert_eq!(change(&mut pair, 0, "deactivate"), Reply::Success(true));
    pair.others.others(|others| others.heard.clear());
    pair.run(5.0);
    assert_eq!(pair.node.report().readings, readings);
    assert_eq!(pair.others.heard(Topic::Transforms), []);
    assert_eq!(change(&mut pair, 3, ""), Reply::Success(true));
    pair.run(4.0);
    assert!(pair.node.report().readings > readings + 30);
    assert_eq!(pair.node.pose_state, PoseState::Tracking, "the robot finds its place again");
    assert_eq!(change(&mut pair, 4, ""), Reply::Success(true));
    assert_eq!(change(&mut pair, 2, ""), Reply::Success(true));
    assert_eq!((state(&mut pair).as_str(), pair.node.robot.mapper.readings()), ("unconfigured", 0));
    assert_eq!(change(&mut pair, 5, "shutdown"), Reply::Success(true));
    assert_eq!(state(&mut pair), "finalized");
    let events = pair.others.heard(Topic::TransitionEvents);
    let Some(Message::TransitionEvent(last)) = events.last() else { panic!("{events:?}") };
    assert_eq!((last.transition.transition.id, last.transition.goal_state.id), (5, 4));
}

#[test]
fn parameters_are_set_where_that_is_safe() {
    let mut pair = Pair::new(&parameters(Mode::Map), 0, None);
    pair.run(3.0);
    assert_eq!(set(&mut pair, "change_horizon", Value::Float(600.0)), (true, String::new()));
    assert_eq!(pair.node.parameters.change_horizon_s, 600.0);
    let refused = |pair: &mut Pair, name, value| {
        let (successful, reason) = set(pair, name, value);
        assert!(!successful, "{name}");
        reason
    };
    let out = refused(&mut pair, "change_horizon", Value::Float(0.0));
    assert_eq!(out, "node setting `change_horizon` must be from 0.1 to 86400, not 0");
    let map = refused(&mut pair, "resolution", Value::Float(0.1));
    assert!(map.starts_with("the parameter `resolution` can be set while the node is unconfigured"), "{map}");
    let mode = refused(&mut pair, "mode", Value::Text("explore".to_owned()));
    assert_eq!(mode, "the parameter `mode` can be set when the node starts");
    let off = refused(&mut pair, "mask_update_interval", Value::Float(0.0));
    assert!(off.starts_with("the parameter `mask_update_interval` is 30.0: a value of 0"), "{off}");
    assert_eq!(pair.node.parameters.mask_update_interval_s, 30.0);
    let events = pair.others.heard(Topic::ParameterEvents);
    let [Message::ParameterEvent(event)] = events.as_slice() else { panic!("{events:?}") };
    assert_eq!((event.node.as_str(), event.changed[0].name.as_str()), ("/curious_node", "change_horizon"));
    // Every parameter is described, and can be read.
    let names: Vec<String> = pair.node.parameters.list().into_iter().map(|(name, _)| name).collect();
    let asked = Call::Names(names.clone());
    let reply = pair.call(Service::DescribeParameters, asked);
    let Reply::Descriptions(all) = reply else { panic!("{reply:?}") };
    assert_eq!(all.len(), names.len());
    assert!(all.iter().all(|one| one.description.len() > 5), "{all:?}");
    assert_eq!(all.iter().filter(|one| one.read_only).count(), 12);
    let reply = pair.call(Service::GetParameters, Call::Names(names));
    let Reply::Values(values) = reply else { panic!("{reply:?}") };
    assert!(values.iter().all(|value| value.value().is_some()));
}

#[test]
fn what_the_node_says_is_in_the_log() {
    let mut pair = Pair::new(&parameters(Mode::Map), 0, None);
    pair.run(2.0);
    let asked = Labelled { id: 99, label: String::new() };
    pair.call(Service::ChangeState, Call::Transition(asked));
    let log = pair.others.heard(Topic::Log);
    let Some(Message::Log(last)) = log.last() else { panic!("{log:?}") };
    assert_eq!((last.level, last.name.as_str()), (Log::WARNING, "curious_node"));
    assert_eq!(last.msg, "the node is active: the transition 99  is refused");
    assert!(last.stamp.ns() > 1_900_000_000, "{:?}", last.stamp);
    assert_eq!(log.len(), pair.said.lock().unwrap().len());
}

#[test]
fn a_map_is_saved_and_loaded_as_by_slam_toolbox() {
    let folder = tempfile::tempdir().unwrap();
    let name = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let map_folder = folder.path().to_str().unwrap().to_owned();
    let mut pair = Pair::new(&Parameters { map_folder, ..parameters(Mode::Map) }, 0, None);
    let none = pair.call(Service::SaveMap, Call::Name(name("early")));
    assert_eq!(none, Reply::Code(2));
    pair.run(5.0);
    assert_eq!(pair.call(Service::SaveMap, Call::Name(name("house"))), Reply::Code(0));
    let yaml = std::fs::read_to_string(name("house.yaml")).unwrap();
    assert!(yaml.contains("image: house.pgm") && folder.path().join("house.pgm").is_file(), "{yaml}");
    assert_eq!(pair.call(Service::SerializeMap, Call::Name(name("house"))), Reply::Code(0));
    let learned = pair.node.robot.mapper.states().clone();

    let mut again = Pair::new(&parameters(Mode::Map), 1000, None);
    let load = |filename: String, match_type, pose: Isometry2<f64>| {
        let initial_pose = crate::message::Pose::in_plane(&pose);
        Call::Deserialize(Deserialize { filename, match_type, initial_pose })
    };
    let start = Isometry2::identity();
    assert_eq!(again.call(Service::DeserializeMap, load(name("none"), 1, start)), Reply::Code(1));
    std::fs::write(name("bad.state"), b"nothing").unwrap();
    assert_eq!(again.call(Service::DeserializeMap, load(name("bad"), 1, start)), Reply::Code(3));
    assert_eq!(again.call(Service::DeserializeMap, load(name("house"), 1, start)), Reply::Code(0));
    assert_eq!(again.node.robot.mapper.states(), &learned);
    assert_eq!(again.others.heard(Topic::Map).len(), 1);
    again.run(2.0);
    assert_eq!(again.node.pose_state, PoseState::Tracking);
    let readings = again.node.robot.mapper.readings();
    assert!(readings > 55, "the map grows from what was loaded: {readings}");
}

/// Everybody in the network can call the services: they write below one folder, and replace only files of a
/// run.
#[test]
fn services_replace_no_file_of_others() {
    let outer = tempfile::tempdir().unwrap();
    let [maps, home] = ["maps", "home"].map(|name| outer.path().join(name));
    std::fs::create_dir_all(maps.join("below")).unwrap();
    std::fs::create_dir(&home).unwrap();
    std::os::unix::fs::symlink(&home, maps.join("link")).unwrap();
    for name in ["other.yaml", "picture.pgm", "foreign.state", "locked.state.lock", "kept.state.earlier"] {
        [&maps, &home].iter().for_each(|folder| std::fs::write(folder.join(name), "of the user").unwrap());
    }
    std::os::unix::fs::symlink(home.join("new.yaml"), maps.join("dangling.yaml")).unwrap();
    let map_folder = maps.to_str().unwrap().to_owned();
    let mut pair = Pair::new(&Parameters { map_folder, ..parameters(Mode::Map) }, 0, None);
    pair.run(2.0);
    let inside = maps.join("inside").to_str().unwrap().to_owned();
    let outside = home.join("other").to_str().unwrap().to_owned();
    for good in ["a", "a", "below/b c", &inside, "below/../d"] {
        for service in [Service::SaveMap, Service::SerializeMap] {
            assert_eq!(pair.call(service, Call::Name(good.to_owned())), Reply::Code(0), "{good}");
        }
    }
    let everything = |folder: &Path| {
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files = files.filter(|file| !file.ends_with(".curious_files.json"));
        let mut all: Vec<_> = files.map(|file| (std::fs::read(&file).ok(), file)).collect();
        all.sort();
        all
    };
    let before = [&maps, &home].map(|folder| everything(folder));
    for bad in [
        "other",
        "picture",
        "foreign",
        "locked",
        "kept",
        "dangling",
        "link/new",
        "link/other",
        "../home/new",
        "none/new",
        "..",
        "/",
        "below/",
        "a\nimage: /etc/passwd\n#",
        "a: {b",
        "\u{1b}[2J",
        "~/.x$",
        "/dev/null",
        "/proc/self/x",
        &outside,
        &"x".repeat(300),
        &"a/".repeat(3000),
    ] {
        let saved = pair.call(Service::SaveMap, Call::Name(bad.to_owned()));
        let has_own_endings = ["foreign", "locked", "kept"].contains(&bad);
        let serialized = pair.call(Service::SerializeMap, Call::Name(bad.to_owned()));
        assert_eq!(saved == Reply::Code(0), has_own_endings, "{bad}");
        assert_eq!(serialized == Reply::Code(0), ["other", "picture", "dangling"].contains(&bad), "{bad}");
    }
    let changed: Vec<_> =
        before.iter().flatten().filter(|(text, file)| std::fs::read(file).ok() != *text).collect();
    assert!(changed.is_empty(), "{changed:?}");
    assert_eq!(everything(&home), before[1]);
}

#[test]
fn frames_have_names_of_their_own() {
    let frames = |map: &str, odom: &str, base: &str| {
        let [map_frame, odom_frame, base_frame] = [map, odom, base].map(str::to_owned);
        Parameters { map_frame, odom_frame, base_frame, ..parameters(Mode::Map) }.check()
    };
    frames("map", "odom", "base_link").unwrap();
    for (map, odom, base) in [
        ("map", "map", "b"),
        ("map", "/map", "b"),
        ("map", "odom", "odom"),
        ("map", "odom", "/map"),
        ("map", "/", "b"),
    ] {
        frames(map, odom, base).unwrap_err();
    }
    let error = frames("map", "map", "base_link").unwrap_err().to_string();
    assert_eq!(error, "the parameter `odom_frame` must be another frame than `map_frame`, not `map`");
}
