//! Everything solid in the world, what the curious robot sees, and its plan.

use super::{
    EVENTS, Kind, LABEL, ON_CHANGE, Strip, Tracks, WORLD, closed, color, escape, line, order, points,
};
use super::{position, strips};
use draw::view::{View, is_next_point};
use draw::{outline, palette};
use nalgebra::{Isometry2, Vector2};
use rerun::{Arrows2D, AsComponents, Points2D, Radius, RecordingStreamResult, Transform3D};

/// A part of a robot.
pub(in crate::recording) fn robot(name: &str, part: &str) -> String {
    format!("{WORLD}/robots/{}/{part}", escape(name))
}

pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    field_of_view(tracks)?;
    obstacles(tracks)?;
    let scene = tracks.scene;
    for (index, robot) in scene.robots.iter().enumerate() {
        body(tracks, index)?;
        let trail = self::robot(&robot.name, "trail");
        let order = if robot.is_driven { order::TRAIL } else { order::OTHER_TRAIL };
        tracks.always(&trail, &line(color(robot.color(), 140), 1.0, order))?;
        add_trail(tracks, trail, move |view| Some(view.robots[index].pose));
    }
    plan(tracks)
}

/// Adds the outline of what the robot sees; nothing if no robot sees in the first view.
fn field_of_view(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    if tracks.view.sight().is_none() {
        return Ok(());
    }
    let path = format!("{WORLD}/field_of_view");
    tracks.always(&path, &line(color(palette::SENSOR, 220), 1.5, order::SIGHT_OUTLINE))?;
    let outline = |view: &View| {
        let corners = view.sight().map(outline::field_of_view);
        corners.iter().map(|corners| corners.iter().map(position).collect()).collect()
    };
    tracks.add(path, (Kind::State, 0.2), outline, strips);
    Ok(())
}

/// Adds the walls, and everything else that is no robot.
fn obstacles(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let scene = tracks.scene;
    let walls = line(color(palette::WALL, 255), 1.0, order::WALLS);
    let walls = walls.with_strips(scene.walls.iter().map(|wall| closed(wall)));
    tracks.always(&format!("{WORLD}/walls"), &walls)?;
    for (index, obstacle) in scene.obstacles.iter().enumerate() {
        let path = format!("{WORLD}/obstacles/{}", escape(&obstacle.name));
        tracks.always(&path, &line(color(obstacle.color(), 255), 2.5, order::WALLS))?;
        let outline =
            move |view: &View| view.obstacles[index].iter().map(|outline| closed(outline)).collect();
        tracks.add(path, ON_CHANGE, outline, strips);
    }
    Ok(())
}

/// Adds the trail of the poses that `pose` reads from the views: a line from place to place.
pub(super) fn add_trail(
    tracks: &mut Tracks,
    path: String,
    pose: impl Fn(&View) -> Option<Isometry2<f64>> + Send + 'static,
) {
    let mut last = None;
    let step = move |view: &View| -> Vec<Strip> {
        let now = pose(view).map(|pose| pose.translation.vector.into());
        let Some(now) = now.filter(|now| is_next_point(last.as_ref(), now)) else { return Vec::new() };
        last.replace(now).map(|last| vec![position(&last), position(&now)]).into_iter().collect()
    };
    tracks.add(path, EVENTS, step, strips);
}

/// Adds the body of a robot: a disc, its heading, and its name below if there are several robots.
fn body(tracks: &mut Tracks, index: usize) -> RecordingStreamResult<()> {
    let scene = tracks.scene;
    let robot = &scene.robots[index];
    let (path, radius_m) = (self::robot(&robot.name, "body"), robot.radius_m as f32);
    let disc = Points2D::new([[0.0, 0.0]])
        .with_colors([color(robot.color(), 255)])
        .with_radii([Radius::new_scene_units(radius_m)])
        .with_draw_order(order::BODY);
    let heading = Arrows2D::update_fields()
        .with_colors([color(LABEL, 255)])
        .with_radii([Radius::new_ui_points(1.5)])
        .with_draw_order(order::HEADING);
    tracks.always(&path, &[&disc as &dyn AsComponents, &heading])?;
    if scene.robots.len() > 1 {
        let below = Points2D::new([[0.0, -1.2 * radius_m]])
            .with_labels([robot.name.as_str()])
            .with_show_labels(true)
            .with_radii([Radius::new_ui_points(0.0)])
            .with_colors([color(LABEL, 255)]);
        tracks.always(&format!("{path}/name"), &below)?;
    }
    let nose = Vector2::new(1.4 * robot.radius_m, 0.0);
    let pose = move |view: &View| {
        let pose = view.robots[index].pose;
        vec![(position(&pose.translation.vector.into()), position(&(pose * nose).into()))]
    };
    tracks.add(path, ON_CHANGE, pose, |poses| -> [Box<dyn AsComponents>; 2] {
        let places = poses.iter().map(|([x, y], _)| [*x, *y, 0.0]);
        let vectors = poses.iter().map(|(_, vector)| *vector);
        [
            Box::new(Transform3D::update_fields().with_many_translation(places)),
            Box::new(Arrows2D::update_fields().with_vectors(vectors)),
        ]
    });
    Ok(())
}

/// Adds path and goal of the curious robot.
fn plan(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let (path, goal) = (format!("{WORLD}/path"), format!("{WORLD}/goal"));
    tracks.always(&path, &line(color(palette::PATH, 255), 1.5, order::PATH))?;
    let dot = Points2D::update_fields()
        .with_colors([color(palette::GOAL, 255)])
        .with_radii([Radius::new_ui_points(6.0)])
        .with_draw_order(order::PATH);
    tracks.always(&goal, &dot)?;
    let strip = |view: &View| {
        let path: Strip = view.path.iter().map(position).collect();
        if path.len() > 1 { vec![path] } else { Vec::new() }
    };
    tracks.add(path, ON_CHANGE, strip, strips);
    tracks.add(goal, ON_CHANGE, |view| view.goal.iter().map(position).collect(), points);
    Ok(())
}
