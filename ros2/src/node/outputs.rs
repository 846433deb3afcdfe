//! The messages that tell other nodes what the robot does.

use crate::maps::{PublishedMaps, PublishedMasks};
use crate::message::{Color, Header, Marker, Markers as MarkersMessage, Message, Pose, Vector};
use crate::parameters::Parameters;
use nalgebra::{Isometry2, Point2};
use std::time::Instant;

/// The color of the goal and its path.
const COLOR: Color = Color { r: 0.9, g: 0.3, b: 0.1, a: 1.0 };
/// The length of the arrow at a goal, and the width of a path, m.
const ARROW_M: f64 = 0.5;
const LINE_M: f64 = 0.05;

/// What other nodes have heard.
pub(super) struct Published {
    pub(super) maps: PublishedMaps,
    pub(super) masks: PublishedMasks,
    pub(super) next_diagnostics: Instant,
    pub(super) markers: Markers,
    /// The pose of the frame of the odometry in the frame of the map.
    pub(super) map_to_odom: Option<Isometry2<f64>>,
    pub(super) next_transform: Instant,
    pub(super) is_lost: bool,
    /// The number of maps that were learned again.
    pub(super) switches: usize,
}

impl Published {
    /// Nothing.
    pub(super) fn new(parameters: &Parameters) -> Self {
        Self {
            maps: PublishedMaps::new(parameters),
            masks: PublishedMasks::new(parameters),
            next_diagnostics: Instant::now(),
            markers: Markers::default(),
            map_to_odom: None,
            next_transform: Instant::now(),
            is_lost: false,
            switches: 0,
        }
    }

    /// Takes over parameters that have changed.
    pub(super) fn set(&mut self, parameters: &Parameters) {
        self.maps.set(parameters);
        self.masks.set(parameters);
    }
}

/// The goal and the path as they were drawn last.
#[derive(Debug, Default)]
pub(super) struct Markers {
    goal: Option<Point2<f64>>,
    path: Vec<Point2<f64>>,
}

impl Markers {
    /// The message that draws what has changed; `None` if nothing has.
    pub(super) fn changed(
        &mut self,
        goal: Option<Point2<f64>>,
        path: &[Point2<f64>],
        header: &Header,
    ) -> Option<Message> {
        let mut markers = Vec::new();
        if goal != self.goal {
            self.goal = goal;
            let above = goal.map(|at| vec![point(&at, ARROW_M), point(&at, 0.0)]);
            let scale = Vector { x: 0.1, y: 0.2, z: 0.0 };
            markers.push(marker(header, 0, Marker::ARROW, scale, above));
        }
        if path != self.path {
            self.path = path.to_vec();
            let line = (path.len() > 1).then(|| path.iter().map(|at| point(at, 0.0)).collect());
            let scale = Vector { x: LINE_M, ..Vector::default() };
            markers.push(marker(header, 1, Marker::LINE_STRIP, scale, line));
        }
        (!markers.is_empty()).then_some(Message::Markers(MarkersMessage { markers }))
    }
}

fn point(at: &Point2<f64>, z: f64) -> Vector {
    Vector { x: at.x, y: at.y, z }
}

/// A marker with these points; without points, the marker is removed.
fn marker(header: &Header, id: i32, shape: i32, scale: Vector, points: Option<Vec<Vector>>) -> Marker {
    Marker {
        header: header.clone(),
        ns: "goals".to_owned(),
        id,
        shape,
        action: if points.is_some() { Marker::ADD } else { Marker::DELETE },
        pose: Pose::in_plane(&Isometry2::identity()),
        scale,
        color: COLOR,
        lifetime: (0, 0),
        frame_locked: false,
        points: points.unwrap_or_default(),
        colors: Vec::new(),
        texture: Default::default(),
        text: String::new(),
        mesh: Default::default(),
    }
}
