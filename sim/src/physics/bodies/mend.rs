//! What the contacts' solver lets into each other is parted, or held.
//!
//! rapier sees where bodies touch when a step begins, and finds velocities that keep them apart by a
//! few rounds of approximation. Where things many times heavier press light ones against each other,
//! or where corners turn, that is not enough. Such bodies are shifted apart; where there is no room
//! for that, they do only a part of their step, or none of it. When it began they were not in each other,
//! so this always comes to a good end.

use super::{Bodies, from_rapier};
use crate::physics::form::Form;
use nalgebra::Point2;
use rapier2d::parry::query::contact;
use rapier2d::prelude as rapier;
use std::collections::BTreeMap;

/// Bodies may be as deep in each other as this, m; they are parted to half of it.
const DEPTH_M: f64 = 0.005;
/// The most rounds of shifting.
const ROUNDS: usize = 16;
/// In so many of them the lighter one gives way. What is caught between two heavy ones would go to and
/// fro for hundreds of rounds; so after these both give way alike.
const WEIGHED_ROUNDS: usize = 4;
/// What a body keeps of its step, one after the other, as long as there is no room for more.
const SHARES: [f32; 4] = [0.5, 0.25, 0.125, 0.0];

/// Two colliders that may touch.
type Pair = [rapier::ColliderHandle; 2];
/// Something about bodies, by the raw parts of their handles.
type Of<T> = BTreeMap<(u32, u32), T>;

/// What is known in a step that has to be mended.
struct Step {
    /// Where free bodies were when it began.
    was: Of<rapier::Pose>,
    /// Those that were shifted or put back: where they would be without being put back, and how often
    /// they were.
    changed: Of<(rapier::Pose, usize)>,
}

impl Bodies {
    /// Parts all bodies that are deeper in each other than they may be, after a step.
    pub(super) fn mend(&mut self) {
        let mut deep = self.deep();
        if deep.is_empty() {
            return;
        }
        let was = self.free.iter().map(|(body, was)| (body.into_raw_parts(), *was)).collect();
        let mut step = Step { was, changed: BTreeMap::new() };
        for round in 0..ROUNDS {
            for (pair, _) in &deep {
                self.shift_apart(*pair, round < WEIGHED_ROUNDS, &mut step);
            }
            deep = self.deep();
            if deep.is_empty() {
                break;
            }
        }
        loop {
            let is_put_back = deep.iter().fold(false, |any, (pair, gap_m)| {
                let is_deeper = self.gap_m(*pair, Some(&step.was)) > *gap_m;
                any | (is_deeper && pair.map(|collider| self.put_back(collider, &mut step)).contains(&true))
            });
            if !is_put_back {
                return self.slow_down(&step);
            }
            deep = self.deep();
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
    fn gap_m(&self, pair: Pair, was: Option<&Of<rapier::Pose>>) -> f64 {
        let [a, b] = pair.map(|collider| self.form(collider, was));
        a.apart_m(&b)
    }

    fn form(&self, collider: rapier::ColliderHandle, was: Option<&Of<rapier::Pose>>) -> Form {
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

    /// Shifts two bodies apart, straight out of each other.
    fn shift_apart(&mut self, pair: Pair, is_weighed: bool, step: &mut Step) {
        let [a, b] = pair.map(|collider| &self.world.colliders[collider]);
        let Ok(Some(contact)) = contact(a.position(), a.shape(), b.position(), b.shape(), 0.0) else {
            return;
        };
        let short_m = -contact.dist - 0.5 * DEPTH_M as f32;
        let bodies = [a, b].map(|collider| collider.parent());
        let yields = bodies.map(|body| {
            let body = body.map(|body| &self.world.bodies[body]).filter(|body| body.is_dynamic());
            body.map_or(0.0, |body| if is_weighed { 1.0 / body.mass() } else { 1.0 })
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

    /// Takes from a free body another part of its step; says whether there was any left.
    fn put_back(&mut self, collider: rapier::ColliderHandle, step: &mut Step) -> bool {
        let Some(body) = self.world.colliders[collider].parent() else { return false };
        let Some(was) = step.was.get(&body.into_raw_parts()) else { return false };
        let now = *self.world.bodies[body].position();
        let (reached, times) = step.changed.entry(body.into_raw_parts()).or_insert((now, 0));
        let Some(share) = SHARES.get(*times) else { return false };
        *times += 1;
        let pose = if *share > 0.0 { was.lerp(reached, *share) } else { *was };
        self.place(body, pose);
        true
    }

    fn place(&mut self, body: rapier::RigidBodyHandle, pose: rapier::Pose) {
        self.world.bodies[body].set_position(pose, true);
        self.world.bodies.propagate_modified_body_positions_to_colliders(&mut self.world.colliders);
    }

    /// What has come less far than its velocity says is as slow as it was: it neither gains by it nor goes
    /// on as if nothing had been in its way.
    fn slow_down(&mut self, step: &Step) {
        let dt = self.world.integration_parameters.dt;
        for &(index, generation) in step.changed.keys() {
            let was = &step.was[&(index, generation)];
            let body = &mut self.world.bodies[rapier::RigidBodyHandle::from_raw_parts(index, generation)];
            let (speed, spin) = (body.linvel().length(), body.angvel().abs());
            let gone = (body.position().translation - was.translation).length() / dt;
            let turned = was.rotation.angle_between(&body.position().rotation).abs() / dt;
            if speed > gone {
                body.set_linvel(body.linvel() * (gone / speed), true);
            }
            if spin > turned {
                body.set_angvel(body.angvel() * (turned / spin), true);
            }
        }
    }
}
