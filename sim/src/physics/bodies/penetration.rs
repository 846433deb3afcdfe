//! Resolves penetration that the contact solver leaves.
//!
//! rapier detects contacts at the begin of a step and approximates velocities that keep the bodies apart.
//! Where heavy bodies press light ones together, or where corners turn, that is not enough. Bodies that
//! penetrate each other are then shifted apart, each to the side where it was before the step. Where there is no
//! room to shift, they do a part of their step or none of it. They did not penetrate each other before the step, so
//! the method terminates.
//!
//! A small or thin body may pass through another one within a step. So a step counts as a straight path, of which
//! as many poses are looked at as it takes to find the bodies in each other on the way.

use super::{Bodies, Free, MAX_MOVER_M, from_rapier};
use crate::physics::form::Form;
use nalgebra::{Point2, Vector2};
use rapier2d::parry::query::contact;
use rapier2d::prelude::{self as rapier, RigidBodyHandle};
use std::collections::{BTreeMap, BTreeSet};

/// The allowed penetration, m. A deeper penetration is reduced to half of this value.
const DEPTH_M: f64 = 0.005;
/// A penetration that is allowed for the thinnest bodies as well, m.
const SHALLOW_M: f64 = 0.0002;
/// The largest number of rounds of shifting.
const ROUNDS: usize = 16;
/// In this number of first rounds, bodies are shifted in proportion to the inverse of their mass. A light body
/// between two heavy bodies would move back and forth for hundreds of rounds; in later rounds both bodies are
/// therefore shifted by the same distance.
const WEIGHTED_ROUNDS: usize = 4;
/// The shares of its step that a body keeps, tried in this order until there is room.
const SHARES: [f32; 4] = [0.5, 0.25, 0.125, 0.0];
/// The largest number of poses on a path that are looked at.
const MAX_POSES: f64 = 1000.0;
/// A distance that no two bodies exceed, m.
const ANY_DISTANCE_M: f32 = 1e6;

/// Two colliders that may touch.
type Pair = [rapier::ColliderHandle; 2];
/// Values for bodies, by the raw parts of their handles.
type PerBody<T> = BTreeMap<(u32, u32), T>;

/// A step with penetration.
struct Step {
    /// The free bodies, with their poses before the step.
    free: PerBody<Free>,
    /// The bodies that were shifted or put back: the pose without being put back, and how often the body was
    /// put back.
    changed: PerBody<(rapier::Pose, usize)>,
    /// The pairs that may penetrate each other, and the same by the raw parts of their handles.
    pairs: Vec<Pair>,
    known: BTreeSet<[(u32, u32); 2]>,
}

impl Step {
    fn add(&mut self, pair: Pair) {
        let mut key = pair.map(|collider| collider.into_raw_parts());
        key.sort_unstable();
        if self.known.insert(key) {
            self.pairs.push(pair);
        }
    }
}

impl Bodies {
    /// Separates all bodies that penetrate each other by more than allowed, or passed through each other, in a
    /// step.
    pub(super) fn resolve_penetration(&mut self) {
        let quick: Vec<RigidBodyHandle> = self
            .free
            .iter()
            .filter(|free| self.motion_m(free) > free.reach_m)
            .map(|free| free.body)
            .collect();
        let is_deep = |pair| self.may_touch(pair) && self.is_too_deep(pair, self.gap_m(pair));
        if quick.is_empty() && !self.touching().any(is_deep) {
            return;
        }
        let free = self.free.iter().map(|free| (free.body.into_raw_parts(), *free)).collect();
        let mut step = Step { free, changed: BTreeMap::new(), pairs: Vec::new(), known: BTreeSet::new() };
        self.touching().for_each(|pair| step.add(pair));
        self.add_near(&quick, &mut step);
        let mut deep = self.violating(&step);
        for round in 0..ROUNDS {
            let mut shifted = Vec::new();
            for (pair, _) in &deep {
                shifted.extend(self.shift_apart(*pair, round < WEIGHTED_ROUNDS, &mut step));
            }
            self.add_near(&shifted, &mut step);
            deep = self.violating(&step);
            if deep.is_empty() {
                break;
            }
        }
        loop {
            let is_put_back = deep.iter().fold(false, |any, (pair, gap_m)| {
                let is_deeper = self.gap_on_path_m(*pair, 0.0, &step) > *gap_m;
                any | (is_deeper && pair.map(|collider| self.put_back(collider, &mut step)).contains(&true))
            });
            if !is_put_back {
                return self.slow_down(&step);
            }
            deep = self.violating(&step);
        }
    }

    /// The longest motion of a point of a body in the step, m, at most.
    fn motion_m(&self, free: &Free) -> f64 {
        let body = &self.world.bodies[free.body];
        let turned_rad = free.before.rotation.angle_between(&body.position().rotation).abs();
        let moved_m = (body.position().translation - free.before.translation).length();
        f64::from(moved_m + turned_rad * free.radius_m)
    }

    /// All pairs of bodies that rapier found near to each other. Not only those that rapier found touching: rapier
    /// misses some polygons side by side.
    fn touching(&self) -> impl Iterator<Item = Pair> {
        self.world.narrow_phase.contact_pairs().map(|pair| [pair.collider1, pair.collider2])
    }

    /// Adds all pairs with bodies that moved farther than contacts were predicted for.
    fn add_near(&self, bodies: &[RigidBodyHandle], step: &mut Step) {
        if bodies.is_empty() {
            return;
        }
        let world = &self.world;
        let query = world.broad_phase.as_query_pipeline(
            world.narrow_phase.query_dispatcher(),
            &world.bodies,
            &world.colliders,
            rapier::QueryFilter::default(),
        );
        // The query knows where the others were before the step.
        let motions_m = self.free.iter().map(|free| self.motion_m(free));
        let farthest_m = motions_m.fold(MAX_MOVER_M, f64::max) as f32;
        for body in bodies {
            let Some(own) = world.bodies[*body].colliders().first() else { continue };
            let shape = world.colliders[*own].shape();
            let now = shape.compute_aabb(world.bodies[*body].position());
            let before = shape.compute_aabb(&step.free[&body.into_raw_parts()].before);
            let around = rapier::BoundingVolume::merged(&now, &before);
            let around = rapier::BoundingVolume::loosened(&around, farthest_m);
            let others = query.intersect_aabb_conservative(around).map(|(other, _)| other);
            let mut others: Vec<_> = others.filter(|other| other != own).collect();
            others.sort_unstable_by_key(|other| other.into_raw_parts());
            others.into_iter().for_each(|other| step.add([*own, other]));
        }
    }

    /// All pairs of bodies that penetrate each other by more than allowed somewhere on their path, with the least gap
    /// between them, m.
    fn violating(&self, step: &Step) -> Vec<(Pair, f64)> {
        let gaps = step.pairs.iter().map(|pair| (*pair, self.least_gap_m(*pair, step)));
        gaps.filter(|(pair, gap_m)| self.is_too_deep(*pair, *gap_m)).collect()
    }

    /// Whether the upright boxes around two bodies overlap: most bodies that rapier found near to each other are apart.
    fn may_touch(&self, pair: Pair) -> bool {
        let [a, b] = pair.map(|collider| self.world.colliders[collider].compute_aabb());
        rapier::BoundingVolume::intersects(&a, &b)
    }

    fn is_too_deep(&self, pair: Pair, gap_m: f64) -> bool {
        gap_m < -SHALLOW_M && gap_m < -self.allowed_m(pair)
    }

    /// The penetration that is allowed between two bodies, m: so little that it shows from which side they met.
    fn allowed_m(&self, pair: Pair) -> f64 {
        DEPTH_M.min(self.inner_m(pair) / 2.0)
    }

    /// The larger one of the radii of the circles within two bodies, m.
    fn inner_m(&self, pair: Pair) -> f64 {
        let inner_m = |collider| self.form(collider, &rapier::Pose::IDENTITY).inner_m();
        pair.map(inner_m).into_iter().fold(0.0, f64::max)
    }

    /// The least gap between two bodies on their path, m.
    fn least_gap_m(&self, pair: Pair, step: &Step) -> f64 {
        let motions_m =
            pair.map(|collider| self.free(collider, step).map_or(0.0, |free| self.motion_m(free)));
        let all_m = motions_m[0] + motions_m[1];
        // No pose between is skipped in which the bodies are too deep in each other: see `allowed_m`.
        let poses =
            if all_m == 0.0 { 1.0 } else { (all_m / self.inner_m(pair)).ceil().clamp(1.0, MAX_POSES) };
        let gaps_m = (1..=poses as usize).map(|pose| self.gap_on_path_m(pair, pose as f64 / poses, step));
        gaps_m.fold(f64::INFINITY, f64::min)
    }

    /// The gap between two bodies now, m.
    fn gap_m(&self, pair: Pair) -> f64 {
        let [a, b] = pair.map(|collider| self.form(collider, self.world.colliders[collider].position()));
        a.apart_m(&b)
    }

    /// The gap between two bodies at a share of the step, m.
    fn gap_on_path_m(&self, pair: Pair, share: f64, step: &Step) -> f64 {
        let [a, b] = pair.map(|collider| self.form(collider, &self.pose_at(collider, share, step)));
        a.apart_m(&b)
    }

    /// The pose of a body at a share of the step.
    fn pose_at(&self, collider: rapier::ColliderHandle, share: f64, step: &Step) -> rapier::Pose {
        let position = self.world.colliders[collider].position();
        match self.free(collider, step) {
            Some(Free { before, .. }) if share < 1.0 => before.lerp(position, share as f32),
            _ => *position,
        }
    }

    /// The free body of a collider; none for walls and for obstacles that contacts do not move.
    fn free<'a>(&self, collider: rapier::ColliderHandle, step: &'a Step) -> Option<&'a Free> {
        step.free.get(&self.world.colliders[collider].parent()?.into_raw_parts())
    }

    /// The outline of a body at a pose.
    fn form(&self, collider: rapier::ColliderHandle, pose: &rapier::Pose) -> Form {
        let shape = self.world.colliders[collider].shape();
        let corners = match (shape.as_cuboid(), shape.as_convex_polygon()) {
            (Some(rectangle), _) => rectangle.to_polyline(),
            (_, Some(polygon)) => polygon.points().to_vec(),
            _ => Vec::new(),
        };
        let corners: Vec<_> =
            corners.iter().map(|corner| Point2::new(f64::from(corner.x), f64::from(corner.y))).collect();
        let radius_m = shape.as_ball().map_or(0.0, |disc| f64::from(disc.radius));
        Form::new(&corners, radius_m, &from_rapier(pose))
    }

    /// Shifts two bodies apart, and returns those that were shifted.
    fn shift_apart(&mut self, pair: Pair, is_weighted: bool, step: &mut Step) -> Vec<RigidBodyHandle> {
        let Some((normal, depth_m)) = self.way_out(pair, step) else { return Vec::new() };
        let short_m = (depth_m - self.allowed_m(pair) / 2.0) as f32;
        let bodies = pair.map(|collider| self.world.colliders[collider].parent());
        let yields = bodies.map(|body| {
            let body = body.map(|body| &self.world.bodies[body]).filter(|body| body.is_dynamic());
            body.map_or(0.0, |body| if is_weighted { 1.0 / body.mass() } else { 1.0 })
        });
        let all = yields[0] + yields[1];
        if short_m <= 0.0 || all <= 0.0 {
            return Vec::new();
        }
        let mut shifted = Vec::new();
        for ((body, own), side) in bodies.into_iter().zip(yields).zip([-1.0, 1.0]) {
            if let Some(body) = body.filter(|_| own > 0.0) {
                let mut pose = *self.world.bodies[body].position();
                pose.translation += normal * (side * short_m * own / all);
                self.place(body, pose);
                step.changed.insert(body.into_raw_parts(), (pose, 0));
                shifted.push(body);
            }
        }
        shifted
    }

    /// The direction from the first body to the second in which they are to be separated, and how deep they are in each
    /// other along it, m: the shortest way out, unless it ends on the other side than before the step.
    fn way_out(&self, pair: Pair, step: &Step) -> Option<(rapier::Vector, f64)> {
        let [a, b] = pair.map(|collider| &self.world.colliders[collider]);
        let [was_a, was_b] = pair.map(|collider| self.pose_at(collider, 0.0, step));
        let was = contact(&was_a, a.shape(), &was_b, b.shape(), ANY_DISTANCE_M).ok()??;
        let now = contact(a.position(), a.shape(), b.position(), b.shape(), 0.0).ok()?;
        if let Some(now) = now.filter(|now| now.normal1.dot(was.normal1) > 0.0) {
            return Some((now.normal1, f64::from(-now.dist)));
        }
        let normal = Vector2::new(f64::from(was.normal1.x), f64::from(was.normal1.y));
        let [from, to] = pair.map(|collider| self.form(collider, self.world.colliders[collider].position()));
        Some((was.normal1, from.extent_m(&normal) + to.extent_m(&-normal)))
    }

    /// Reverts another part of the step of a free body. Returns whether a part was left.
    fn put_back(&mut self, collider: rapier::ColliderHandle, step: &mut Step) -> bool {
        let Some(&Free { body, before, .. }) = self.free(collider, step) else { return false };
        let now = *self.world.bodies[body].position();
        let (reached, times) = step.changed.entry(body.into_raw_parts()).or_insert((now, 0));
        let Some(share) = SHARES.get(*times) else { return false };
        *times += 1;
        let pose = if *share > 0.0 { before.lerp(reached, *share) } else { before };
        self.place(body, pose);
        true
    }

    fn place(&mut self, body: RigidBodyHandle, pose: rapier::Pose) {
        self.world.bodies[body].set_position(pose, true);
        self.world.bodies.propagate_modified_body_positions_to_colliders(&mut self.world.colliders);
    }

    /// Reduces the velocity of every changed body that moved less than its velocity implies to the velocity of its
    /// real motion, so that the body does not continue as if nothing had been in its way.
    fn slow_down(&mut self, step: &Step) {
        let dt = self.world.integration_parameters.dt;
        for key in step.changed.keys() {
            let Free { body, before, .. } = step.free[key];
            let body = &mut self.world.bodies[body];
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
