//! What the contacts' solver lets into each other is held.
//!
//! rapier sees where bodies touch when a step begins, and finds velocities that keep them apart by a
//! few rounds of approximation. Where things many times heavier press light ones against each other,
//! or where corners turn, that is not enough. Such bodies stay where they were, at rest. There they
//! were not in each other, so this always comes to a good end: at worst, with all where they were.

use super::{Bodies, from_rapier};
use crate::physics::form::Form;
use nalgebra::Point2;
use rapier2d::prelude as rapier;
use std::collections::BTreeMap;

/// Bodies may be as deep in each other as this, m.
const DEPTH_M: f64 = 0.005;

/// Two colliders that may touch.
type Pair = [rapier::ColliderHandle; 2];
/// Where free bodies were when the step began, by the raw parts of their handles.
type Was = BTreeMap<(u32, u32), rapier::Pose>;

impl Bodies {
    /// Puts back those bodies that are deeper in each other than they may be, and deeper than they
    /// were; and then whatever came to where these are now.
    pub(super) fn hold(&mut self) {
        let mut was = None;
        loop {
            let deep = self.deep();
            if deep.is_empty() {
                return;
            }
            let was: &Was = was.get_or_insert_with(|| {
                self.free.iter().map(|(body, was)| (body.into_raw_parts(), *was)).collect()
            });
            let mut is_held = false;
            for (pair, gap_m) in deep {
                if self.gap_m(pair, Some(was)) > gap_m {
                    is_held |= pair.map(|collider| self.put_back(collider, was)).contains(&true);
                }
            }
            if !is_held {
                return;
            }
            self.world.bodies.propagate_modified_body_positions_to_colliders(&mut self.world.colliders);
        }
    }

    /// All that are deeper in each other than they may be, with the gap between them, m.
    ///
    /// Not only of those that rapier found touching: of polygons side by side it misses some.
    fn deep(&self) -> Vec<(Pair, f64)> {
        let pairs = self.world.narrow_phase.contact_pairs().map(|pair| [pair.collider1, pair.collider2]);
        pairs.map(|pair| (pair, self.gap_m(pair, None))).filter(|(_, gap_m)| *gap_m < -DEPTH_M).collect()
    }

    /// How far two bodies are apart, m, now or where they `was`.
    fn gap_m(&self, pair: Pair, was: Option<&Was>) -> f64 {
        let [a, b] = pair.map(|collider| self.form(collider, was));
        a.apart_m(&b)
    }

    fn form(&self, collider: rapier::ColliderHandle, was: Option<&Was>) -> Form {
        let collider = &self.world.colliders[collider];
        let before = collider.parent().zip(was).and_then(|(body, was)| was.get(&body.into_raw_parts()));
        let shape = collider.shape();
        let corners = match (shape.as_cuboid(), shape.as_convex_polygon()) {
            (Some(rectangle), _) => rectangle.to_polyline(),
            (_, Some(polygon)) => polygon.points().to_vec(),
            _ => Vec::new(),
        };
        let corners: Vec<_> =
            corners.iter().map(|corner| Point2::new(f64::from(corner.x), f64::from(corner.y))).collect();
        let radius_m = shape.as_ball().map_or(0.0, |disc| f64::from(disc.radius));
        Form::new(&corners, radius_m, &from_rapier(before.unwrap_or(collider.position())))
    }

    /// Puts a collider's body back, at rest, if it is free and not back yet; says whether it was.
    fn put_back(&mut self, collider: rapier::ColliderHandle, was: &Was) -> bool {
        let body = self.world.colliders[collider].parent();
        let Some((body, was)) = body.and_then(|body| Some((body, was.get(&body.into_raw_parts())?))) else {
            return false;
        };
        let body = &mut self.world.bodies[body];
        let is_away = body.position() != was;
        if is_away {
            body.set_position(*was, true);
            body.set_linvel(rapier::Vector::ZERO, true);
            body.set_angvel(0.0, true);
        }
        is_away
    }
}
