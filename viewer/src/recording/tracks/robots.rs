//! The robots: body, heading and trail.

use super::{LABEL, Start, Track, color, order};
use crate::recording::path;
use crate::recording::rows::{Arrow, Now, Position, Rows, Strip, Target, position};
use crate::scene::RobotState;
use crate::scene::{Robot, TimeUnit};
use crate::view::{Trail, View};
use evaluation::palette;
use interfaces::rotation;
use nalgebra::{Isometry2, Point2, Vector2};
use rerun::{Arrows2D, LineStrips2D, Points2D, Radius, RecordingStreamResult};

pub(super) struct Robots(Vec<RobotRows>);

struct RobotRows {
    body: Rows<Position>,
    heading: Rows<Arrow>,
    trail: Rows<Strip>,
    so_far: Trail,
    radius_m: f64,
    /// Whether a pose has a heading. The robot of a grid world is drawn along its last move.
    has_heading: bool,
    last: Option<Isometry2<f64>>,
}

impl Robots {
    pub(super) fn new(start: Start) -> RecordingStreamResult<Self> {
        start.scene.robots.iter().try_for_each(|robot| log(start, robot))?;
        let has_heading = start.scene.unit == TimeUnit::Second;
        let rows = |robot: &Robot| RobotRows {
            body: Rows::new(path::robot(&robot.name, "body")),
            heading: Rows::new(path::robot(&robot.name, "heading")),
            trail: Rows::new(path::robot(&robot.name, "trail")),
            so_far: Trail::default(),
            radius_m: robot.radius_m,
            has_heading,
            last: None,
        };
        Ok(Self(start.scene.robots.iter().map(rows).collect()))
    }
}

impl Track for Robots {
    fn push(&mut self, now: Now, view: &View, _: bool) {
        self.0.iter_mut().zip(&view.robots).for_each(|(rows, robot)| rows.push(now, robot));
    }

    fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        self.0.iter_mut().try_for_each(|rows| {
            rows.body.flush(to)?;
            rows.heading.flush(to)?;
            rows.trail.flush(to)
        })
    }
}

impl RobotRows {
    fn push(&mut self, now: Now, robot: &RobotState) {
        let mut pose = robot.pose;
        if let (false, Some(last)) = (self.has_heading, self.last) {
            let moved = pose.translation.vector - last.translation.vector;
            let is_still = moved.norm() == 0.0;
            pose.rotation = if is_still { last.rotation } else { rotation(libm::atan2(moved.y, moved.x)) };
        }
        if self.last == Some(pose) {
            return;
        }
        self.last = Some(pose);
        let center = Point2::from(pose.translation.vector);
        let nose = pose * Vector2::new(1.4 * self.radius_m, 0.0);
        self.body.push(now, [position(&center)]);
        self.heading.push(now, [Arrow { origin: position(&center), vector: [nose.x as f32, nose.y as f32] }]);
        if self.so_far.push(center)
            && let [.., from, to] = self.so_far.points()
        {
            self.trail.push(now, [Strip(vec![position(from), position(to)])]);
        }
    }
}

/// Logs how a robot looks. The name is the label of the arrow, because a label has the color of its owner.
fn log(start: Start, robot: &Robot) -> RecordingStreamResult<()> {
    let part = |part| path::robot(&robot.name, part);
    let (own, trail_order) = if robot.is_driven {
        (palette::CURIOUS, order::TRAIL)
    } else {
        (palette::OTHER_ROBOT, order::OTHER_TRAIL)
    };
    let body = Points2D::update_fields()
        .with_colors([color(own, 255)])
        .with_radii([Radius::new_scene_units(robot.radius_m as f32)])
        .with_draw_order(order::BODY);
    start.stream.log_static(part("body"), &body)?;
    let heading = Arrows2D::update_fields()
        .with_colors([color(LABEL, 255)])
        .with_radii([Radius::new_ui_points(1.5)])
        .with_labels([robot.name.as_str()])
        .with_show_labels(start.scene.robots.len() > 1)
        .with_draw_order(order::HEADING);
    start.stream.log_static(part("heading"), &heading)?;
    let trail = LineStrips2D::update_fields()
        .with_colors([color(own, 140)])
        .with_radii([Radius::new_ui_points(1.0)])
        .with_draw_order(trail_order);
    start.stream.log_static(part("trail"), &trail)
}
