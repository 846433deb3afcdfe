//! The paths of everything in a recording.

use crate::layer::Layer;
use rerun::EntityPathPart;

pub(super) const WORLD: &str = "/world";
pub(super) const HOUSE: &str = "/world/house";
/// What the curious robot sees.
pub(super) const SIGHT: &str = "/world/field_of_view";
/// The line around it, where a laser sees.
pub(super) const SIGHT_OUTLINE: &str = "/world/field_of_view/outline";
/// The same, filled.
pub(super) const SIGHT_CELLS: &str = "/world/field_of_view/cells";
pub(super) const PATH: &str = "/world/path";
pub(super) const GOAL: &str = "/world/goal";
pub(super) const SCORES: &str = "/curves/scores";
pub(super) const COVERAGE: &str = "/curves/scores/coverage";
pub(super) const MAP_QUALITY: &str = "/curves/scores/map_quality";
pub(super) const RATE_ERRORS: &str = "/curves/rate_errors";
pub(super) const RELATIVE_ERROR: &str = "/curves/rate_errors/relative";
pub(super) const LOG_ERROR: &str = "/curves/rate_errors/log";
pub(super) const P: &str = "/curves/p";
pub(super) const R: &str = "/curves/r";
pub(super) const VALUES: &str = "/curves/strategy_value";
pub(super) const SHARES: &str = "/curves/strategy_share";
pub(super) const STRATEGY: &str = "/curves/strategy";
pub(super) const LOG: &str = "/log";

/// The height of the strip below a map that holds its colour bar, as a share of the map's.
pub(super) const LEGEND_SHARE: f64 = 0.2;

/// A map; its picture and colour bar lie below.
pub(super) fn map(layer: Layer) -> String {
    format!("/world/maps/{}", layer.name())
}

/// A part of a robot.
pub(super) fn robot(name: &str, part: &str) -> String {
    format!("/world/robots/{}/{part}", escape(name))
}

/// A thing that may appear, go or move.
pub(super) fn obstacle(name: &str) -> String {
    format!("/world/house/obstacles/{}", escape(name))
}

/// A strategy's curve among `curves`.
pub(super) fn strategy(curves: &str, name: &str) -> String {
    format!("{curves}/{}", escape(name))
}

/// A name from a world file as one part of a path, whatever it holds.
fn escape(name: &str) -> String {
    EntityPathPart::new(name).escaped_string()
}
