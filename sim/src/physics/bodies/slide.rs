//! Steps without rapier: robots are moved, and rapier finds them there in its next step.

use super::{Bodies, RobotBody, Touch, to_rapier};
use nalgebra::Vector2;
use rapier2d::prelude as rapier;

/// A body that is slower than this is at rest, m/s and rad/s.
const REST: f32 = 1e-5;

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
}
