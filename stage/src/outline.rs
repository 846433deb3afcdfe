//! The convex outline of a body.

use super::polygon;
use nalgebra::Point2;
use sim::physics::{Form, convex};

/// The maximum number of corners of an outline.
const MAX_CORNERS: usize = 32;
/// A corner is left out if the outline gains less than half of this area by it, m².
const MIN_CORNER_M2: f64 = 4e-6;
/// The minimum distance from the point that a robot turns about to its outline, m.
const MIN_INNER_M: f64 = 0.02;

/// The smallest convex outline around a body, with at most [`MAX_CORNERS`].
pub(super) struct Outline {
    /// Counter-clockwise, m.
    pub(super) corners: Vec<Point2<f64>>,
    /// By which share its area is larger than those of the parts of the body together; parts that overlap count twice.
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
    let body_m2: f64 = parts.iter().map(|part| convex::area(part).abs()).sum();
    let gain = convex::area(&corners) / body_m2 - 1.0;
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
        assert!(outline.gain < 0.0, "{}", outline.gain);
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
