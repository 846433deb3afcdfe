//! Occupancy maps as the `map_server` of ROS keeps them: a grey picture and a YAML file.
//!
//! p = (255 − v)/255, or v/255 where `negate` is set; more than `occupied_thresh` is blocked, less
//! than `free_thresh` is free, anything else unknown, strictly. Row 0 of the picture has the
//! highest y.

use evaluation::output::{OutputError, write_file};
use image::{DynamicImage, ImageDecoder, ImageReader};
use interfaces::{CellState, Grid, GridFrame, pose};
use nalgebra::{Isometry2, Point2};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// What a map is saved with. 205 is p = 0.19608: with the customary threshold of 0.25 it would
/// come back as free.
const FREE_THRESHOLD: f64 = 0.196;
const OCCUPIED_THRESHOLD: f64 = 0.65;
const FREE: u8 = 254;
const UNKNOWN: u8 = 205;
const BLOCKED: u8 = 0;

/// More pixels than any house needs, 400 m × 400 m in cells of 5 cm, and few enough to hold.
const MAX_PIXELS: u64 = 1 << 26;

/// Why a map cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum RosMapError {
    /// A file cannot be opened.
    #[error("cannot read {}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        why: io::Error,
    },
    /// The YAML file does not hold what it should.
    #[error(
        "cannot read the map {}: {what}\na map has e.g. `image: map.pgm`, `resolution: 0.05`, \
         `origin: [-6.0, -6.0, 0.0]`, `negate: 0`, `occupied_thresh: 0.65`, `free_thresh: 0.196`",
        path.display()
    )]
    Yaml {
        /// The YAML file.
        path: PathBuf,
        /// Where, and what is wrong.
        what: Box<serde_saphyr::Error>,
    },
    /// A value makes no sense.
    #[error("cannot read the map {}: `{key}` is {value}, but must be {right}", path.display())]
    Value {
        /// The YAML file.
        path: PathBuf,
        /// The key.
        key: &'static str,
        /// What it has.
        value: String,
        /// What would be right.
        right: &'static str,
    },
    /// The picture cannot be read.
    #[error("cannot read the picture {}, which `image` in {} names: {what}", path.display(), yaml.display())]
    Picture {
        /// The picture.
        path: PathBuf,
        /// The YAML file.
        yaml: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// The keys of a `map.yaml`. Others are ignored, as ROS does.
#[derive(Deserialize)]
struct Keys {
    image: PathBuf,
    resolution: f64,
    origin: [f64; 3],
    #[serde(default)]
    negate: Flag,
    occupied_thresh: f64,
    free_thresh: f64,
    #[serde(default)]
    mode: Option<String>,
}

/// `negate` is 0 or 1, and `true` or `false` in newer files.
#[derive(Deserialize)]
#[serde(untagged, expecting = "`negate` must be 0 or 1")]
enum Flag {
    Number(i64),
    Bool(bool),
}

impl Default for Flag {
    fn default() -> Self {
        Self::Number(0)
    }
}

/// A map with a place in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct RosMap {
    /// The states, in a frame of their own whose lower left corner is the origin.
    cells: Grid<CellState>,
    /// The pose of that frame in the world.
    origin: Isometry2<f64>,
}

impl RosMap {
    /// Reads a `map.yaml` and the picture that it names, PGM or PNG.
    ///
    /// # Errors
    ///
    /// When a file cannot be read, a key is missing or makes no sense, or the picture is absurdly
    /// large; nothing of its size is allocated then.
    pub fn read(yaml: &Path) -> Result<Self, RosMapError> {
        let text =
            fs::read_to_string(yaml).map_err(|why| RosMapError::File { path: yaml.to_owned(), why })?;
        let keys: Keys = serde_saphyr::from_str(&text)
            .map_err(|what| RosMapError::Yaml { path: yaml.to_owned(), what: Box::new(what) })?;
        let is_negated = keys.check(yaml)?;

        let path = yaml.parent().unwrap_or(Path::new("")).join(&keys.image);
        let picture = |what: String| RosMapError::Picture { path: path.clone(), yaml: yaml.to_owned(), what };
        let pixels = read_picture(&path).map_err(picture)?;
        let (width, height) = (pixels.width() as usize, pixels.height() as usize);
        let frame = GridFrame::new(Point2::origin(), keys.resolution, width, height)
            .ok_or_else(|| picture(format!("{width} × {height} pixels are not a map")))?;
        let states = (0..frame.len()).map(|index| {
            let cell = frame.cell(index);
            let value = brightness(&pixels, cell.x as u32, (height - 1) as u32 - cell.y as u32);
            let dark = if is_negated { value } else { 255.0 - value };
            let p = dark / 255.0;
            if p > keys.occupied_thresh {
                CellState::Blocked
            } else if p < keys.free_thresh {
                CellState::Free
            } else {
                CellState::Unknown
            }
        });
        let cells = Grid::from_cells(frame, states.collect());
        let cells = cells.ok_or_else(|| picture("it has a strange size".into()))?;
        let [x_m, y_m, yaw_rad] = keys.origin;
        Ok(Self { cells, origin: pose(x_m, y_m, yaw_rad) })
    }

    /// The state of the map at the middle of every cell of `frame`; unknown beyond the map's
    /// border. The map's cells may be of another size, and turned.
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

impl Keys {
    /// Checks what the types cannot. Returns whether bright means blocked.
    fn check(&self, yaml: &Path) -> Result<bool, RosMapError> {
        let wrong =
            |key, value: String, right| Err(RosMapError::Value { path: yaml.to_owned(), key, value, right });
        let [free, occupied] = [self.free_thresh, self.occupied_thresh];
        if !(self.resolution.is_finite() && self.resolution > 0.0) {
            return wrong(
                "resolution",
                self.resolution.to_string(),
                "the side of a pixel in metres, above 0",
            );
        }
        if !self.origin.iter().all(|figure| figure.is_finite()) {
            return wrong("origin", format!("{:?}", self.origin), "[x, y, yaw] in m and rad, finite");
        }
        if !(0.0..=1.0).contains(&occupied) {
            return wrong("occupied_thresh", occupied.to_string(), "between 0 and 1");
        }
        if !(0.0..=1.0).contains(&free) || free > occupied {
            return wrong("free_thresh", free.to_string(), "between 0 and `occupied_thresh`");
        }
        if let Some(mode) = self.mode.as_deref().filter(|mode| *mode != "trinary") {
            return wrong("mode", format!("`{mode}`"), "`trinary`: free, blocked or unknown");
        }
        match self.negate {
            Flag::Bool(flag) => Ok(flag),
            Flag::Number(0) => Ok(false),
            Flag::Number(1) => Ok(true),
            Flag::Number(number) => wrong("negate", number.to_string(), "0 or 1"),
        }
    }
}

fn read_picture(path: &Path) -> Result<DynamicImage, String> {
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    let decoder = reader.map_err(|error| error.to_string())?.into_decoder();
    let decoder = decoder.map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format!("{width} × {height} pixels are too many: at most {MAX_PIXELS}"));
    }
    DynamicImage::from_decoder(decoder).map_err(|error| error.to_string())
}

/// The mean of a pixel's colours, 0 to 255, as `map_server` takes it; without the alpha.
fn brightness(picture: &DynamicImage, x: u32, y: u32) -> f64 {
    match picture {
        DynamicImage::ImageLuma8(grey) => f64::from(grey.get_pixel(x, y).0[0]),
        _ => {
            let [red, green, blue, _] = image::GenericImageView::get_pixel(picture, x, y).0;
            (f64::from(red) + f64::from(green) + f64::from(blue)) / 3.0
        }
    }
}

/// Writes `map.pgm` and `map.yaml` into `folder`.
///
/// # Errors
///
/// When a file cannot be written.
pub fn write(folder: &Path, map: &Grid<CellState>) -> Result<(), OutputError> {
    let frame = map.frame();
    let (width, height) = (frame.width(), frame.height());
    write_file(&folder.join("map.pgm"), |file| {
        write!(file, "P5\n{width} {height}\n255\n")?;
        let value = |state: &CellState| match state {
            CellState::Free => FREE,
            CellState::Unknown => UNKNOWN,
            CellState::Blocked => BLOCKED,
        };
        map.cells()
            .chunks(width)
            .rev()
            .try_for_each(|row| file.write_all(&row.iter().map(value).collect::<Vec<u8>>()))
    })?;
    let (origin, resolution_m) = (frame.origin(), frame.resolution_m());
    write_file(&folder.join("map.yaml"), |file| {
        writeln!(file, "image: map.pgm")?;
        writeln!(file, "mode: trinary")?;
        writeln!(file, "resolution: {resolution_m:?}")?;
        writeln!(file, "origin: [{:?}, {:?}, 0.0]", origin.x, origin.y)?;
        writeln!(file, "negate: 0")?;
        writeln!(file, "occupied_thresh: {OCCUPIED_THRESHOLD}")?;
        writeln!(file, "free_thresh: {FREE_THRESHOLD}")
    })
}

#[cfg(test)]
mod tests;
