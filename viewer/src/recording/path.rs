//! The paths of the entities in a recording.

use crate::layers::Layer;
use rerun::EntityPathPart;

pub(super) const WORLD: &str = "/world";
pub(super) const WALLS: &str = "/world/walls";
pub(super) const OBSTACLES: &str = "/world/obstacles";
/// What the curious robot sees.
pub(super) const SIGHT: &str = "/world/field_of_view";
/// The line around the field of view of a laser.
pub(super) const SIGHT_OUTLINE: &str = "/world/field_of_view/outline";
/// The filled field of view.
pub(super) const SIGHT_CELLS: &str = "/world/field_of_view/cells";
pub(super) const PATH: &str = "/world/path";
pub(super) const GOAL: &str = "/world/goal";
/// The colors of lines and areas, below the map of the occupancy.
pub(super) const LEGEND: &str = "/world/legend";
pub(super) const STRATEGY: &str = "/curves/strategy";
pub(super) const LOG: &str = "/log";

/// A map; its picture and its color bar are below.
pub(super) fn map(layer: Layer) -> String {
    format!("/world/maps/{}", layer.name())
}

/// A part of a robot.
pub(super) fn robot(name: &str, part: &str) -> String {
    format!("/world/robots/{}/{part}", escape(name))
}

/// An obstacle or a part of it.
pub(super) fn obstacle(name: &str) -> String {
    format!("{OBSTACLES}/{}", escape(name))
}

/// A name from a world file as one part of a path, whatever characters it has.
pub(super) fn escape(name: &str) -> String {
    EntityPathPart::new(name).escaped_string()
}
