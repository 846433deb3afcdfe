//! A disc that slides along bodies that it cannot move.
//!
//! Without friction, such bodies only take away the part of a motion that leads into them. A body is looked at only if
//! the disc would come too near to it on its straight path. The half-plane in which the disc then stays is that beyond
//! the tangent at its nearest point: a convex body lies on the other side, so that the disc passes through none.

use super::shape::Rectangle;
use nalgebra::{Matrix2, Point2, Vector2};

/// The gap that a motion leaves, m: far above the rounding of positions, far below the limit of contacts.
const GAP_M: f64 = 1e-4;
/// What rounding adds to a length of a few meters, m.
const ROUNDING_M: f64 = 1e-9;

/// A motion along bodies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slide {
    /// The motion, m.
    pub(super) moved_m: Vector2<f64>,
    /// The bodies (by index) that changed the motion, each with the length of its part of the change, m.
    pub(super) stops: Vec<(usize, f64)>,
}

/// The points on the side of a line to which `normal` (a unit vector) points, and down to `room_m` beyond the line.
struct HalfPlane {
    body: usize,
    normal: Vector2<f64>,
    room_m: f64,
}

impl HalfPlane {
    /// The motions of a disc that keep it away from a body. `None` if the center of the disc is in the body.
    fn beside(body: usize, shape: &Rectangle, center: &Point2<f64>, radius_m: f64) -> Option<Self> {
        let away = center - shape.nearest(center);
        let distance_m = away.norm();
        let room_m = (distance_m - radius_m - GAP_M).max(0.0);
        (distance_m > 0.0).then(|| Self { body, normal: away / distance_m, room_m })
    }

    /// How far a motion is beyond the border, m; negative if the motion is allowed.
    fn beyond_m(&self, motion_m: &Vector2<f64>) -> f64 {
        -self.room_m - self.normal.dot(motion_m)
    }
}

/// The motion of a disc with a center and a radius (m) that is nearest to `wanted_m` (m) among those in which it stays out
/// of all bodies. `None` if the center of the disc is in a body.
pub(super) fn slide(
    center: &Point2<f64>,
    radius_m: f64,
    wanted_m: &Vector2<f64>,
    bodies: &[Rectangle],
) -> Option<Slide> {
    let mut planes: Vec<HalfPlane> = Vec::new();
    let mut slide = Slide { moved_m: *wanted_m, stops: Vec::new() };
    loop {
        let known = planes.len();
        for (body, shape) in bodies.iter().enumerate() {
            if planes[..known].iter().any(|plane| plane.body == body) {
                continue;
            }
            let gap_m = shape.distance_m(center) - radius_m;
            // Most bodies are out of reach.
            if gap_m - slide.moved_m.norm() >= GAP_M {
                continue;
            }
            let least_m = shape.segment_distance_m(center, &(center + slide.moved_m)) - radius_m;
            if least_m < gap_m.min(GAP_M) - ROUNDING_M {
                planes.push(HalfPlane::beside(body, shape, center, radius_m)?);
            }
        }
        if planes.len() == known {
            return Some(slide);
        }
        slide = nearest(wanted_m, &planes);
    }
}

/// The motion nearest to the wanted one that all half-planes allow: the wanted one, or one on the border of one or two.
fn nearest(wanted_m: &Vector2<f64>, planes: &[HalfPlane]) -> Slide {
    // To stay is always allowed.
    let mut best = Slide { moved_m: Vector2::zeros(), stops: Vec::new() };
    let mut best_m2 = wanted_m.norm_squared();
    let mut consider = |change_m: Vector2<f64>, parts: [Option<(usize, f64)>; 2]| {
        let moved_m = wanted_m + change_m;
        let is_allowed = planes.iter().all(|plane| plane.beyond_m(&moved_m) <= ROUNDING_M);
        if is_allowed && change_m.norm_squared() <= best_m2 {
            best_m2 = change_m.norm_squared();
            best =
                Slide { moved_m, stops: parts.into_iter().flatten().filter(|stop| stop.1 > 0.0).collect() };
        }
    };
    consider(Vector2::zeros(), [None, None]);
    for (index, plane) in planes.iter().enumerate() {
        let beyond_m = plane.beyond_m(wanted_m);
        consider(plane.normal * beyond_m, [Some((plane.body, beyond_m)), None]);
        for other in &planes[..index] {
            // The parts along the two normals that lead to where both borders meet.
            let normals = Matrix2::from_columns(&[plane.normal, other.normal]);
            let beyond_m = Vector2::new(beyond_m, other.beyond_m(wanted_m));
            if let Some(parts_m) = (normals.transpose() * normals).lu().solve(&beyond_m) {
                let parts = [Some((plane.body, parts_m.x)), Some((other.body, parts_m.y))];
                consider(normals * parts_m, parts);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream};

    const RADIUS_M: f64 = 0.2;

    fn within(random: &mut RandomStream, low: f64, high: f64) -> f64 {
        random.uniform(low..high)
    }

    /// The least gap between the disc and a body on a straight path, m.
    fn least_m(at: &Point2<f64>, motion_m: &Vector2<f64>, bodies: &[Rectangle]) -> f64 {
        let gaps = bodies.iter().map(|body| body.segment_distance_m(at, &(at + motion_m)));
        gaps.fold(f64::INFINITY, f64::min) - RADIUS_M
    }

    #[test]
    fn a_disc_passes_nothing_and_goes_where_nothing_is_in_the_way() {
        let mut random = RandomStream::new(1, Purpose::Behavior(0));
        let (mut free, mut stopped) = (0, 0);
        for _ in 0..20_000 {
            let mut body = || {
                let center = Point2::new(within(&mut random, -0.6, 0.6), within(&mut random, -0.6, 0.6));
                let size = Vector2::new(within(&mut random, 0.01, 0.6), within(&mut random, 0.01, 0.6));
                Rectangle::around(center, size, within(&mut random, 0.0, 7.0))
            };
            let bodies: Vec<Rectangle> = (0..3).map(|_| body()).collect();
            let at = Point2::origin();
            let before_m = least_m(&at, &Vector2::zeros(), &bodies);
            if before_m < 0.0 {
                continue;
            }
            let wanted_m = Vector2::new(within(&mut random, -0.3, 0.3), within(&mut random, -0.3, 0.3));
            let Slide { moved_m, stops } = slide(&at, RADIUS_M, &wanted_m, &bodies).unwrap();
            assert!(least_m(&at, &moved_m, &bodies) >= before_m.min(GAP_M) - 2.0 * ROUNDING_M);
            // Without friction, bodies only push away from themselves, and add no energy.
            assert!(moved_m.norm() <= wanted_m.norm() + ROUNDING_M);
            if least_m(&at, &wanted_m, &bodies) >= before_m.min(GAP_M) {
                assert_eq!((moved_m, stops.len()), (wanted_m, 0));
                free += 1;
            } else {
                assert!(!stops.is_empty() && moved_m != wanted_m, "{moved_m} {wanted_m}");
                stopped += 1;
            }
        }
        assert!(free > 1000 && stopped > 1000, "{free} {stopped}");
    }

    #[test]
    fn between_long_walls_no_other_motion_is_nearer_to_the_wanted_one() {
        // Along a long wall, the half-plane is exactly where the disc does not meet the wall.
        let mut random = RandomStream::new(2, Purpose::Behavior(0));
        let at = Point2::origin();
        for _ in 0..200 {
            let mut wall = || {
                let direction = interfaces::rotation(within(&mut random, 0.0, 7.0)) * Vector2::x();
                let foot = at + direction * (RADIUS_M + within(&mut random, 0.0, 0.1));
                let along = Vector2::new(-direction.y, direction.x) * 100.0;
                Rectangle::along(foot - along, foot + along, 1e-6)
            };
            let walls = [wall(), wall(), wall()];
            let wanted_m = Vector2::new(within(&mut random, -0.3, 0.3), within(&mut random, -0.3, 0.3));
            let Slide { moved_m, .. } = slide(&at, RADIUS_M, &wanted_m, &walls).unwrap();
            let (most_m, steps) = (0.45, 300);
            let step_m = most_m / f64::from(steps);
            let motions = (-steps..=steps).flat_map(|x| (-steps..=steps).map(move |y| (x, y)));
            let allowed =
                motions.map(|(x, y)| Vector2::new(f64::from(x), f64::from(y)) * step_m).filter(|motion_m| {
                    (motion_m - wanted_m).norm() < (moved_m - wanted_m).norm() - step_m
                        && least_m(&at, motion_m, &walls) >= GAP_M
                });
            assert_eq!(allowed.count(), 0, "{wanted_m} {moved_m}");
        }
    }

    #[test]
    fn in_a_corner_both_walls_stop_the_disc() {
        let walls = [
            Rectangle::between(Point2::new(0.25, -9.0), Point2::new(1.0, 9.0)),
            Rectangle::between(Point2::new(-9.0, 0.2), Point2::new(9.0, 1.0)),
        ];
        let Slide { moved_m, stops } =
            slide(&Point2::origin(), RADIUS_M, &Vector2::new(0.1, 0.03), &walls).unwrap();
        assert!((moved_m - Vector2::new(0.05 - GAP_M, 0.0)).norm() < 1e-12, "{moved_m}");
        let [(1, up_m), (0, right_m)] = stops[..] else { panic!("{stops:?}") };
        assert!((right_m - 0.05 - GAP_M).abs() < 1e-12 && (up_m - 0.03).abs() < 1e-12);
    }
}
