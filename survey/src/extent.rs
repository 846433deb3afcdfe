use interfaces::{GridFrame, LaserReading};
use nalgebra::{Isometry2, Point2, Vector2};

/// The rectangle around the hits of a reading, in the frame of the robot, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    low: Point2<f64>,
    high: Point2<f64>,
}

impl Reach {
    /// The rectangle around the robot and all that its laser hit.
    pub(crate) fn of(reading: &LaserReading) -> Self {
        let scan = &reading.scan;
        let mut reach = Self { low: Point2::origin(), high: Point2::origin() };
        for (beam, range_m) in scan.ranges_m.iter().enumerate().filter(|(_, range_m)| range_m.is_finite()) {
            let along = interfaces::rotation(scan.angle_rad(beam)) * Vector2::new(f64::from(*range_m), 0.0);
            let hit = reading.mount * Point2::from(along);
            reach = Self { low: reach.low.inf(&hit), high: reach.high.sup(&hit) };
        }
        reach
    }

    fn corners(&self) -> [Point2<f64>; 4] {
        let Self { low, high } = self;
        [*low, Point2::new(high.x, low.y), *high, Point2::new(low.x, high.y)]
    }
}

/// Free space around the hits, m: the border of a map is not seen by chance.
const MARGIN_M: f64 = 0.5;

/// The cells that cover what was hit from these poses. The cells lie on multiples of their side, so that two surveys of
/// a place have the same cells. `None` without a pose, and where the frame has no valid size.
pub(crate) fn frame<'a>(
    reaches: impl Iterator<Item = (&'a Isometry2<f64>, &'a Reach)>,
    resolution_m: f64,
) -> Option<GridFrame> {
    let corners = reaches.flat_map(|(pose, reach)| reach.corners().map(|corner| pose * corner));
    let spans = corners.map(|corner| (corner, corner));
    let (low, high) = spans.reduce(|(low, high), (corner, _)| (low.inf(&corner), high.sup(&corner)))?;
    let low = low.map(|m| ((m - MARGIN_M) / resolution_m).floor());
    let high = high.map(|m| ((m + MARGIN_M) / resolution_m).ceil());
    let cells = high - low;
    if !(cells.x < MOST_CELLS && cells.y < MOST_CELLS) {
        return None;
    }
    GridFrame::new(low * resolution_m, resolution_m, cells.x as usize, cells.y as usize)
}

/// The largest number of cells along a side.
const MOST_CELLS: f64 = 1e6;
