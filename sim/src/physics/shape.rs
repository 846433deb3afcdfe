//! Rectangles, and geometric relations between points, segments and poses.

use super::convex::gap_m;
pub use super::convex::point_segment_m;
use interfaces::{GridFrame, rotation};
use nalgebra::{Isometry2, Point2, Rotation2, Translation2, UnitComplex, Vector2};

/// Bodies whose overlap is smaller than this only touch, m. The value is far above rounding errors, and far below
/// the resolution of a laser or a map.
pub const TOUCH_M: f64 = 1e-6;

/// A rectangle at any pose: a wall or a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The center, and the direction of the first side, m and rad.
    pub pose: Isometry2<f64>,
    /// Half the length of each side, m.
    pub half_m: Vector2<f64>,
}

impl Rectangle {
    /// The axis-aligned rectangle between two opposite corners (m).
    pub fn between(min: Point2<f64>, max: Point2<f64>) -> Self {
        let middle = nalgebra::center(&min, &max);
        Self {
            pose: Isometry2::from_parts(middle.into(), UnitComplex::identity()),
            half_m: (max - min) / 2.0,
        }
    }

    /// The rectangle of `thickness_m` whose center line runs from `from` to `to` (m).
    pub fn along(from: Point2<f64>, to: Point2<f64>, thickness_m: f64) -> Self {
        let (along, middle) = (to - from, nalgebra::center(&from, &to));
        let length_m = along.norm();
        // Without computing an angle: a vertical wall stays exactly vertical.
        let turn = UnitComplex::from_cos_sin_unchecked(along.x / length_m, along.y / length_m);
        let half_m = Vector2::new(length_m, thickness_m) / 2.0;
        Self { pose: Isometry2::from_parts(middle.into(), turn), half_m }
    }

    /// The rectangle with the center `center` and sides of `size` (m), rotated by `heading_rad`.
    pub fn around(center: Point2<f64>, size: Vector2<f64>, heading_rad: f64) -> Self {
        Self { pose: Isometry2::from_parts(center.into(), rotation(heading_rad)), half_m: size / 2.0 }
    }

    /// The corners, counter-clockwise, m.
    pub fn corners(&self) -> [Point2<f64>; 4] {
        let (x, y) = (self.half_m.x, self.half_m.y);
        [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| self.pose * Point2::new(x, y))
    }

    /// The point of the rectangle that is nearest to `point` (m): `point` itself inside.
    pub fn nearest(&self, point: &Point2<f64>) -> Point2<f64> {
        let local = self.pose.inverse_transform_point(point);
        self.pose * Point2::from(local.coords.sup(&-self.half_m).inf(&self.half_m))
    }

    /// The distance of `point` (m) from the rectangle, m; 0 inside.
    pub fn distance_m(&self, point: &Point2<f64>) -> f64 {
        let local = self.pose.inverse_transform_point(point);
        let outside = |x: f64, half_m: f64| (x.abs() - half_m).max(0.0);
        Vector2::new(outside(local.x, self.half_m.x), outside(local.y, self.half_m.y)).norm()
    }

    /// The range at which a ray from `origin` (m) in the direction of the unit vector `direction` hits the
    /// rectangle, m; 0 if the origin is inside, `None` if the ray misses.
    pub fn ray_m(&self, origin: &Point2<f64>, direction: &Vector2<f64>) -> Option<f64> {
        let from = self.pose.inverse_transform_point(origin);
        let along = self.pose.inverse_transform_vector(direction);
        let (mut enter_m, mut leave_m) = (0.0_f64, f64::INFINITY);
        for axis in 0..2 {
            if along[axis] == 0.0 {
                if from[axis].abs() > self.half_m[axis] {
                    return None;
                }
                continue;
            }
            let ends = [-self.half_m[axis], self.half_m[axis]].map(|side| (side - from[axis]) / along[axis]);
            enter_m = enter_m.max(ends[0].min(ends[1]));
            leave_m = leave_m.min(ends[0].max(ends[1]));
        }
        (enter_m <= leave_m).then_some(enter_m)
    }

    /// The distance of the segment from `a` to `b` (m) from the rectangle, m; 0 if the segment enters the
    /// rectangle.
    pub fn segment_distance_m(&self, a: &Point2<f64>, b: &Point2<f64>) -> f64 {
        let corners = self.corners();
        let sides = (0..4).map(|i| (corners[i], corners[(i + 1) % 4]));
        if sides.into_iter().any(|(p, q)| crosses(a, b, &p, &q)) {
            return 0.0;
        }
        let ends = self.distance_m(a).min(self.distance_m(b));
        corners.iter().fold(ends, |least, corner| least.min(point_segment_m(corner, a, b)))
    }

    /// Whether two rectangles overlap by more than [`TOUCH_M`].
    pub fn overlaps(&self, other: &Self) -> bool {
        gap_m(&self.corners(), &other.corners()) < -TOUCH_M
    }

    /// The rectangle moved by a vector, m.
    pub fn moved(&self, by_m: Vector2<f64>) -> Self {
        Self { pose: Translation2::from(by_m) * self.pose, half_m: self.half_m }
    }

    /// The rectangle after a rigid motion of the world.
    pub fn transformed(&self, by: &Transform) -> Self {
        Self { pose: by.pose(&self.pose), half_m: self.half_m }
    }

    /// The lower left and the upper right corner of the axis-aligned box around the rectangle, m.
    pub fn bounds(&self) -> (Point2<f64>, Point2<f64>) {
        let turn = Rotation2::from(self.pose.rotation).into_inner().abs();
        let (middle, reach) = (Point2::from(self.pose.translation.vector), turn * self.half_m);
        (middle - reach, middle + reach)
    }
}

/// A rigid motion of the whole world: a rotation about a point, which moves elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Transform {
    /// The rotation.
    pub turn: UnitComplex<f64>,
    /// The center of the rotation before the motion, m.
    pub from: Point2<f64>,
    /// The center of the rotation after the motion, m: exactly here.
    pub to: Point2<f64>,
}

impl Transform {
    /// A point after the motion, m.
    pub fn point(&self, point: &Point2<f64>) -> Point2<f64> {
        self.to + self.turn * (point - self.from)
    }

    /// A pose after the motion.
    pub fn pose(&self, pose: &Isometry2<f64>) -> Isometry2<f64> {
        let at = self.point(&pose.translation.vector.into());
        Isometry2::from_parts(Translation2::from(at), self.turn * pose.rotation)
    }
}

/// Whether two segments cross each other in their interiors.
fn crosses(a: &Point2<f64>, b: &Point2<f64>, p: &Point2<f64>, q: &Point2<f64>) -> bool {
    let side = |from: &Point2<f64>, to: &Point2<f64>, point: &Point2<f64>| (to - from).perp(&(point - from));
    side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0
}

/// The lower left and the upper right corner of a grid, m.
pub(in crate::physics) fn grid_corners(frame: &GridFrame) -> (Point2<f64>, Point2<f64>) {
    let size = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
    (frame.origin(), frame.origin() + size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_is_not_overlapping() {
        let left = Rectangle::between(Point2::new(0.0, 0.0), Point2::new(1.0, 1.0));
        let right = Rectangle::between(Point2::new(1.0, 0.0), Point2::new(2.0, 1.0));
        assert!(!left.overlaps(&right));
        assert!(left.overlaps(&Rectangle::around(Point2::new(1.2, 0.5), Vector2::new(0.5, 0.5), 0.7)));
    }

    #[test]
    fn distances_are_to_the_border() {
        let wall = Rectangle::along(Point2::new(0.0, 0.0), Point2::new(0.0, 2.0), 0.1);
        assert!((wall.distance_m(&Point2::new(1.05, 1.0)) - 1.0).abs() < 1e-12);
        assert_eq!(wall.distance_m(&Point2::new(0.01, 1.0)), 0.0);
        let (a, b) = (Point2::new(-1.0, 1.0), Point2::new(1.0, 1.0));
        assert_eq!(wall.segment_distance_m(&a, &b), 0.0);
        let (a, b) = (Point2::new(-1.0, 2.5), Point2::new(1.0, 2.5));
        assert!((wall.segment_distance_m(&a, &b) - 0.5).abs() < 1e-12);
    }
}
