use super::{Bodies, unpack};
use crate::physics::report::Body;
use nalgebra::{Point2, Vector2};
use rapier2d::prelude as rapier;

/// Bodies that are farther apart than this do not touch any more, m. The distance of a lasting contact varies by
/// less.
pub(crate) const SEPARATE_M: f32 = 0.001;

/// A contact of a robot.
#[derive(Clone, Copy)]
pub(crate) struct Touch {
    pub(crate) with: Body,
    /// The point of the deepest penetration, m.
    pub(crate) at: Point2<f64>,
    /// The direction from the robot to the other body at the contact, a unit vector.
    pub(crate) towards: Vector2<f64>,
    /// The ends of the line of contact, m.
    pub(crate) ends: [Point2<f64>; 2],
    /// The impulse of the last step, N·s; 0: the bodies have not separated yet.
    pub(crate) impulse_ns: f64,
}

impl Bodies {
    /// All bodies that a robot presses against, or has not separated from yet.
    pub(crate) fn touches(&self, robot: usize) -> impl Iterator<Item = Touch> {
        let slid = self.slid.iter().flatten().filter(move |(of, _)| *of == robot).map(|(_, touch)| *touch);
        let solved = self.slid.is_none().then(|| self.solved_touches(robot));
        slid.chain(solved.into_iter().flatten())
    }

    fn solved_touches(&self, robot: usize) -> impl Iterator<Item = Touch> {
        let own = self.robots[robot].collider;
        self.world.narrow_phase.contact_pairs_with(own).filter_map(move |pair| {
            let (manifold, deepest) = pair.find_deepest_contact()?;
            let impulse_ns = f64::from(pair.total_impulse_magnitude());
            if impulse_ns <= 0.0 && deepest.dist >= SEPARATE_M {
                return None;
            }
            let pose = self.world.colliders[pair.collider1].position();
            let at = |contact: &rapier::TrackedContact<_>| {
                let at = pose.transform_point(contact.local_p1);
                Point2::new(f64::from(at.x), f64::from(at.y))
            };
            let mut touching = manifold.points.iter().filter(|contact| contact.dist < SEPARATE_M);
            let first = touching.next().unwrap_or(deepest);
            let ends = [first, touching.next_back().unwrap_or(first)].map(at);
            let (other, sign) =
                if pair.collider1 == own { (pair.collider2, 1.0) } else { (pair.collider1, -1.0) };
            let with = unpack(self.world.colliders[other].user_data);
            let normal = manifold.data.normal;
            let towards = Vector2::new(f64::from(normal.x), f64::from(normal.y)) * sign;
            Some(Touch { with, at: at(deepest), towards, ends, impulse_ns })
        })
    }
}
