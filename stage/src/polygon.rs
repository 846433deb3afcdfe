//! From polygons to solid rectangles, of which walls are made.

use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};
use sim::physics::Rectangle;
use sim::physics::convex::{area, sides};
use worldfile::floor_plan::Bitmap;

/// Corners closer than this are one, and angles right to within it, m and rad.
const SAME: f64 = 1e-7;
/// How thick the rim of a polygon without right angles is at most, m.
const RIM_M: f64 = 0.05;

/// Rectangles that approximate a polygon.
#[derive(Debug, PartialEq)]
pub(super) struct Cover {
    pub(super) rectangles: Vec<Rectangle>,
    /// How far the surface may be off, m; 0 is exact.
    pub(super) off_m: f64,
}

/// Covers a simple polygon. One with right angles is covered exactly. Of any other one, the rim is
/// made of rectangles that lie inside; the surface is exact but for sharp corners, which are cut
/// off, and the middle stays hollow.
pub(super) fn cover(points: &[Point2<f64>]) -> Cover {
    let corners = clean(points);
    if corners.len() < 3 {
        return Cover { rectangles: Vec::new(), off_m: f64::INFINITY };
    }
    right_angled(&corners).unwrap_or_else(|| rim(&corners))
}

/// Without points on each other or on the line between their neighbors, counter-clockwise.
fn clean(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut corners: Vec<Point2<f64>> = Vec::new();
    for point in points {
        if corners.last().is_none_or(|last| (point - last).norm() > SAME) {
            corners.push(*point);
        }
    }
    while corners.len() > 1 && (corners[0] - corners[corners.len() - 1]).norm() <= SAME {
        corners.pop();
    }
    let is_corner = |[to, from]: [Vector2<f64>; 2]| {
        let (to, from) = (to.normalize(), from.normalize());
        to.perp(&from).abs() > SAME || to.dot(&from) < 0.0
    };
    let kept = corners.iter().zip(turns(&corners)).filter(|(_, turn)| is_corner(*turn));
    let mut corners: Vec<Point2<f64>> = kept.map(|(corner, _)| *corner).collect();
    if area(&corners) < 0.0 {
        corners.reverse();
    }
    corners
}

/// The lower left and the upper right corner of the upright box around points.
pub(super) fn bounds(points: impl Iterator<Item = Point2<f64>>) -> (Point2<f64>, Point2<f64>) {
    let none = (Point2::new(f64::MAX, f64::MAX), Point2::new(f64::MIN, f64::MIN));
    points.fold(none, |(low, high), point| (low.inf(&point), high.sup(&point)))
}

/// Per corner of a polygon, the side that leads to it and the side that leads away from it.
pub(super) fn turns(corners: &[Point2<f64>]) -> impl Iterator<Item = [Vector2<f64>; 2]> {
    let from = sides(corners).map(|(a, b)| b - a);
    let to = corners.iter().cycle().skip(corners.len().saturating_sub(1));
    corners.iter().zip(to).zip(from).map(|((corner, before), from)| [corner - before, from])
}

/// Where a line along x lies in a polygon, m.
pub(super) fn spans(corners: &[Point2<f64>], y: f64) -> Vec<[f64; 2]> {
    let crossing = sides(corners).filter(|(a, b)| (a.y > y) != (b.y > y));
    let mut xs: Vec<f64> = crossing.map(|(a, b)| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)).collect();
    xs.sort_by(f64::total_cmp);
    xs.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Whether a point lies in a polygon.
fn contains(corners: &[Point2<f64>], point: &Point2<f64>) -> bool {
    spans(corners, point.y).iter().any(|[from, to]| (*from..*to).contains(&point.x))
}

/// The exact cover of a polygon with right angles only: it is drawn on a grid whose lines go
/// through its corners.
fn right_angled(corners: &[Point2<f64>]) -> Option<Cover> {
    let along = (corners[1] - corners[0]).normalize();
    let is_right = |(a, b): (&Point2<f64>, &Point2<f64>)| {
        let side = (b - a).normalize();
        side.dot(&along).abs() < SAME || side.perp(&along).abs() < SAME
    };
    // A grid of more lines would have too many cells.
    if corners.len() > 400 || !sides(corners).all(is_right) {
        return None;
    }
    let frame =
        Isometry2::from_parts(corners[0].into(), UnitComplex::from_cos_sin_unchecked(along.x, along.y));
    let local: Vec<Point2<f64>> =
        corners.iter().map(|corner| frame.inverse_transform_point(corner)).collect();
    let lines = |axis: usize| {
        let mut lines: Vec<f64> = local.iter().map(|corner| corner[axis]).collect();
        lines.sort_by(f64::total_cmp);
        lines.dedup_by(|a, b| (*a - *b).abs() < 10.0 * SAME);
        lines
    };
    let (xs, ys) = (lines(0), lines(1));
    let middle = |lines: &[f64], i: usize| (lines[i] + lines[i + 1]) / 2.0;
    let cells = (0..ys.len() - 1).flat_map(|y| (0..xs.len() - 1).map(move |x| (x, y)));
    let blocked: Vec<bool> =
        cells.map(|(x, y)| contains(&local, &Point2::new(middle(&xs, x), middle(&ys, y)))).collect();
    let bitmap = Bitmap::new(xs.len() as u32 - 1, ys.len() as u32 - 1, &blocked).ok()?;
    let rectangles = bitmap.rectangles().iter().map(|cells| {
        let corner = |[x, y]: [u32; 2]| Point2::new(xs[x as usize], ys[y as usize]);
        let local = Rectangle::between(corner(cells.min), corner(cells.max));
        Rectangle { pose: frame * local.pose, ..local }
    });
    Some(Cover { rectangles: rectangles.collect(), off_m: 0.0 })
}

/// A rectangle inside along every side.
fn rim(corners: &[Point2<f64>]) -> Cover {
    let count = corners.len();
    let mut cover = Cover { rectangles: Vec::new(), off_m: 0.0 };
    for i in 0..count {
        let (before, a) = (corners[(i + count - 1) % count], corners[i]);
        let (b, after) = (corners[(i + 1) % count], corners[(i + 2) % count]);
        let (length_m, along) = ((b - a).norm(), (b - a).normalize());
        let inwards = Vector2::new(-along.y, along.x);
        // Where the corner is sharper than a right angle, a rectangle would stick out.
        let cut = |to_other: Vector2<f64>, along: Vector2<f64>| {
            let (cos, sin) = (to_other.normalize().dot(&along), to_other.normalize().dot(&inwards));
            if sin > SAME && cos > SAME { cos / sin } else { 0.0 }
        };
        let (cut_a, cut_b) = (cut(before - a, along), cut(after - b, -along));
        let mut thickness_m = RIM_M;
        for _ in 0..8 {
            let (from_m, to_m) = (cut_a * thickness_m, length_m - cut_b * thickness_m);
            let inner =
                [a + along * from_m + inwards * thickness_m, a + along * to_m + inwards * thickness_m];
            if from_m < to_m && is_inside(corners, i, &inner) {
                let middle = a + along * ((from_m + to_m) / 2.0) + inwards * (thickness_m / 2.0);
                let turn = UnitComplex::from_cos_sin_unchecked(along.x, along.y);
                cover.rectangles.push(Rectangle {
                    pose: Isometry2::from_parts(middle.into(), turn),
                    half_m: Vector2::new(to_m - from_m, thickness_m) / 2.0,
                });
                cover.off_m = cover.off_m.max(from_m.max(length_m - to_m));
                break;
            }
            thickness_m /= 2.0;
        }
    }
    cover
}

/// Whether the segment lies in the polygon and no corner but the ends of side `own` lies between
/// the segment and that side.
fn is_inside(corners: &[Point2<f64>], own: usize, inner: &[Point2<f64>; 2]) -> bool {
    let (a, b) = (corners[own], corners[(own + 1) % corners.len()]);
    let along = (b - a).normalize();
    let thickness_m = along.perp(&(inner[0] - a));
    let (from_m, to_m) = (along.dot(&(inner[0] - a)), along.dot(&(inner[1] - a)));
    // Other sides may touch the rectangle, but not enter it: cut each to the strip and look.
    let enters = sides(corners).enumerate().filter(|(i, _)| *i != own).any(|(_, (p, q))| {
        let local = |point: &Point2<f64>| Vector2::new(along.dot(&(point - a)), along.perp(&(point - a)));
        let (p, q) = (local(p), local(q));
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for (axis, least, most) in [(0, from_m + SAME, to_m - SAME), (1, SAME, thickness_m - SAME)] {
            let step = q[axis] - p[axis];
            if step.abs() < 1e-15 {
                if p[axis] <= least || p[axis] >= most {
                    return false;
                }
                continue;
            }
            let (s, t) = ((least - p[axis]) / step, (most - p[axis]) / step);
            (low, high) = (low.max(s.min(t)), high.min(s.max(t)));
        }
        low < high
    });
    !enters && contains(corners, &nalgebra::center(&inner[0], &inner[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon(points: &[[f64; 2]]) -> Vec<Point2<f64>> {
        points.iter().map(|point| Point2::from(*point)).collect()
    }

    fn covers(cover: &Cover, point: &Point2<f64>) -> bool {
        cover.rectangles.iter().any(|rectangle| rectangle.distance_m(point) == 0.0)
    }

    #[test]
    fn right_angles_are_exact() {
        let square = polygon(&[[0.0, 0.0], [0.0, 2.0], [1.0, 2.0], [1.0, 1.0], [1.0, 0.0]]);
        let cover_of_square = cover(&square);
        assert_eq!(cover_of_square.rectangles.len(), 1);
        assert_eq!(cover_of_square.rectangles[0].bounds(), ([0.0, 0.0].into(), [1.0, 2.0].into()));
        let turn = interfaces::pose(3.0, 4.0, 0.7);
        let hook = polygon(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
        let turned: Vec<_> = hook.iter().map(|point| turn * point).collect();
        let cover = cover(&turned);
        assert_eq!((cover.rectangles.len(), cover.off_m), (2, 0.0));
        for (point, expected) in
            [([2.9, 0.9], true), ([0.9, 1.9], true), ([1.1, 1.1], false), ([3.1, 0.5], false)]
        {
            assert_eq!(covers(&cover, &(turn * Point2::from(point))), expected);
        }
    }

    #[test]
    fn an_octagon_keeps_its_surface() {
        let half = [[-0.2, 0.12], [-0.2, -0.12], [-0.12, -0.25], [0.12, -0.25]];
        let octagon = polygon(&[half, half.map(|[x, y]| [-x, -y])].concat());
        let cover = cover(&octagon);
        assert_eq!((cover.rectangles.len(), cover.off_m), (8, 0.0));
        for (a, b) in sides(&clean(&octagon)) {
            let outwards = Vector2::new((b - a).y, (a - b).x).normalize();
            for share in [0.001, 0.3, 0.999] {
                let on = a + (b - a) * share;
                assert!(covers(&cover, &(on - outwards * 1e-6)) && !covers(&cover, &(on + outwards * 1e-6)));
            }
        }
    }

    #[test]
    fn what_has_no_area_has_no_cover() {
        assert!(cover(&polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])).rectangles.is_empty());
        assert!(cover(&[]).rectangles.is_empty());
    }

    proptest! {
        /// No rectangle sticks out of a star-shaped polygon, sharp corners or not.
        #[test]
        fn covers_lie_inside(radii in proptest::collection::vec(0.05..1.0_f64, 3..12)) {
            let step = std::f64::consts::TAU / radii.len() as f64;
            let points: Vec<Point2<f64>> = radii.iter().enumerate()
                .map(|(i, radius)| interfaces::rotation(step * i as f64) * Point2::new(*radius, 0.0)).collect();
            let cover = cover(&points);
            for rectangle in &cover.rectangles {
                let middle = Point2::from(rectangle.pose.translation.vector);
                for corner in rectangle.corners() {
                    let inside = corner + (middle - corner) * 1e-4;
                    prop_assert!(contains(&points, &inside), "{corner}");
                }
            }
        }

        #[test]
        fn no_points_make_it_panic(points in proptest::collection::vec((-3..3_i32, -3..3_i32), 0..9)) {
            let points: Vec<_> = points.iter().map(|(x, y)| Point2::new(f64::from(*x), f64::from(*y))).collect();
            cover(&points);
        }
    }
}
