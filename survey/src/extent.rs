//! How large a place is, and how much of it is seen: whether its map will fit into the memory is known before it is made.

use crate::settings::{SurveyError, SurveySettings};
use interfaces::{GridFrame, LaserReading, Spread};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2, Vector2};
use std::collections::HashSet;

/// The number of directions in which the reach of a reading is kept. In another direction it is too short by at most
/// 2 %: at 20 m, less than [`MARGIN_M`].
const DIRECTIONS: usize = 16;
/// Space around the hits, m: the border of a map is not seen by chance.
const MARGIN_M: f64 = 0.5;

/// The frame of a map, or why there is none.
type Framed = Result<GridFrame, SurveyError>;

/// The hits of a reading that are farthest from the robot in some directions, in the frame of the robot, m. Single
/// precision saves memory: there is one per reading of a log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach([[f32; 2]; DIRECTIONS]);

impl Reach {
    /// The reach of a reading; the position of the robot counts as a hit.
    pub(crate) fn of(reading: &LaserReading) -> Self {
        let directions: [Vector2<f64>; DIRECTIONS] = std::array::from_fn(|number| {
            interfaces::rotation(std::f64::consts::TAU * number as f64 / DIRECTIONS as f64) * Vector2::x()
        });
        let mut farthest = [(0.0, Point2::origin()); DIRECTIONS];
        for hit in reading.hits() {
            for (kept, direction) in farthest.iter_mut().zip(&directions) {
                let distance_m = hit.coords.dot(direction);
                if distance_m > kept.0 {
                    *kept = (distance_m, hit);
                }
            }
        }
        Self(farthest.map(|(_, hit)| [hit.x as f32, hit.y as f32]))
    }

    pub(crate) fn hits(&self) -> impl Iterator<Item = Point2<f64>> {
        self.0.iter().map(|[x, y]| Point2::new(f64::from(*x), f64::from(*y)))
    }
}

/// The cells that cover some frames, all of them with cells of the same side that lie on multiples of it.
pub(crate) fn union<'a>(frames: impl Iterator<Item = &'a GridFrame>) -> Framed {
    let span = |frame: &GridFrame| {
        let low = frame.origin().map(|m| (m / frame.resolution_m()).round());
        (low, low + Vector2::new(frame.width() as f64, frame.height() as f64), frame.resolution_m())
    };
    let spans = frames.map(span);
    let all = spans.reduce(|(low, high, side_m), (a, b, _)| (low.inf(&a), high.sup(&b), side_m));
    let (low, high, resolution_m) = all.ok_or(SurveyError::NoPlace)?;
    of_cells(low, high, resolution_m)
}

/// The frame of the cells with these numbers from the origin on.
fn of_cells(low: Point2<f64>, high: Point2<f64>, resolution_m: f64) -> Framed {
    let cells = high - low;
    let too_large = || {
        let (width_m, height_m) = (cells.x * resolution_m, cells.y * resolution_m);
        let share = cells.x * cells.y / GridFrame::MAX_CELLS as f64;
        let what = format!(
            "at least {width_m:.0} × {height_m:.0} m in cells of {resolution_m} m are more than 2^30 cells"
        );
        SurveyError::TooLarge { what, enough_m: enough_m(resolution_m, share) }
    };
    // Numbers that are too large become the largest ones.
    let frame = GridFrame::new(low * resolution_m, resolution_m, cells.x as usize, cells.y as usize);
    frame.ok_or_else(too_large)
}

/// The side of the cells of which a place has at most as many as it may, in two digits; `share`: how many it has with this side,
/// relative to that.
fn enough_m(resolution_m: f64, share: f64) -> f64 {
    // With the space that rounding takes.
    let enough_m = resolution_m * (1.1 * share).sqrt().max(1.0);
    let digit = 10_f64.powf(enough_m.log10().floor() - 1.0);
    (enough_m / digit).ceil() * digit
}

/// The cells that cover these points. The cells lie on multiples of their side, so that two surveys of a place have the same cells.
pub(crate) fn frame(points: impl Iterator<Item = Point2<f64>>, resolution_m: f64) -> Framed {
    let spans = points.map(|point| (point, point));
    let span = spans.reduce(|(low, high), (point, _)| (low.inf(&point), high.sup(&point)));
    let (low, high) = span.ok_or(SurveyError::NoPlace)?;
    around(low, high, resolution_m)
}

/// The cells that cover a rectangle and its margin.
pub(crate) fn around(low: Point2<f64>, high: Point2<f64>, resolution_m: f64) -> Framed {
    let low = low.map(|m| ((m - MARGIN_M) / resolution_m).floor());
    let high = high.map(|m| ((m + MARGIN_M) / resolution_m).ceil());
    of_cells(low, high, resolution_m)
}

/// The side of the squares that are counted, m.
const SIDE_M: f64 = 0.5;
/// Along a beam, a square is looked for after each of these steps, m.
const STEP_M: f64 = 0.25;
/// A reading counts when the robot has moved by this since the last one that did, m and rad.
const COUNTED: Spread = Spread { m: 1.0, rad: 0.8 };
/// The number of beams of a reading that count: 0.4 m apart at 20 m over half a turn.
const BEAMS: usize = 180;

/// The squares that a beam has crossed on the way to its hit. Those at the border count as a whole: thin places seem larger.
#[derive(Clone, Debug, Default)]
pub(crate) struct SeenArea {
    /// Only their number counts.
    squares: HashSet<(i32, i32)>,
    last: Option<Isometry2<f64>>,
}

impl SeenArea {
    /// Adds a reading that was filtered, with its pose in the map.
    pub(crate) fn add(&mut self, reading: &LaserReading, pose: &Isometry2<f64>) {
        if self.last.is_some_and(|last| COUNTED.contains(&last.inv_mul(pose))) {
            return;
        }
        self.last = Some(*pose);
        let laser = pose * reading.mount * Point2::origin();
        let every = reading.scan.ranges_m.len().div_ceil(BEAMS);
        for hit in reading.hits().step_by(every.max(1)).map(|hit| pose * hit) {
            let mut last = None;
            let steps = ((hit - laser).norm() / STEP_M).ceil().max(1.0);
            for step in 0..=steps as u32 {
                let at = laser.lerp(&hit, f64::from(step) / steps) / SIDE_M;
                let square = (at.x.floor() as i32, at.y.floor() as i32);
                if last.replace(square) != Some(square) {
                    self.squares.insert(square);
                }
            }
        }
    }

    /// The area, m².
    pub(crate) fn m2(&self) -> f64 {
        self.squares.len() as f64 * SIDE_M * SIDE_M
    }
}

/// While a trajectory drifts, it sees places twice: this share of the area counts.
const SURE_SHARE: f64 = 0.5;

/// Checks whether the map of an area fits into the memory.
pub(crate) fn check_seen(seen_m2: f64, settings: &SurveySettings) -> Result<(), SurveyError> {
    match bytes(seen_m2 * SURE_SHARE, settings) <= settings.mapper.max_bytes as f64 {
        true => Ok(()),
        false => Err(too_much(seen_m2, 0.0, settings)),
    }
}

fn bytes(seen_m2: f64, settings: &SurveySettings) -> f64 {
    seen_m2 / settings.resolution_m.powi(2) * Mapper::BYTES_PER_SEEN_CELL as f64
}

/// The error for an area whose map does not fit; `taken`: what the map takes, as far as that is known, bytes.
pub(crate) fn too_much(seen_m2: f64, taken: f64, settings: &SurveySettings) -> SurveyError {
    /// Cells that changed take more, and larger blocks follow the border of what was seen less closely.
    const MARGIN: f64 = 1.3;
    let (resolution_m, max_bytes) = (settings.resolution_m, settings.mapper.max_bytes);
    let share = MARGIN * bytes(seen_m2, settings).max(taken) / max_bytes as f64;
    let gib = max_bytes as f64 / f64::from(1 << 30);
    let what = format!(
        "about {seen_m2:.0} m² in cells of {resolution_m} m need more than {gib:.3} GiB (--map-memory gives the map more)"
    );
    SurveyError::TooLarge { what, enough_m: enough_m(resolution_m, share) }
}
