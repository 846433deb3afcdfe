//! Tours: waypoints, as read from a file.

use crate::error::{WorldError, read_text};
use crate::reader::{self, Kind, Table};
use nalgebra::Point2;
use std::path::Path;

/// The maximum coordinate of a waypoint along each axis, m.
const MAX_M: f64 = 1e6;

/// The waypoints of a tour.
#[derive(Clone, Debug, PartialEq)]
pub struct TourSpec {
    /// The waypoints, m; at least one.
    pub waypoints: Vec<Point2<f64>>,
    /// Whether the tour starts again after the last waypoint.
    pub repeat: bool,
}

impl TourSpec {
    /// Reads a tour file: TOML with `waypoints_m`, a list of `[x, y]` in meters, and `repeat`
    /// (`false` by default: the run ends with the last waypoint).
    ///
    /// # Errors
    ///
    /// When the file cannot be read, and the errors of [`TourSpec::parse`].
    pub fn load(path: &Path) -> Result<Self, WorldError> {
        let (name, text) = read_text("tour", path)?;
        Self::parse(&name, &text)
    }

    /// Checks the text of a tour file; `name` is the name of the file in messages.
    ///
    /// # Errors
    ///
    /// When the text is not TOML, a key is unknown or missing, or a value is invalid.
    pub fn parse(name: &str, text: &str) -> Result<Self, WorldError> {
        reader::read(name, text, Kind::Tour, "repeat, waypoints_m", Self::from_table)
    }

    fn from_table(table: &Table<'_>) -> Option<Self> {
        let repeat = table.flag("repeat");
        let value = table.needed("waypoints_m")?;
        let waypoints = value.list(|waypoint| waypoint.pair_within(&(-MAX_M..=MAX_M)))?;
        if waypoints.is_empty() {
            return value.invalid("is empty", "", "a tour needs at least one `[x, y]` in meters");
        }
        table.sound(Self { waypoints, repeat })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        TourSpec::parse("t.toml", text).unwrap_err().to_string()
    }

    #[test]
    fn the_shipped_tour_is_a_tour() {
        let (name, text) = crate::shipped::TOUR;
        assert!(TourSpec::parse(name, text).unwrap().waypoints.len() > 4);
    }

    #[test]
    fn errors_say_where_and_what() {
        insta::assert_snapshot!(error("waypoints_m = []"), @"
        `waypoints_m` is empty
         --> t.toml:1:15
          |
        1 | waypoints_m = []
          |               ^^
          |
          = help: a tour needs at least one `[x, y]` in meters
        ");
        insta::assert_snapshot!(error("repeat = true\nwaypoints_m = [\n  [1.0, 2.0],\n  [nan, 0.0],\n]"), @"
        `waypoints_m` is [NaN, 0], which is out of range
         --> t.toml:4:3
          |
        4 |   [nan, 0.0],
          |   ^^^^^^^^^^ out of range
          |
          = help: both must be numbers from -1000000 to 1000000
        ");
        insta::assert_snapshot!(error("waypoint = [[1, 2]]"), @"
        unknown key `waypoint`
         --> t.toml:1:1
          |
        1 | waypoint = [[1, 2]]
          | ^^^^^^^^ not known here
          |
          = help: did you mean `waypoints_m`? the keys here are: repeat, waypoints_m
        ");
    }
}
