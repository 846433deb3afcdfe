use crate::physics::convex;
use crate::physics::shape::Rectangle;
use nalgebra::Point2;

/// A place is free for an obstacle when everything that moves keeps this far away, m: far enough
/// for the physics not to push anything apart.
const ROOM_M: f64 = 0.005;

/// What an obstacle must not run into: it waits instead, so that nothing is ever crushed.
#[derive(Default)]
pub(in crate::physics) struct InTheWay {
    discs: Vec<(Point2<f64>, f64)>,
    /// Middle and radius of a circle around each body, and its corners, m.
    bodies: Vec<(Point2<f64>, f64, Vec<Point2<f64>>)>,
}

impl InTheWay {
    /// A round body (m).
    pub(in crate::physics) fn add_disc(&mut self, center: Point2<f64>, radius_m: f64) {
        self.discs.push((center, radius_m));
    }

    /// A convex body that lies within `radius_m` of `center` (m).
    pub(in crate::physics) fn add_body(
        &mut self,
        center: Point2<f64>,
        radius_m: f64,
        corners: Vec<Point2<f64>>,
    ) {
        self.bodies.push((center, radius_m, corners));
    }

    /// Whether a rectangle can go from one place to the other: what is near afterwards was no
    /// farther before.
    pub(super) fn is_free(&self, from: &Rectangle, to: &Rectangle) -> bool {
        let (before, after) = (from.corners(), to.corners());
        let is_clear = |gap_m: &dyn Fn(&[Point2<f64>]) -> f64| {
            let gap_after_m = gap_m(&after);
            gap_after_m >= ROOM_M || gap_after_m >= gap_m(&before)
        };
        let near = Near::new(to);
        let discs = self.discs.iter().filter(|(at, radius_m)| near.meets(at, *radius_m));
        let bodies = self.bodies.iter().filter(|(at, radius_m, _)| near.meets(at, *radius_m));
        discs.into_iter().all(|(at, radius_m)| is_clear(&|b| convex::disc_gap_m(b, at, *radius_m)))
            && bodies.into_iter().all(|(_, _, corners)| is_clear(&|b| convex::gap_m(b, corners)))
    }

    /// Whether a rectangle can be put down somewhere.
    pub(super) fn has_room(&self, shape: &Rectangle) -> bool {
        let corners = shape.corners();
        self.discs.iter().all(|(at, radius_m)| convex::disc_gap_m(&corners, at, *radius_m) >= ROOM_M)
            && self.bodies.iter().all(|(_, _, body)| convex::gap_m(&corners, body) >= ROOM_M)
    }
}

/// A circle around a rectangle: most things are nowhere near it.
struct Near {
    center: Point2<f64>,
    radius_m: f64,
}

impl Near {
    fn new(shape: &Rectangle) -> Self {
        Self { center: shape.pose.translation.vector.into(), radius_m: shape.half_m.norm() + ROOM_M }
    }

    fn meets(&self, at: &Point2<f64>, radius_m: f64) -> bool {
        (at - self.center).norm_squared() <= (self.radius_m + radius_m).powi(2)
    }
}
