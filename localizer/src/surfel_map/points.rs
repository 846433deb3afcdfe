//! A line map as a list of points on surfaces, and back: what is kept of a map that is rarely needed.

use super::SurfelMap;
use crate::constants::{SURFEL_M, TRUSTED_SCANS};
use crate::scan_points::ScanPoint;
use interfaces::GridFrame;
use nalgebra::{Isometry2, Point2, Vector2};

/// No map of points is larger, m.
const MAX_PLACE_M: f64 = 200.0;

impl SurfelMap {
    /// All surfels that take part in matching, in a frame whose pose in the frame of the map is `pose`.
    pub(crate) fn points(&self, pose: &Isometry2<f64>) -> Vec<ScanPoint> {
        let back = pose.inverse();
        let point = |(beam, surfel): (usize, &super::Surfel)| ScanPoint {
            beam,
            ..ScanPoint::new(back * surfel.at, back.rotation * surfel.normal)
        };
        self.usable().enumerate().map(point).collect()
    }

    /// The map of some points, all with full weight.
    pub(crate) fn of_points(points: &[ScanPoint]) -> Option<Self> {
        let first = points.first()?.at;
        let (low, high) = points.iter().fold((first, first), |(low, high), point| {
            (low.coords.inf(&point.at.coords).into(), high.coords.sup(&point.at.coords).into())
        });
        let size: Vector2<f64> = high - low;
        if size.max() > MAX_PLACE_M {
            return None;
        }
        let origin: Point2<f64> = low - Vector2::repeat(SURFEL_M);
        let frame = GridFrame::covering(origin, size.x + 2.0 * SURFEL_M, size.y + 2.0 * SURFEL_M, SURFEL_M)?;
        let mut map = Self::new(&frame);
        for point in points {
            map.add(point.at, point.normal, TRUSTED_SCANS);
        }
        Some(map)
    }
}
