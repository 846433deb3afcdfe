//! Tour files.

use nalgebra::Point2;
use serde::Deserialize;
use serde_spanned::Spanned;
use std::path::{Path, PathBuf};

/// Why a tour file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TourError {
    /// The file cannot be read.
    #[error("cannot read the tour {}: {why}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        why: std::io::Error,
    },
    /// The text is not a tour.
    #[error("{}: {what}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// Where, what is wrong, and what would be right.
        what: String,
    },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TourFile {
    #[serde(default)]
    repeat: bool,
    waypoints_m: Vec<Spanned<[f64; 2]>>,
}

/// Waypoints to drive to, as a file gives them.
#[derive(Clone, Debug, PartialEq)]
pub struct TourSpec {
    /// The waypoints, m; at least one.
    pub waypoints: Vec<Point2<f64>>,
    /// Whether the tour starts again after the last waypoint.
    pub repeat: bool,
}

impl TourSpec {
    /// Reads a tour file: TOML with `waypoints_m`, a list of `[x, y]` in metres, and `repeat`
    /// (`false` by default: the run ends with the last waypoint).
    ///
    /// # Errors
    ///
    /// When the file cannot be read, is not TOML, or has a key or value that makes no sense.
    pub fn load(path: &Path) -> Result<Self, TourError> {
        let read = |why| TourError::Read { path: path.to_owned(), why };
        Self::parse(path, &std::fs::read_to_string(path).map_err(read)?)
    }

    /// As [`TourSpec::load`], for a text that is already read; `path` only names it in errors.
    ///
    /// # Errors
    ///
    /// As [`TourSpec::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, TourError> {
        let error = |what: String| TourError::Text { path: path.to_owned(), what };
        let file: TourFile = toml::from_str(text).map_err(|e| error(e.to_string().trim_end().to_owned()))?;
        if file.waypoints_m.is_empty() {
            return Err(error("`waypoints_m` is empty; a tour needs at least one [x, y] in metres".into()));
        }
        for waypoint in &file.waypoints_m {
            let [x, y] = *waypoint.get_ref();
            if !(x.abs() <= 1e6 && y.abs() <= 1e6) {
                let line = text[..waypoint.span().start].lines().count().max(1);
                return Err(error(format!(
                    "line {line}: `waypoints_m` has [{x}, {y}]; both must be numbers of metres within the map"
                )));
            }
        }
        let waypoints = file.waypoints_m.iter().map(|at| Point2::from(*at.get_ref())).collect();
        Ok(Self { waypoints, repeat: file.repeat })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        TourSpec::parse(Path::new("t.toml"), text).unwrap_err().to_string()
    }

    #[test]
    fn the_shipped_tour_is_a_tour() {
        let text = include_str!("../worlds/four_rooms.tour.toml");
        let tour = TourSpec::parse(Path::new("four_rooms.tour.toml"), text).unwrap();
        assert!(tour.waypoints.len() > 4);
    }

    #[test]
    fn errors_say_where_and_what() {
        insta::assert_snapshot!(error("waypoints_m = []"), @"t.toml: `waypoints_m` is empty; a tour needs at least one [x, y] in metres");
        insta::assert_snapshot!(error("repeat = true\nwaypoints_m = [\n  [1.0, 2.0],\n  [nan, 0.0],\n]"), @"t.toml: line 4: `waypoints_m` has [NaN, 0]; both must be numbers of metres within the map");
        insta::assert_snapshot!(error("waypoint = [[1, 2]]"), @"
        t.toml: TOML parse error at line 1, column 1
          |
        1 | waypoint = [[1, 2]]
          | ^^^^^^^^
        unknown field `waypoint`, expected `repeat` or `waypoints_m`
        ");
    }
}
