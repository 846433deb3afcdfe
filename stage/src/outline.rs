//! The convex outline of a body.

use super::polygon;
use nalgebra::Point2;
use sim::physics::{Form, convex};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use worldfile::Files;
use worldfile::floor_plan::{Bitmap, MAX_FILE_BYTES};

/// The maximum number of corners of an outline.
const MAX_CORNERS: usize = 32;
/// A corner is left out if the outline gains less than half of this area by it, m².
const MIN_CORNER_M2: f64 = 4e-6;
/// The minimum distance from the point that a robot turns about to its outline, m.
const MIN_INNER_M: f64 = 0.02;
/// The number of lines that measure the area of a body of several parts.
const LINES: usize = 256;

/// The smallest convex outline around a body, with at most [`MAX_CORNERS`].
pub(super) struct Outline {
    /// Counter-clockwise, m.
    pub(super) corners: Vec<Point2<f64>>,
    /// By which share its area is larger than that of the body.
    pub(super) gain: f64,
}

/// The outline of a body of `parts`; none if it does not hold the origin.
pub(super) fn of(parts: &[Vec<Point2<f64>>]) -> Option<Outline> {
    let mut corners = convex::hull(parts.iter().flatten().copied());
    while let Some((flattest, area_m2)) = flattest(&corners)
        && (corners.len() > MAX_CORNERS || area_m2 < MIN_CORNER_M2)
    {
        corners.remove(flattest);
    }
    if corners.len() < 3 || inner_m(&corners) < MIN_INNER_M {
        return None;
    }
    let area_m2 = convex::area(&corners);
    // Most bodies have one part that is nearly all of it, and that is quickly seen.
    let largest_m2 = parts.iter().map(|part| convex::area(part).abs()).fold(0.0, f64::max);
    let gain = area_m2 / largest_m2 - 1.0;
    let gain = if parts.len() < 2 || gain < 1e-9 { gain } else { gain.min(gain_by_lines(&corners, parts)) };
    Some(Outline { corners, gain })
}

/// The radius of the circle about the origin that lies within, m; negative if it lies outside.
pub(super) fn inner_m(corners: &[Point2<f64>]) -> f64 {
    -Form::Convex(corners.to_vec()).gap_m_to(&Point2::origin())
}

/// The corner without which an outline loses least, and twice the area that it loses, m².
fn flattest(corners: &[Point2<f64>]) -> Option<(usize, f64)> {
    let twice_m2 = polygon::turns(corners).map(|[to, from]| to.perp(&from)).enumerate();
    twice_m2.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|_| corners.len() >= 3)
}

/// By which share a convex outline is larger than the parts in it together, measured along lines
/// across both.
fn gain_by_lines(corners: &[Point2<f64>], parts: &[Vec<Point2<f64>>]) -> f64 {
    let (low, high) = polygon::bounds(corners.iter().copied());
    let (mut outline_m, mut body_m) = (0.0, 0.0);
    for line in 0..LINES {
        let y = low.y + (high.y - low.y) * (line as f64 + 0.5) / LINES as f64;
        outline_m += length_m(polygon::spans(corners, y));
        body_m += length_m(parts.iter().flat_map(|part| polygon::spans(part, y)).collect());
    }
    outline_m / body_m - 1.0
}

/// The length of spans that may overlap, together, m.
fn length_m(mut spans: Vec<[f64; 2]>) -> f64 {
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut length_m, mut reached) = (0.0, f64::NEG_INFINITY);
    for [from, to] in spans {
        length_m += (to - from.max(reached)).max(0.0);
        reached = reached.max(to);
    }
    length_m
}

// The bitmaps of a world, each decoded once.

/// A pixel is blocked if its first color is below this.
const BLOCKED_BELOW: f64 = 128.0 / 255.0;
/// The maximum number of pixels of all bitmaps together, each as often as it is used.
const MAX_PIXELS: u64 = 1 << 27;
/// The maximum number of rectangles of all bitmaps together, each as often as it is used.
const MAX_RECTANGLES: usize = 1 << 20;

/// Bitmaps by their paths.
#[derive(Default)]
pub(super) struct Pictures {
    decoded: BTreeMap<PathBuf, Arc<Bitmap>>,
    pixels: u64,
    rectangles: usize,
}

impl Pictures {
    /// The bitmap of a file: dark is blocked, by the first color as in Stage.
    pub(super) fn get(&mut self, files: &dyn Files, path: &Path) -> Result<Arc<Bitmap>, String> {
        if !self.decoded.contains_key(path) {
            let bytes = files.read(path, MAX_FILE_BYTES).map_err(|error| error.to_string())?;
            let bitmap = Bitmap::decode(&bytes, |pixel| pixel.red < BLOCKED_BELOW)?;
            self.decoded.insert(path.to_owned(), Arc::new(bitmap));
        }
        let bitmap = Arc::clone(&self.decoded[path]);
        self.pixels += u64::from(bitmap.width()) * u64::from(bitmap.height());
        if self.pixels > MAX_PIXELS {
            return Err(format!("the bitmaps of this world have more than {MAX_PIXELS} pixels together"));
        }
        self.rectangles += bitmap.rectangles().len();
        if self.rectangles > MAX_RECTANGLES {
            return Err(format!(
                "the bitmaps of this world make more than {MAX_RECTANGLES} rectangles together"
            ));
        }
        Ok(bitmap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(left: f64, bottom: f64, side: f64) -> Vec<Point2<f64>> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
            .map(|(x, y)| Point2::new(left + x, bottom + y))
            .to_vec()
    }

    #[test]
    fn parts_may_overlap() {
        // A square, one within it, and one that overlaps half of it: 2 × 1 with a notch of 0.5 × 0.
        let parts = [square(-1.0, -0.5, 1.0), square(-0.5, -0.5, 1.0), square(-0.2, -0.2, 0.1)];
        let outline = of(&parts).unwrap();
        assert_eq!(outline.corners.len(), 4);
        assert!(outline.gain.abs() < 1e-9, "{}", outline.gain);
        // Two squares corner to corner cover 2 of the 3 of their hull.
        let outline = of(&[square(-1.0, -1.0, 1.0), square(0.0, 0.0, 1.0)]).unwrap();
        assert_eq!(outline.corners.len(), 6);
        assert!((outline.gain - 0.5).abs() < 0.01, "{}", outline.gain);
    }

    #[test]
    fn many_corners_become_few_and_the_origin_lies_within() {
        let ring = |radius_m: f64, count: usize| -> Vec<Point2<f64>> {
            let corner = |i: usize| interfaces::rotation(i as f64 * std::f64::consts::TAU / count as f64);
            (0..count).map(|i| corner(i) * Point2::new(radius_m, 0.0)).collect()
        };
        let outline = of(&[ring(0.3, 1000)]).unwrap();
        assert_eq!(outline.corners.len(), MAX_CORNERS);
        assert!(outline.gain < 0.0 && outline.gain > -0.02, "{}", outline.gain);
        assert!(inner_m(&outline.corners) > 0.29);
        assert!(of(&[square(0.0, 0.0, 1.0)]).is_none());
        assert!(of(&[vec![Point2::origin(); 4]]).is_none());
    }
}
