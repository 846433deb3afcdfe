//! Steps without rapier: robots are moved, and rapier finds them there in its next step.

use super::{Bodies, RobotBody, to_rapier, unpack};
use crate::physics::report::Body;
use nalgebra::{Point2, Vector2};
use rapier2d::prelude as rapier;

/// A body that is slower than this is at rest, m/s and rad/s.
const REST: f32 = 1e-5;

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
    /// The motion of a robot in the next step if nothing is in its way, m.
    pub(crate) fn wanted_m(&self, robot: usize) -> Vector2<f64> {
        let RobotBody { pose, free, .. } = &self.robots[robot];
        free.translation.vector - pose.translation.vector
    }

    /// The mass of a robot, kg.
    pub(crate) fn mass_kg(&self, robot: usize) -> f64 {
        f64::from(self.world.bodies[self.robots[robot].body].mass())
    }

    /// Whether no box moves.
    pub(crate) fn boxes_rest(&self) -> bool {
        // Contacts move robots as well: those are compared by their positions.
        let is_robot = |body| self.robots.iter().any(|robot| robot.body == body);
        let mut boxes = self.free.iter().map(|free| free.body).filter(|body| !is_robot(*body));
        boxes.all(|body| {
            let body = &self.world.bodies[body];
            body.linvel().length() < REST && body.angvel().abs() < REST
        })
    }

    /// Moves a robot by the motion of a step (m), and turns it by its velocity.
    pub(crate) fn slide(&mut self, robot: usize, moved_m: &Vector2<f64>) {
        let own = &mut self.robots[robot];
        let body = &mut self.world.bodies[own.body];
        let velocity = moved_m / f64::from(self.world.integration_parameters.dt);
        body.set_linvel(rapier::Vector::new(velocity.x as f32, velocity.y as f32), true);
        own.pose.translation.vector += moved_m;
        own.pose.rotation = own.free.rotation;
        body.set_position(to_rapier(&own.pose), true);
    }

    /// Ends a step without rapier, in which robots (by index) touched bodies.
    pub(crate) fn end_slide(&mut self, touches: Vec<(usize, Touch)>) {
        for mover in &self.movers {
            let to = *self.world.bodies[*mover].next_position();
            if *self.world.bodies[*mover].position() != to {
                self.world.bodies[*mover].set_position(to, true);
            }
        }
        self.slid = Some(touches);
    }

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
