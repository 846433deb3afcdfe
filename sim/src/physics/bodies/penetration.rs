//! Resolves penetration that the contact solver leaves.
//!
//! rapier detects contacts at the beginning of a step and approximates velocities that keep the bodies apart. This
//! is not enough if heavy bodies press light bodies together, or if corners turn. Bodies that penetrate each other
//! are then shifted apart. If there is no room to shift them, they move by only a part of their step, or not at
//! all. They did not penetrate each other before the step, so that the method terminates.

use super::{Bodies, from_rapier};
use crate::physics::form::Form;
use nalgebra::Point2;
use rapier2d::parry::query::contact;
use rapier2d::prelude as rapier;
use std::collections::BTreeMap;

/// The allowed penetration, m. A deeper penetration is reduced to half of this value.
const DEPTH_M: f64 = 0.005;
/// The largest number of rounds of shifting.
const ROUNDS: usize = 16;
/// In this number of first rounds, bodies are shifted in proportion to the inverse of their mass. A light body
/// between two heavy bodies would move back and forth for hundreds of rounds; in later rounds both bodies are
/// therefore shifted by the same distance.
const WEIGHTED_ROUNDS: usize = 4;
/// The shares of its step that a body keeps, tried in this order until there is room.
const SHARES: [f32; 4] = [0.5, 0.25, 0.125, 0.0];

/// Two colliders that may touch.
type Pair = [rapier::ColliderHandle; 2];
/// Values for bodies, by the raw parts of their handles.
type PerBody<T> = BTreeMap<(u32, u32), T>;

/// The poses in a step with penetration.
struct Step {
    /// The poses of free bodies before the step.
    before: PerBody<rapier::Pose>,
    /// The bodies that were shifted or put back: the pose without being put back, and how often the body was
    /// put back.
    changed: PerBody<(rapier::Pose, usize)>,
}

impl Bodies {
    /// Separates all bodies that penetrate each other by more than allowed, after a step.
    pub(super) fn resolve_penetration(&mut self) {
        let mut deep = self.penetrating();
        if deep.is_empty() {
            return;
        }
        let before = self.free.iter().map(|(body, before)| (body.into_raw_parts(), *before)).collect();
        let mut step = Step { before, changed: BTreeMap::new() };
        for round in 0..ROUNDS {
            for (pair, _) in &deep {
                self.shift_apart(*pair, round < WEIGHTED_ROUNDS, &mut step);
            }
            deep = self.penetrating();
            if deep.is_empty() {
                break;
            }
        }
        loop {
            let is_put_back = deep.iter().fold(false, |any, (pair, gap_m)| {
                let is_deeper = self.gap_m(*pair, Some(&step.before)) > *gap_m;
                any | (is_deeper && pair.map(|collider| self.put_back(collider, &mut step)).contains(&true))
            });
            if !is_put_back {
                return self.slow_down(&step);
            }
            deep = self.penetrating();
        }
    }

    /// All pairs of bodies that penetrate each other by more than allowed, with the gap between them, m. Not
    /// only the pairs that rapier found touching: rapier misses some polygons side by side.
    fn penetrating(&self) -> Vec<(Pair, f64)> {
        let pairs = self.world.narrow_phase.contact_pairs().map(|pair| [pair.collider1, pair.collider2]);
        pairs.map(|pair| (pair, self.gap_m(pair, None))).filter(|(_, gap_m)| *gap_m < -DEPTH_M).collect()
    }

    /// The gap between two bodies, m, now or at the poses `before`.
    fn gap_m(&self, pair: Pair, before: Option<&PerBody<rapier::Pose>>) -> f64 {
        let [a, b] = pair.map(|collider| self.form(collider, before));
        a.apart_m(&b)
    }

    fn form(&self, collider: rapier::ColliderHandle, before: Option<&PerBody<rapier::Pose>>) -> Form {
        let collider = &self.world.colliders[collider];
        let before =
            collider.parent().zip(before).and_then(|(body, before)| before.get(&body.into_raw_parts()));
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

    /// Shifts two bodies apart along the normal of their contact.
    fn shift_apart(&mut self, pair: Pair, is_weighted: bool, step: &mut Step) {
        let [a, b] = pair.map(|collider| &self.world.colliders[collider]);
        let Ok(Some(contact)) = contact(a.position(), a.shape(), b.position(), b.shape(), 0.0) else {
            return;
        };
        let short_m = -contact.dist - 0.5 * DEPTH_M as f32;
        let bodies = [a, b].map(|collider| collider.parent());
        let yields = bodies.map(|body| {
            let body = body.map(|body| &self.world.bodies[body]).filter(|body| body.is_dynamic());
            body.map_or(0.0, |body| if is_weighted { 1.0 / body.mass() } else { 1.0 })
        });
        let all = yields[0] + yields[1];
        if short_m <= 0.0 || all <= 0.0 {
            return;
        }
        for ((body, own), side) in bodies.into_iter().zip(yields).zip([-1.0, 1.0]) {
            if let Some(body) = body.filter(|_| own > 0.0) {
                let mut pose = *self.world.bodies[body].position();
                pose.translation += contact.normal1 * (side * short_m * own / all);
                self.place(body, pose);
                step.changed.insert(body.into_raw_parts(), (pose, 0));
            }
        }
    }

    /// Reverts another part of the step of a free body. Returns whether a part was left.
    fn put_back(&mut self, collider: rapier::ColliderHandle, step: &mut Step) -> bool {
        let Some(body) = self.world.colliders[collider].parent() else { return false };
        let Some(before) = step.before.get(&body.into_raw_parts()) else { return false };
        let now = *self.world.bodies[body].position();
        let (reached, times) = step.changed.entry(body.into_raw_parts()).or_insert((now, 0));
        let Some(share) = SHARES.get(*times) else { return false };
        *times += 1;
        let pose = if *share > 0.0 { before.lerp(reached, *share) } else { *before };
        self.place(body, pose);
        true
    }

    fn place(&mut self, body: rapier::RigidBodyHandle, pose: rapier::Pose) {
        self.world.bodies[body].set_position(pose, true);
        self.world.bodies.propagate_modified_body_positions_to_colliders(&mut self.world.colliders);
    }

    /// Reduces the velocity of every changed body that moved less than its velocity implies to the velocity of its
    /// real motion, so that the body does not continue as if nothing had been in its way.
    fn slow_down(&mut self, step: &Step) {
        let dt = self.world.integration_parameters.dt;
        for &(index, generation) in step.changed.keys() {
            let before = &step.before[&(index, generation)];
            let body = &mut self.world.bodies[rapier::RigidBodyHandle::from_raw_parts(index, generation)];
            let (speed, turn_rate) = (body.linvel().length(), body.angvel().abs());
            let moved = (body.position().translation - before.translation).length() / dt;
            let turned = before.rotation.angle_between(&body.position().rotation).abs() / dt;
            if speed > moved {
                body.set_linvel(body.linvel() * (moved / speed), true);
            }
            if turn_rate > turned {
                body.set_angvel(body.angvel() * (turned / turn_rate), true);
            }
        }
    }
}
