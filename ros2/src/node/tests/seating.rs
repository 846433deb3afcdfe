//! `initialpose`, and edges for `nav2_route`.

use super::*;
use crate::message::{PoseWithCovarianceStamped, header};
use nalgebra::{Matrix3, Vector2};

/// What rviz sends: a standard deviation of 0.5 m and 15°.
fn initial_pose(frame: &str, pose: Isometry2<f64>) -> Message {
    let covariance = Matrix3::from_diagonal(&[0.25, 0.25, 0.0685].into());
    let pose = PoseWithCovarianceStamped::in_plane(header(Time::default(), frame), &pose, &covariance);
    Message::PoseWithCovariance(Box::new(pose))
}

fn error_m(pair: &Pair) -> f64 {
    let start = worldfile::shipped::load("house").unwrap().driven().pose;
    let [truth, odometry] = pair.sim.poses().unwrap();
    let found = pair.node.published.map_to_odom.unwrap() * odometry;
    ((start.inverse() * truth).translation.vector - found.translation.vector).norm()
}

#[test]
fn an_initial_pose_puts_the_robot_there() {
    let mut pair = Pair::new(&parameters(Mode::Map), 0, None);
    pair.run(5.0);
    assert!(error_m(&pair) < 0.02, "{} m", error_m(&pair));
    // A pose that is off by what a hand in rviz is off by is corrected.
    let near = Isometry2::new(Vector2::new(0.3, -0.2), 0.15);
    pair.others.sends(Topic::InitialPose, initial_pose("/map", near));
    pair.run(2.0);
    assert!(pair.is_said("the robot is put at (0.30, -0.20), 9°"));
    assert!(error_m(&pair) < 0.05, "{} m", error_m(&pair));
    assert_eq!(pair.node.pose_state, PoseState::Tracking);
    // A pose that the scans refuse is searched for.
    let far = Isometry2::new(Vector2::new(3.0, 3.0), 2.0);
    pair.others.sends(Topic::InitialPose, initial_pose("map", far));
    pair.run(12.0);
    assert!(error_m(&pair) < 0.05, "{} m", error_m(&pair));
}

#[test]
fn an_initial_pose_that_cannot_be_used_is_one_sentence() {
    let mut pair = Pair::new(&parameters(Mode::Map), 0, None);
    pair.run(3.0);
    pair.others.sends(Topic::InitialPose, initial_pose("odom", Isometry2::identity()));
    pair.others.sends(Topic::InitialPose, initial_pose("odom", Isometry2::identity()));
    pair.run(0.5);
    let said = pair.said.lock().unwrap().clone();
    let refused: Vec<&String> = said.iter().filter(|text| text.contains("initial pose")).collect();
    assert_eq!(refused, ["an initial pose is not used: it is in the frame `odom`, and not in `map`"]);
    let by_odometry = Parameters { pose: PoseMode::Odometry, ..parameters(Mode::Map) };
    let mut pair = Pair::new(&by_odometry, 0, None);
    pair.others.sends(Topic::InitialPose, initial_pose("map", Isometry2::identity()));
    pair.run(0.5);
    let says = "an initial pose is not used: the parameter `pose` says that the odometry knows the pose";
    assert!(pair.is_said(says));
}

#[test]
fn nav2_route_hears_which_edges_are_open() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("graph.geojson");
    let graph = r#"{"type": "FeatureCollection", "features": [
        {"properties": {"id": 0, "frame": "map"}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
        {"properties": {"id": 1, "frame": "map"}, "geometry": {"type": "Point", "coordinates": [0.5, 0]}},
        {"properties": {"id": 2, "startid": 0, "endid": 1}, "geometry": {"type": "MultiLineString"}},
        {"properties": {"id": 3, "startid": 1, "endid": 0}, "geometry": {"type": "MultiLineString"}}]}"#;
    std::fs::write(&path, graph).unwrap();
    let route_graph = path.to_str().unwrap().to_owned();
    let with_graph = Parameters { route_graph, ..parameters(Mode::Map) };
    let mut pair = Pair::new(&with_graph, 0, None);
    pair.run(3.0);
    let sent = pair.others.others(|others| others.edges.clone());
    // One request in ten seconds; nothing was seen to change here, and the way is free.
    assert_eq!(sent.len(), 1, "{sent:?}");
    assert_eq!((sent[0].closed.len(), sent[0].opened.clone()), (0, vec![2, 3]));
    assert!(sent[0].adjusted.iter().all(|(_, cost)| (0.0..0.1).contains(cost)), "{sent:?}");
    pair.others.others(|others| others.events.push_back(Event::EdgesAdjusted(false)));
    pair.run(0.2);
    assert!(pair.is_said("`route_server/DynamicEdgesScorer/adjust_edges` does not answer"));
    std::fs::write(&path, "{}").unwrap();
    let error = refused(&with_graph, None);
    assert!(
        error.ends_with("graph.geojson: this is no graph of nav2_route: it has no list `features`"),
        "{error}"
    );
}
