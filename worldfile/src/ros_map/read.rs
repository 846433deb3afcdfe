//! Reads a map from the two files of ROS.

use super::{EXAMPLE, RosMap};
use crate::files::Files;
use crate::findings::{Findings, Severity, SourceText};
use crate::floor_plan::{self, MAX_FILE_BYTES, Pixel};
use interfaces::{CellState, Grid, GridFrame, is_printable, pose};
use nalgebra::Point2;
use serde::Deserialize;
use serde_saphyr::{NonFiniteFloatPolicy, Spanned, from_str_with_options, options};
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::Path;

/// The maximum length of a YAML file.
const MAX_YAML_BYTES: u64 = 1 << 20;

/// Reads a `map.yaml` and the picture that it names. Without a map there are errors among the findings.
pub fn read(yaml: &Path, files: &dyn Files, findings: &mut Findings) -> Option<RosMap> {
    let bytes = files.read(yaml, MAX_YAML_BYTES).map_err(|error| {
        let what = format!("cannot read this file: {error}");
        findings.add_file(Severity::Error, yaml, &what, EXAMPLE);
    });
    let source = SourceText::new(yaml.display().to_string(), bytes.ok()?);
    // An infinite number is reported as the value of its key, like every other invalid value.
    let options = options! { non_finite_float_policy: NonFiniteFloatPolicy::PassThrough };
    let values = from_str_with_options(&source.text, options).map_err(|error| {
        let error = error.without_snippet();
        let line = error.location().map_or(1, |at| at.line() as usize);
        let what = match error {
            serde_saphyr::Error::DuplicateMappingKey { .. } => "a key is given twice",
            _ => "this is not a list of keys with values",
        };
        findings.add(Severity::Error, &source, what, (source.whole_line(line), ""), EXAMPLE);
    });
    let mut keys = Keys { source: &source, values: values.ok()?, findings };
    let map = keys.map(yaml, files);
    keys.warn_of_others();
    map
}

/// The value of any key.
#[derive(Deserialize)]
#[serde(untagged)]
enum Value {
    None(()),
    Flag(bool),
    Number(f64),
    Text(String),
    List(Vec<f64>),
    Other(serde::de::IgnoredAny),
}

/// A value and its place.
type Found<T> = (T, Range<usize>);

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

const MODES: [(&str, Mode); 3] = [("trinary", Mode::Trinary), ("scale", Mode::Scale), ("raw", Mode::Raw)];

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

/// The keys of the file that were not asked for yet.
struct Keys<'a> {
    source: &'a SourceText,
    values: BTreeMap<String, Spanned<Value>>,
    findings: &'a mut Findings,
}

impl Keys<'_> {
    fn map(&mut self, yaml: &Path, files: &dyn Files) -> Option<RosMap> {
        // All of them, so that everything that is invalid is reported at once.
        let name = "the name of a picture, as in `image: map.pgm`";
        let image = self.value("image", None, name, |value| match value {
            Value::Text(text) if !text.is_empty() && text.chars().all(is_printable) => Some(text.clone()),
            _ => None,
        });
        let side = "the side of a pixel in meters, from 0.0001 to 100";
        let resolution = self.number("resolution", 1e-4..=100.0, side);
        let origin = "[x, y, yaw] in m and rad, at most 1000 km away, as in `[-6.0, -6.0, 0.0]`";
        let origin = self.value("origin", None, origin, |value| match value {
            Value::List(numbers) if numbers.iter().all(|number| number.abs() <= 1e6) => {
                <[f64; 3]>::try_from(numbers.as_slice()).ok()
            }
            _ => None,
        });
        let occupied = self.number("occupied_thresh", 0.0..=1.0, "a number from 0 to 1, as in 0.65");
        let free = self.number("free_thresh", 0.0..=1.0, "a number from 0 to 1, as in 0.196");
        let negate = self.value("negate", Some(false), "0 or 1", |value| match value {
            Value::Number(0.0) | Value::Flag(false) => Some(false),
            Value::Number(1.0) | Value::Flag(true) => Some(true),
            _ => None,
        });
        let modes = "`trinary`, `scale` or `raw`";
        let mode = self.value("mode", Some(Mode::Trinary), modes, |value| match value {
            Value::Text(text) => MODES.iter().find(|(name, _)| name == text).map(|(_, mode)| *mode),
            _ => None,
        });
        let is_ordered = self.are_ordered(free.as_ref(), occupied.as_ref());
        let (image, image_place) = image?;
        let path = yaml.parent().unwrap_or(Path::new("")).join(image);
        let bytes = files.read(&path, MAX_FILE_BYTES).map_err(|error| error.to_string());
        let picture = bytes.and_then(|bytes| floor_plan::decode(&bytes));
        let picture = picture.map_err(|error| {
            let what = format!("cannot read the picture {}: {error}", path.display());
            self.error(&what, image_place, "`image` names a PNG or PGM picture, relative to this file");
        });
        let picture = picture.ok()?;
        is_ordered?;
        let [x, y, yaw] = origin?.0;
        let rule = Rule { negate: negate?.0, occupied: occupied?.0, free: free?.0, mode: mode?.0 };
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let frame = GridFrame::new(Point2::origin(), resolution?.0, width, height)?;
        let pixels = (0..picture.height()).rev().flat_map(|y| floor_plan::row(&picture, y));
        let states = pixels.map(|pixel| rule.state(pixel));
        let cells = Grid::from_cells(frame, states.collect())?;
        Some(RosMap { cells, origin: pose(x, y, yaw) })
    }

    fn are_ordered(&mut self, free: Option<&Found<f64>>, occupied: Option<&Found<f64>>) -> Option<()> {
        let ((free, place), (occupied, _)) = (free?, occupied?);
        if free > occupied {
            let what = format!("`free_thresh` is {free}, above `occupied_thresh`, which is {occupied}");
            self.error(&what, place.clone(), "a pixel cannot be both free and blocked");
            return None;
        }
        Some(())
    }

    fn error(&mut self, what: &str, place: Range<usize>, help: &str) {
        self.findings.add(Severity::Error, self.source, what, (place, ""), help);
    }

    /// The value of a key as `parse` reads it, and its place. Without a default the key must be given; `valid`
    /// says what it must be.
    fn value<T>(
        &mut self,
        key: &str,
        default: Option<T>,
        valid: &str,
        parse: impl Fn(&Value) -> Option<T>,
    ) -> Option<Found<T>> {
        let help = format!("it must be {valid}");
        let Some(value) = self.values.remove(key) else {
            if default.is_none() {
                self.error(&format!("the key `{key}` is missing"), 0..0, &help);
            }
            return Some((default?, 0..0));
        };
        let place = self.place(&value);
        let parsed = parse(&value.value);
        if parsed.is_none() {
            let is = match value.value {
                Value::None(()) => "has no value".to_owned(),
                _ => format!("is `{}`", &self.source.text[place.clone()]),
            };
            self.error(&format!("`{key}` {is}"), place.clone(), &help);
        }
        Some((parsed?, place))
    }

    fn number(&mut self, key: &str, range: RangeInclusive<f64>, valid: &str) -> Option<Found<f64>> {
        self.value(key, None, valid, |value| match value {
            Value::Number(number) => Some(*number).filter(|number| range.contains(number)),
            _ => None,
        })
    }

    fn place(&self, value: &Spanned<Value>) -> Range<usize> {
        self.source.place(value.defined.line() as usize, value.defined.column() as usize)
    }

    /// ROS ignores other keys; a misspelled one would change the walls.
    fn warn_of_others(&mut self) {
        for (key, value) in &self.values {
            let place = self.place(value);
            let help = "the keys are image, resolution, origin, negate, occupied_thresh, free_thresh, mode";
            let what = format!("the key `{key}` means nothing here");
            self.findings.add(Severity::Warning, self.source, &what, (place, ""), help);
        }
    }
}
