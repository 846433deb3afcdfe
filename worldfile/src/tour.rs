//! Tours: waypoints to drive to, as a file gives them.

use crate::error::{Source, WorldError};
use crate::kind::Kind;
use crate::reader::{self, Reading};
use nalgebra::Point2;
use serde::Deserialize;
use serde_spanned::Spanned;
use std::path::Path;

/// No waypoint is farther from the origin along an axis, m.
const MAX_M: f64 = 1e6;

/// Waypoints to drive to.
#[derive(Clone, Debug, PartialEq)]
pub struct TourSpec {
    /// The waypoints, m; at least one.
    pub waypoints: Vec<Point2<f64>>,
    /// Whether the tour starts again after the last waypoint.
    pub repeat: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TourFile {
    repeat: Option<Spanned<bool>>,
    waypoints_m: Spanned<Vec<Spanned<[f64; 2]>>>,
}

impl TourSpec {
    /// Reads a tour file: TOML with `waypoints_m`, a list of `[x, y]` in metres, and `repeat`
    /// (`false` by default: the run ends with the last waypoint).
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or as in [`TourSpec::parse`].
    pub fn load(path: &Path) -> Result<Self, WorldError> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path);
        Self::parse(&name, &text.map_err(|error| WorldError::unreadable("tour", &name, &error))?)
    }

    /// Checks the text of a tour file; `name` is what messages call the file.
    ///
    /// # Errors
    ///
    /// When the text is not TOML, a key is unknown or missing, or a value is invalid.
    pub fn parse(name: &str, text: &str) -> Result<Self, WorldError> {
        let source = Source::new(name, text);
        let Reading { file, mut wrong, .. } = reader::read::<TourFile>(&source, Kind::Tour)?;
        if !wrong.is_empty() {
            return Err(wrong.into_error(&source));
        }
        let waypoints = file.waypoints_m.get_ref();
        if waypoints.is_empty() {
            let help = "a tour needs at least one `[x, y]` in metres";
            wrong.keep::<()>(Err(source.error(
                "`waypoints_m` is empty",
                (file.waypoints_m.span(), ""),
                &[],
                help,
            )));
        }
        for waypoint in waypoints {
            let [x, y] = *waypoint.get_ref();
            if !(x.abs() <= MAX_M && y.abs() <= MAX_M) {
                let what = format!("`waypoints_m` has [{x}, {y}]");
                let help = "both must be numbers of metres within the map";
                wrong.keep::<()>(Err(source.error(&what, (waypoint.span(), "no place"), &[], help)));
            }
        }
        if !wrong.is_empty() {
            return Err(wrong.into_error(&source));
        }
        let waypoints = waypoints.iter().map(|at| Point2::from(*at.get_ref())).collect();
        Ok(Self { waypoints, repeat: file.repeat.is_some_and(Spanned::into_inner) })
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
          = help: a tour needs at least one `[x, y]` in metres
        ");
        insta::assert_snapshot!(error("repeat = true\nwaypoints_m = [\n  [1.0, 2.0],\n  [nan, 0.0],\n]"), @"
        `waypoints_m` has [NaN, 0]
         --> t.toml:4:3
          |
        4 |   [nan, 0.0],
          |   ^^^^^^^^^^ no place
          |
          = help: both must be numbers of metres within the map
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
