//! Maps of the `map_server` of ROS as floor plans.
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
//! pixel is p in percent, and above 100 unknown; in `scale` a transparent pixel is unknown. What is
//! unknown is taken as free, with a note that counts it: most maps have such pixels.

use super::{Bitmap, FloorPlan, MAX_FILE_BYTES, Pixel};
use crate::files::Files;
use crate::findings::{Findings, Severity, SourceText};
use interfaces::pose;
use nalgebra::Vector2;
use serde::Deserialize;
use serde_saphyr::Spanned;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::Path;
use std::sync::Arc;

/// A longer YAML file is refused.
const MAX_YAML_BYTES: u64 = 1 << 20;

const EXAMPLE: &str = "a map has e.g. `image: map.pgm`, `resolution: 0.05`, `origin: [-6.0, -6.0, 0.0]`, \
                       `negate: 0`, `occupied_thresh: 0.65`, `free_thresh: 0.196`";

/// Reads a `map.yaml` and the picture that it names. Without a plan there are errors among the
/// findings.
pub fn read(yaml: &Path, files: &dyn Files, findings: &mut Findings) -> Option<FloorPlan> {
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
    let plan = keys.plan(yaml, files);
    keys.warn_of_others();
    plan
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

#[derive(PartialEq)]
enum State {
    Blocked,
    Free,
    Unknown,
}

impl Rule {
    fn state(&self, pixel: Pixel) -> State {
        let bright = if self.negate { 1.0 - pixel.brightness() } else { pixel.brightness() };
        let p = match self.mode {
            Mode::Scale if pixel.alpha == 0.0 => return State::Unknown,
            Mode::Trinary | Mode::Scale => 1.0 - bright,
            Mode::Raw if (bright * 255.0).round() > 100.0 => return State::Unknown,
            Mode::Raw => bright * 255.0 / 100.0,
        };
        if p > self.occupied {
            State::Blocked
        } else if p < self.free {
            State::Free
        } else {
            State::Unknown
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
    fn plan(&mut self, yaml: &Path, files: &dyn Files) -> Option<FloorPlan> {
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
        let unknown = Cell::new(0_u64);
        let is_blocked = |pixel| {
            let state = rule.as_ref().map(|rule| rule.state(pixel));
            unknown.set(unknown.get() + u64::from(state == Some(State::Unknown)));
            state == Some(State::Blocked)
        };
        let bitmap = files
            .read(&path, MAX_FILE_BYTES)
            .map_err(|error| error.to_string())
            .and_then(|bytes| Bitmap::decode(&bytes, is_blocked).map_err(|error| error.to_string()));
        let bitmap = match bitmap {
            Ok(bitmap) => bitmap,
            Err(error) => {
                let what = format!("cannot read the picture {}: {error}", path.display());
                self.error(&what, image_place, "`image` names a PNG or PGM picture, relative to this file");
                return None;
            }
        };
        let (resolution, origin, _) = (resolution?.0, origin?, rule?);
        if unknown.get() > 0 {
            let pixels = u64::from(bitmap.width()) * u64::from(bitmap.height());
            let what = format!("{} of the {pixels} pixels are unknown", unknown.get());
            let help = "they are taken as free: no walls, and lasers look through";
            self.findings.add(Severity::Note, self.source, &what, (image_place, "in this picture"), help);
        }
        Some(FloorPlan {
            bitmap: Arc::new(bitmap),
            pixel_m: Vector2::repeat(resolution),
            origin: pose(origin[0], origin[1], origin[2]),
        })
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
