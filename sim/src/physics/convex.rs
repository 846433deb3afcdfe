//! Convex bodies, given by their corners, counter-clockwise, m.

use nalgebra::{Point2, Vector2};

/// The gap between two convex bodies, m, measured across the side that separates them best: at most their distance,
/// and negative if they overlap.
pub fn gap_m(a: &[Point2<f64>], b: &[Point2<f64>]) -> f64 {
    beyond_m(a, b).max(beyond_m(b, a))
}

/// The gap between a convex body and a disc, m; negative if they overlap.
pub fn disc_gap_m(body: &[Point2<f64>], center: &Point2<f64>, radius_m: f64) -> f64 {
    let inside_m = beyond_m(body, &[*center]);
    let border_m = sides(body).map(|(from, to)| point_segment_m(center, from, to));
    if inside_m < 0.0 { inside_m - radius_m } else { border_m.fold(f64::INFINITY, f64::min) - radius_m }
}

/// The radius of a circle within a convex body, m.
pub fn inner_m(body: &[Point2<f64>]) -> f64 {
    let middle: Vector2<f64> =
        body.iter().map(|corner| corner.coords).sum::<Vector2<f64>>() / body.len() as f64;
    -disc_gap_m(body, &middle.into(), 0.0)
}

/// The largest distance, over the sides of `body`, by which all `points` lie outside of the side, m.
fn beyond_m(body: &[Point2<f64>], points: &[Point2<f64>]) -> f64 {
    let outside = sides(body).map(|(from, to)| {
        let along = (to - from).normalize();
        points.iter().map(|point| (point - from).perp(&along)).fold(f64::INFINITY, f64::min)
    });
    outside.fold(f64::NEG_INFINITY, f64::max)
}

/// The distance from a point to a segment, m.
pub fn point_segment_m(point: &Point2<f64>, a: &Point2<f64>, b: &Point2<f64>) -> f64 {
    let (along, to) = (b - a, point - a);
    let length2 = along.norm_squared();
    let share = if length2 > 0.0 { (to.dot(&along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (to - along * share).norm()
}

/// The area of a counter-clockwise polygon, m².
pub fn area(polygon: &[Point2<f64>]) -> f64 {
    let Some(first) = polygon.first() else { return 0.0 };
    // Relative to one of its corners, so that nothing is lost far from the origin.
    polygon.windows(2).map(|pair| (pair[0] - first).perp(&(pair[1] - first))).sum::<f64>() / 2.0
}

/// The convex hull of points (Andrew's monotone chain), without corners that are flat.
pub fn hull(points: impl IntoIterator<Item = Point2<f64>>) -> Vec<Point2<f64>> {
    const FLAT_M2: f64 = 1e-12;
    let mut points: Vec<Point2<f64>> = points.into_iter().collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = &Point2<f64>>| {
        let mut chain: Vec<Point2<f64>> = Vec::new();
        for point in points {
            while let [.., a, b] = chain.as_slice()
                && (b - a).perp(&(point - b)) <= FLAT_M2
            {
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let mut corners = chain(&mut points.iter());
    corners.extend(chain(&mut points.iter().rev()));
    corners
}

/// The sides, in order.
pub fn sides(body: &[Point2<f64>]) -> impl Iterator<Item = (&Point2<f64>, &Point2<f64>)> {
    body.iter().zip(body.iter().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::shape::Rectangle;

    fn square(left: f64, bottom: f64) -> Vec<Point2<f64>> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(x, y)| Point2::new(left + x, bottom + y))
            .to_vec()
    }

    #[test]
    fn a_hull_holds_all_points_and_is_convex() {
        let shape = Rectangle::around(Point2::new(1.0, 1.0), Vector2::new(0.4, 0.2), 0.3);
        let along = shape.pose * Vector2::new(0.4, 0.0);
        for way in [Vector2::new(2.0, 0.7), Vector2::new(-1.0, -1.0), along, Vector2::zeros()] {
            let points = [shape.corners(), shape.moved(way).corners()].concat();
            let hull = hull(points.iter().copied());
            assert!(points.iter().all(|point| disc_gap_m(&hull, point, 0.0) < 1e-9), "{way}: {hull:?}");
            let turns = (0..hull.len()).map(|i| {
                let [a, b, c] = [0, 1, 2].map(|k| hull[(i + k) % hull.len()]);
                (b - a).perp(&(c - b))
            });
            assert!(turns.into_iter().all(|turn| turn > 0.0), "{way}: {hull:?}");
        }
    }

    #[test]
    fn gaps_are_between_the_borders_and_negative_inside() {
        assert!((gap_m(&square(0.0, 0.0), &square(1.5, 0.3)) - 0.5).abs() < 1e-12);
        assert!((gap_m(&square(0.0, 0.0), &square(0.75, 0.0)) + 0.25).abs() < 1e-12);
        let disc = |x, y| disc_gap_m(&square(0.0, 0.0), &Point2::new(x, y), 0.5);
        assert!((disc(2.0, 0.5) - 0.5).abs() < 1e-12);
        assert!((disc(4.0, 5.0) - 4.5).abs() < 1e-12);
        assert!((disc(0.9, 0.5) + 0.6).abs() < 1e-12);
    }
}
