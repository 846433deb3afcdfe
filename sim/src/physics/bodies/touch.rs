use super::{Bodies, unpack};
use crate::physics::report::Body;
use nalgebra::Point2;
use rapier2d::prelude as rapier;

/// Bodies farther apart than this no longer touch, m. A contact that rapier keeps open flickers by
/// less.
const PART_M: f32 = 0.001;

/// What a robot touches.
pub(in crate::physics) struct Touch {
    pub(in crate::physics) with: Body,
    /// Where they are deepest in each other, m.
    pub(in crate::physics) at: Point2<f64>,
    /// The ends of the stretch along which they touch, m.
    pub(in crate::physics) ends: [Point2<f64>; 2],
    /// The impulse of the last step, N·s; 0: they have not yet parted.
    pub(in crate::physics) impulse_ns: f64,
}

impl Bodies {
    /// Everything that a robot presses against, or has not yet parted from.
    pub(in crate::physics) fn touches(&self, robot: usize) -> impl Iterator<Item = Touch> {
        let own = self.robots[robot].collider;
        self.world.narrow_phase.contact_pairs_with(own).filter_map(move |pair| {
            let (manifold, deepest) = pair.find_deepest_contact()?;
            let impulse_ns = f64::from(pair.total_impulse_magnitude());
            if impulse_ns <= 0.0 && deepest.dist >= PART_M {
                return None;
            }
            let place = self.world.colliders[pair.collider1].position();
            let at = |contact: &rapier::TrackedContact<_>| {
                let at = place.transform_point(contact.local_p1);
                Point2::new(f64::from(at.x), f64::from(at.y))
            };
            let mut touching = manifold.points.iter().filter(|contact| contact.dist < PART_M);
            let first = touching.next().unwrap_or(deepest);
            let ends = [first, touching.next_back().unwrap_or(first)].map(at);
            let other = if pair.collider1 == own { pair.collider2 } else { pair.collider1 };
            let with = unpack(self.world.colliders[other].user_data);
            Some(Touch { with, at: at(deepest), ends, impulse_ns })
        })
    }
}
