use crate::error::SurveyError;
use interfaces::{GridFrame, LaserReading};
use nalgebra::{Isometry2, Point2, Vector2};

/// The number of directions in which the reach of a reading is kept. In another direction it is too short by at most
/// 2 %: at 20 m, less than [`MARGIN_M`].
const DIRECTIONS: usize = 16;
/// Space around the hits, m: the border of a map is not seen by chance.
const MARGIN_M: f64 = 0.5;

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
pub(crate) fn union<'a>(frames: impl Iterator<Item = &'a GridFrame>) -> Result<GridFrame, SurveyError> {
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
fn of_cells(low: Point2<f64>, high: Point2<f64>, resolution_m: f64) -> Result<GridFrame, SurveyError> {
    let cells = high - low;
    let too_large = || {
        let (width_m, height_m) = (cells.x * resolution_m, cells.y * resolution_m);
        let share = cells.x * cells.y / GridFrame::MAX_CELLS as f64;
        SurveyError::TooLarge { width_m, height_m, resolution_m, enough_m: enough_m(resolution_m, share) }
    };
    // Numbers that are too large become the largest ones.
    let frame = GridFrame::new(low * resolution_m, resolution_m, cells.x as usize, cells.y as usize);
    frame.ok_or_else(too_large)
}

/// The side of the cells of which a place has at most as many as it may, in two digits; `share`: how many it has with this side,
/// relative to that.
pub(crate) fn enough_m(resolution_m: f64, share: f64) -> f64 {
    // With the space that rounding takes.
    let enough_m = resolution_m * (1.1 * share).sqrt().max(1.0);
    let digit = 10_f64.powf(enough_m.log10().floor() - 1.0);
    (enough_m / digit).ceil() * digit
}

/// The cells that cover what was hit from these poses. The cells lie on multiples of their side, so that two surveys of
/// a place have the same cells.
pub(crate) fn frame<'a>(
    reaches: impl Iterator<Item = (&'a Isometry2<f64>, &'a Reach)>,
    resolution_m: f64,
) -> Result<GridFrame, SurveyError> {
    let points = reaches.flat_map(|(pose, reach)| reach.hits().map(move |hit| pose * hit));
    let spans = points.map(|point| (point, point));
    let low_and_high = spans.reduce(|(low, high), (point, _)| (low.inf(&point), high.sup(&point)));
    let (low, high) = low_and_high.ok_or(SurveyError::NoPlace)?;
    around(low, high, resolution_m)
}

/// The cells that cover a rectangle and its margin.
pub(crate) fn around(
    low: Point2<f64>,
    high: Point2<f64>,
    resolution_m: f64,
) -> Result<GridFrame, SurveyError> {
    let low = low.map(|m| ((m - MARGIN_M) / resolution_m).floor());
    let high = high.map(|m| ((m + MARGIN_M) / resolution_m).ceil());
    of_cells(low, high, resolution_m)
}
