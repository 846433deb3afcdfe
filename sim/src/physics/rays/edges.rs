//! The edges of a set of rectangles that a ray can hit.

use crate::physics::box_tree::BoxTree;
use crate::physics::shape::Rectangle;
use nalgebra::{Point2, Vector2};

/// Edges and corners closer than this count as the same, m: far above rounding, far below anything that a
/// range could show.
const ON_M: f64 = 1e-9;
/// The distance outside of an edge at which the edge is tested for being covered, m.
const BESIDE_M: f64 = 1e-7;

/// A side of a solid. The solid lies on the left of the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    pub(super) from: Point2<f64>,
    pub(super) to: Point2<f64>,
    /// The unit vector that points out of the solid.
    pub(super) normal: Vector2<f64>,
}

impl Edge {
    pub(super) fn new(from: Point2<f64>, to: Point2<f64>) -> Self {
        let along = to - from;
        Self { from, to, normal: Vector2::new(along.y, -along.x) / along.norm() }
    }

    /// How far outside of the edge's line a point lies, m; negative on the side of the solid.
    pub(super) fn gap_m(&self, point: &Point2<f64>) -> f64 {
        self.normal.dot(&(point - self.from))
    }

    /// The sides of a convex body with these corners.
    pub(super) fn around(corners: impl Iterator<Item = Point2<f64>> + Clone) -> impl Iterator<Item = Self> {
        let next = corners.clone().cycle().skip(1);
        corners.zip(next).map(|(from, to)| Self::new(from, to))
    }

    /// The sides of a rectangle.
    pub(super) fn of_rectangle(shape: &Rectangle) -> [Self; 4] {
        let corners = shape.corners();
        [0, 1, 2, 3].map(|i| Self::new(corners[i], corners[(i + 1) % 4]))
    }
}

/// The sides of all rectangles that a ray from outside can hit first: without sides that another rectangle
/// covers; sides that continue each other are merged.
pub(super) fn visible_edges(boxes: &[Rectangle]) -> Vec<Edge> {
    let sides: Vec<[Edge; 4]> = boxes.iter().map(Edge::of_rectangle).collect();
    let tree = BoxTree::new(boxes.iter().map(Rectangle::bounds));
    let is_covered = |own: usize, edge: &Edge| {
        let middle = nalgebra::center(&edge.from, &edge.to);
        let may_cover = |area: &Rectangle| area.distance_m(&middle) == 0.0;
        tree.first_below(boxes.len(), may_cover, |other| other != own && covers(&sides[other], edge))
            .is_some()
    };
    let all = sides.iter().enumerate().flat_map(|(own, edges)| edges.iter().map(move |edge| (own, edge)));
    merged(all.filter(|(own, edge)| !is_covered(*own, edge)).map(|(_, edge)| *edge).collect())
}

/// Whether an edge and the space directly outside of the edge lie in the rectangle with the given sides: a ray
/// then hits the rectangle first.
fn covers(sides: &[Edge; 4], edge: &Edge) -> bool {
    let contains = |point: Point2<f64>| sides.iter().all(|side| side.gap_m(&point) <= ON_M);
    let beside = edge.normal * BESIDE_M;
    contains(edge.from) && contains(edge.to) && contains(edge.from + beside) && contains(edge.to + beside)
}

/// Merges edges that lie on one line, face the same side, and touch or overlap.
fn merged(edges: Vec<Edge>) -> Vec<Edge> {
    // Edges on one line get one key. Rounding may separate some edges, which then stay as they are.
    let key = |edge: &Edge| {
        let offset_m = edge.normal.dot(&edge.from.coords);
        [edge.normal.x, edge.normal.y, offset_m].map(|value| (value / (8.0 * ON_M)).round() as i64)
    };
    let start_m = |edge: &Edge, line: &Edge| along(line).dot(&edge.from.coords);
    let end_m = |edge: &Edge, line: &Edge| along(line).dot(&edge.to.coords);
    // All edges of one key are ordered along the key's own direction: directions of edges differ by rounding, and
    // to compare along one of the two would not be a total order.
    let position = |[x, y, _]: [i64; 3], edge: &Edge| x as f64 * edge.from.y - y as f64 * edge.from.x;
    let mut keyed: Vec<([i64; 3], Edge)> = edges.iter().map(|edge| (key(edge), *edge)).collect();
    keyed.sort_by(|(a_key, a), (b_key, b)| {
        a_key.cmp(b_key).then_with(|| position(*a_key, a).total_cmp(&position(*b_key, b)))
    });
    let mut merged: Vec<([i64; 3], Edge)> = Vec::new();
    for (key, edge) in keyed {
        match merged.last_mut() {
            Some((last_key, last))
                if *last_key == key && start_m(&edge, last) <= end_m(last, last) + ON_M =>
            {
                if end_m(&edge, last) > end_m(last, last) {
                    *last = Edge::new(last.from, edge.to);
                }
            }
            _ => merged.push((key, edge)),
        }
    }
    merged.into_iter().map(|(_, edge)| edge).collect()
}

/// The direction of an edge, with the solid on the left.
fn along(edge: &Edge) -> Vector2<f64> {
    Vector2::new(-edge.normal.y, edge.normal.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::shape::point_segment_m;
    use nalgebra::Isometry2;
    use proptest::prelude::*;

    fn between(min: [f64; 2], max: [f64; 2]) -> Rectangle {
        Rectangle::between(min.into(), max.into())
    }

    #[test]
    fn edges_inside_of_walls_are_left_out_and_edges_on_one_line_merge() {
        // Two walls end to end, a third that ends at their side: an upside-down T.
        let boxes = [
            between([0.0, 0.0], [2.0, 0.1]),
            between([2.0, 0.0], [5.0, 0.1]),
            between([1.0, 0.1], [1.1, 3.0]),
        ];
        let edges = visible_edges(&boxes);
        // Bottom and top (each one edge of 5 m), two ends, and three sides of the standing wall.
        assert_eq!(edges.len(), 7, "{edges:#?}");
        let long = edges.iter().filter(|edge| ((edge.to - edge.from).norm() - 5.0).abs() < 1e-12);
        assert_eq!(long.count(), 2);
    }

    #[test]
    fn flush_sides_are_seen() {
        // The small box stands in the large one, on its border.
        let boxes = [between([0.0, 0.0], [3.0, 3.0]), between([1.0, 0.0], [2.0, 1.0])];
        assert_eq!(visible_edges(&boxes), visible_edges(&boxes[..1]));
    }

    #[test]
    fn apart_and_turned_boxes_keep_their_sides() {
        let turned = Rectangle::around(Point2::new(1.0, 1.0), Vector2::new(1.0, 0.3), 0.4);
        assert_eq!(visible_edges(&[turned, between([4.0, 0.0], [5.0, 1.0])]).len(), 8);
        // The same box twice: each would hide the other if covers were not about what lies outside.
        assert_eq!(visible_edges(&[turned, turned]).len(), 4);
    }

    /// Whether a point is on one of the edges.
    fn is_on(edges: &[Edge], point: &Point2<f64>) -> bool {
        edges.iter().any(|edge| point_segment_m(point, &edge.from, &edge.to) < 1e-6)
    }

    proptest! {
        /// Boxes with common corners, turned: their sides lie on lines that rounding separates.
        #[test]
        fn the_outline_is_the_same_at_any_angle(
            turn_rad in -4.0f64..4.0,
            sizes in prop::collection::vec((0u8..4, 0u8..4, 1u8..60, 1u8..60), 25..60),
        ) {
            let upright: Vec<Rectangle> = sizes
                .iter()
                .map(|&(x, y, width, height)| {
                    let low = [f64::from(x) + 2.0, f64::from(y) + 2.0];
                    between(low, [low[0] + 0.037 * f64::from(width), low[1] + 0.011 * f64::from(height)])
                })
                .collect();
            let turn = Isometry2::rotation(turn_rad);
            let turned: Vec<Rectangle> =
                upright.iter().map(|shape| Rectangle { pose: turn * shape.pose, ..*shape }).collect();
            let (before, after) = (visible_edges(&upright), visible_edges(&turned));
            for edge in &before {
                prop_assert!(is_on(&after, &(turn * nalgebra::center(&edge.from, &edge.to))), "{:?}", edge);
            }
            for edge in &after {
                prop_assert!(is_on(&before, &(turn.inverse() * nalgebra::center(&edge.from, &edge.to))), "{:?}", edge);
            }
        }
    }
}
