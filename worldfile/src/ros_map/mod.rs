//! Occupancy maps as the `map_server` of ROS keeps them: a gray picture and a YAML file.
//!
//! | key | meaning |
//! |---|---|
//! | `image` | the picture, relative to the YAML file; row 0 has the highest y |
//! | `resolution` | the side of a pixel, m |
//! | `origin` | `[x, y, yaw]` of the lower left corner, m and rad |
//! | `negate` | 0 (default): dark is blocked; 1: bright is |
//! | `occupied_thresh` | p above this is blocked, strictly |
//! | `free_thresh` | p below this is free, strictly; anything between is unknown |
//! | `mode` | `trinary` (default), `scale`, or `raw` |
//!
//! p = (255 − v)/255 for a pixel of brightness v, or v/255 with `negate`. In the mode `raw` the
//! pixel is p in percent, and above 100 unknown; in `scale` a transparent pixel is unknown.
//!
//! ROS ignores other keys. Here they are a warning: a misspelled key would change the map.

#[cfg(test)]
mod tests;
mod write;

pub use write::{pgm, yaml};

use crate::files::Files;
use crate::findings::{Findings, Severity, SourceText};
use crate::floor_plan::{Bitmap, FloorPlan, MAX_FILE_BYTES, Pixel, Raster};
use interfaces::{CellState, Grid, GridFrame, pose};
use nalgebra::{Isometry2, Point2, Vector2};
use serde::Deserialize;
use serde_saphyr::Spanned;
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::Path;
use std::sync::Arc;

/// A longer YAML file is refused.
const MAX_YAML_BYTES: u64 = 1 << 20;

const EXAMPLE: &str = "a map has e.g. `image: map.pgm`, `resolution: 0.05`, `origin: [-6.0, -6.0, 0.0]`, \
                       `negate: 0`, `occupied_thresh: 0.65`, `free_thresh: 0.196`";

/// A map with its pose in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct RosMap {
    /// The state of every pixel, in a frame whose lower left corner is the origin.
    pub cells: Grid<CellState>,
    /// The pose of that frame in the world.
    pub origin: Isometry2<f64>,
}

impl RosMap {
    /// The state of the map at the center of every cell of `frame`; unknown beyond the border of the map. The
    /// cells of the map may have another size and another orientation.
    pub fn onto(&self, frame: &GridFrame) -> Grid<CellState> {
        let to_map = self.origin.inverse();
        let states = (0..frame.len()).map(|index| {
            let at = to_map * frame.center(frame.cell(index));
            self.cells.get(self.cells.frame().cell_at(&at)).copied().unwrap_or_default()
        });
        let mut grid = Grid::filled(*frame, CellState::Unknown);
        grid.cells_mut().iter_mut().zip(states).for_each(|(cell, state)| *cell = state);
        grid
    }
}

/// Reads a `map.yaml` and the picture that it names as a floor plan, in which unknown pixels are free, with a note
/// that counts them. Without a plan there are errors among the findings.
pub fn read_floor_plan(yaml: &Path, files: &dyn Files, findings: &mut Findings) -> Option<FloorPlan> {
    let map = read(yaml, files, findings)?;
    let states = map.cells.cells();
    let unknown = states.iter().filter(|state| **state == CellState::Unknown).count();
    if unknown > 0 {
        let what = format!("{unknown} of the {} pixels are unknown", states.len());
        let help = "they are taken as free: no walls, and lasers look through";
        findings.add_file(Severity::Note, yaml, &what, help);
    }
    let frame = map.cells.frame();
    let blocked = states.iter().map(|state| *state == CellState::Blocked).collect();
    match Bitmap::new(frame.width() as u32, frame.height() as u32, blocked) {
        Ok(bitmap) => {
            let pixel_m = Vector2::repeat(frame.resolution_m());
            Some(FloorPlan { bitmap: Arc::new(bitmap), pixel_m, origin: map.origin })
        }
        Err(error) => {
            let help = "take a map with smoother walls";
            findings.add_file(Severity::Error, yaml, &format!("this map makes no walls: {error}"), help);
            None
        }
    }
}

/// Reads a `map.yaml` and the picture that it names. Without a map there are errors among the findings.
pub fn read(yaml: &Path, files: &dyn Files, findings: &mut Findings) -> Option<RosMap> {
    let bytes = match files.read(yaml, MAX_YAML_BYTES) {
        Ok(bytes) => bytes,
        Err(error) => {
            let what = format!("cannot read this file: {error}");
            findings.add_file(Severity::Error, yaml, &what, EXAMPLE);
            return None;
        }
    };
    let source = SourceText::new(yaml.display().to_string(), bytes);
    let values: BTreeMap<String, Spanned<Value>> = match serde_saphyr::from_str(&source.text) {
        Ok(values) => values,
        Err(error) => {
            let place = error.location().map(|at| at.line() as usize).unwrap_or(1);
            // The parser's own words for it speak of its settings.
            let (what, help) = match error.without_snippet() {
                serde_saphyr::Error::DuplicateMappingKey { .. } => {
                    ("a key is given twice".to_owned(), "leave one of them out")
                }
                error => (format!("not a map: {error}"), EXAMPLE),
            };
            findings.add(Severity::Error, &source, &what, (source.whole_line(place), ""), help);
            return None;
        }
    };
    let mut keys = Keys { source: &source, values, findings };
    let map = keys.map(yaml, files);
    keys.warn_of_others();
    map
}

/// Anything that a key may have.
#[derive(Deserialize)]
#[serde(untagged)]
enum Value {
    Flag(bool),
    Number(f64),
    Text(String),
    List(Vec<f64>),
    Other(serde::de::IgnoredAny),
}

/// How pixels become states.
struct Rule {
    negate: bool,
    occupied: f64,
    free: f64,
    mode: Mode,
}

#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Trinary,
    Scale,
    Raw,
}

impl Rule {
    fn state(&self, pixel: Pixel) -> CellState {
        // The brightness in ROS's scale, from 0 to 255; rounded, since thresholds are strict.
        let level = (pixel.brightness() * 255e9).round() / 1e9;
        let dark = if self.negate { level } else { 255.0 - level };
        let p = match self.mode {
            Mode::Scale if pixel.alpha == 0.0 => return CellState::Unknown,
            Mode::Trinary | Mode::Scale => dark / 255.0,
            Mode::Raw if (255.0 - dark).round() > 100.0 => return CellState::Unknown,
            Mode::Raw => (255.0 - dark) / 100.0,
        };
        if p > self.occupied {
            CellState::Blocked
        } else if p < self.free {
            CellState::Free
        } else {
            CellState::Unknown
        }
    }
}

/// The keys of the file that nobody has asked for yet.
struct Keys<'a> {
    source: &'a SourceText,
    values: BTreeMap<String, Spanned<Value>>,
    findings: &'a mut Findings,
}

impl Keys<'_> {
    fn map(&mut self, yaml: &Path, files: &dyn Files) -> Option<RosMap> {
        // All of them, so that all that is wrong is said at once.
        let image = self.text("image", "the name of a picture, as in `image: map.pgm`");
        let resolution =
            self.number("resolution", 1e-4..=100.0, "the side of a pixel in metres, from 0.0001 to 100");
        let origin = self.origin();
        let occupied = self.number("occupied_thresh", 0.0..=1.0, "a number from 0 to 1, as in 0.65");
        let free = self.number("free_thresh", 0.0..=1.0, "a number from 0 to 1, as in 0.196");
        let negate = self.negate();
        let mode = self.mode();
        let rule = self.rule(negate, occupied, free, mode);
        let (image, image_place) = image?;
        let path = yaml.parent().unwrap_or(Path::new("")).join(image);
        let raster = files
            .read(&path, MAX_FILE_BYTES)
            .map_err(|error| error.to_string())
            .and_then(|bytes| Raster::decode(&bytes).map_err(|error| error.to_string()));
        let raster = match raster {
            Ok(raster) => raster,
            Err(error) => {
                let what = format!("cannot read the picture {}: {error}", path.display());
                self.error(&what, image_place, "`image` names a PNG or PGM picture, relative to this file");
                return None;
            }
        };
        let (resolution_m, origin, rule) = (resolution?.0, origin?, rule?);
        let (width, height) = (raster.width as usize, raster.height as usize);
        let frame = GridFrame::new(Point2::origin(), resolution_m, width, height)?;
        let rows = (0..raster.height).rev();
        let states = rows.flat_map(|y| raster.row(y).map(|pixel| rule.state(pixel)).collect::<Vec<_>>());
        let cells = Grid::from_cells(frame, states.collect())?;
        Some(RosMap { cells, origin: pose(origin[0], origin[1], origin[2]) })
    }

    /// How pixels become states, if all that says so is right.
    fn rule(
        &mut self,
        negate: Option<bool>,
        occupied: Option<(f64, Range<usize>)>,
        free: Option<(f64, Range<usize>)>,
        mode: Option<Mode>,
    ) -> Option<Rule> {
        let ((occupied, _), (free, place)) = (occupied?, free?);
        if free > occupied {
            let what = format!("`free_thresh` is {free}, above `occupied_thresh`, which is {occupied}");
            self.error(&what, place, "a pixel cannot be both free and blocked");
            return None;
        }
        Some(Rule { negate: negate?, occupied, free, mode: mode? })
    }

    fn error(&mut self, what: &str, place: Range<usize>, help: &str) {
        self.findings.add(Severity::Error, self.source, what, (place, ""), help);
    }

    /// The value of a key that must be there, and its place.
    fn take(&mut self, key: &str, right: &str) -> Option<(Value, Range<usize>)> {
        let Some(value) = self.values.remove(key) else {
            self.error(&format!("the key `{key}` is missing"), 0..0, &format!("it must be {right}"));
            return None;
        };
        let place = self.source.place(value.defined.line() as usize, value.defined.column() as usize);
        Some((value.value, place))
    }

    fn wrong<T>(&mut self, key: &str, place: Range<usize>, right: &str) -> Option<T> {
        let found = self.source.text.get(place.clone()).unwrap_or_default();
        let what =
            if found.is_empty() { format!("`{key}` has no value") } else { format!("`{key}` is {found}") };
        self.error(&what, place, &format!("it must be {right}"));
        None
    }

    fn text(&mut self, key: &str, right: &str) -> Option<(String, Range<usize>)> {
        match self.take(key, right)? {
            (Value::Text(text), place) if !text.is_empty() => Some((text, place)),
            (_, place) => self.wrong(key, place, right),
        }
    }

    fn number(&mut self, key: &str, range: RangeInclusive<f64>, right: &str) -> Option<(f64, Range<usize>)> {
        match self.take(key, right)? {
            (Value::Number(number), place) if range.contains(&number) => Some((number, place)),
            (_, place) => self.wrong(key, place, right),
        }
    }

    fn origin(&mut self) -> Option<[f64; 3]> {
        let right = "[x, y, yaw] in m and rad, at most 1000 km away, as in `[-6.0, -6.0, 0.0]`";
        let (value, place) = self.take("origin", right)?;
        let numbers = match &value {
            Value::List(numbers) => <[f64; 3]>::try_from(numbers.as_slice()).ok(),
            _ => None,
        };
        match numbers.filter(|numbers| numbers.iter().all(|number| number.abs() <= 1e6)) {
            Some(numbers) => Some(numbers),
            None => self.wrong("origin", place, right),
        }
    }

    fn negate(&mut self) -> Option<bool> {
        if !self.values.contains_key("negate") {
            return Some(false);
        }
        match self.take("negate", "0 or 1")? {
            (Value::Number(0.0) | Value::Flag(false), _) => Some(false),
            (Value::Number(1.0) | Value::Flag(true), _) => Some(true),
            (_, place) => self.wrong("negate", place, "0 or 1"),
        }
    }

    fn mode(&mut self) -> Option<Mode> {
        if !self.values.contains_key("mode") {
            return Some(Mode::Trinary);
        }
        let right = "`trinary`, `scale` or `raw`";
        let (text, place) = self.text("mode", right)?;
        match text.as_str() {
            "trinary" => Some(Mode::Trinary),
            "scale" => Some(Mode::Scale),
            "raw" => Some(Mode::Raw),
            _ => self.wrong("mode", place, right),
        }
    }

    /// ROS ignores other keys; a misspelt one would change the walls.
    fn warn_of_others(&mut self) {
        for (key, value) in &self.values {
            let place = self.source.place(value.defined.line() as usize, value.defined.column() as usize);
            let help = "the keys are image, resolution, origin, negate, occupied_thresh, free_thresh, mode";
            let what = format!("the key `{key}` means nothing here");
            self.findings.add(Severity::Warning, self.source, &what, (place, ""), help);
        }
    }
}
