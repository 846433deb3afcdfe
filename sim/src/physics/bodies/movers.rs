//! The bodies of obstacles that move: driven ones and pushed ones.

use super::{Bodies, cuboid, from_rapier, to_rapier};
use crate::physics::drives::GRAVITY_MPS2;
use crate::physics::report::Body;
use crate::physics::shape::Rectangle;
use crate::physics::spec::PushedSpec;
use nalgebra::Isometry2;
use rapier2d::prelude as rapier;
use serde::{Deserialize, Serialize};

/// The damping of friction while its force is enough, 1/s: almost no speed is left after a step.
const FRICTION_PER_S: f32 = 1e5;

/// The body of an obstacle that moves.
#[derive(Clone, Copy, Deserialize, Serialize)]
pub(crate) struct Mover {
    body: rapier::RigidBodyHandle,
    /// The joint that gives a box friction on the floor, and the greatest force of the friction, N.
    friction: Option<(rapier::ImpulseJointHandle, f32)>,
}

impl Bodies {
    /// Adds a body that follows given poses. Contacts do not stop it.
    pub(crate) fn add_driven(&mut self, body: Body, shape: &Rectangle) -> Mover {
        let collider = cuboid(body, shape);
        let body = rapier::RigidBodyBuilder::kinematic_position_based()
            .pose(to_rapier(&shape.pose))
            .can_sleep(false);
        let body = self.world.insert(body, collider).0;
        self.movers.push(body);
        Mover { body, friction: None }
    }

    /// Sets the pose of such a body after the next step.
    pub(crate) fn drive(&mut self, mover: &Mover, to: &Isometry2<f64>) {
        self.world.bodies[mover.body].set_next_kinematic_position(to_rapier(to));
    }

    /// Adds a body that can be pushed, with friction on the floor.
    pub(crate) fn add_pushed(&mut self, body: Body, shape: &Rectangle, pushed: &PushedSpec) -> Mover {
        let collider = cuboid(body, shape).mass(pushed.mass_kg as f32);
        let body = rapier::RigidBodyBuilder::dynamic().pose(to_rapier(&shape.pose));
        let body = self.world.insert(body, collider).0;
        self.add_free(body, shape.half_m.min(), self.predicted_m.unwrap_or(0.0));
        let mut mover = Mover { body, friction: None };
        let weight_n = pushed.friction * pushed.mass_kg * GRAVITY_MPS2;
        if weight_n > 0.0 {
            let world = &mut self.world;
            let floor =
                *self.floor.get_or_insert_with(|| world.insert_body(rapier::RigidBodyBuilder::fixed()));
            // The mean distance of the points of a rectangle from its center is 0.87 (long) to 0.94 (square)
            // times the root mean square distance.
            let lever_m = 0.9 * (shape.half_m.norm_squared() / 3.0).sqrt();
            let mut motors = rapier::GenericJointBuilder::new(rapier::JointAxesMask::empty());
            for (axis, force) in [
                (rapier::JointAxis::LinX, weight_n),
                (rapier::JointAxis::LinY, weight_n),
                (rapier::JointAxis::AngX, weight_n * lever_m),
            ] {
                motors = motors.motor_velocity(axis, 0.0, FRICTION_PER_S).motor_max_force(axis, force as f32);
            }
            let joint = world.insert_impulse_joint(floor, body, motors.build());
            mover.friction = Some((joint, weight_n as f32));
        }
        mover
    }

    /// The pose of a pushed body after the last step.
    pub(crate) fn pushed_pose(&mut self, mover: &Mover) -> Isometry2<f64> {
        let body = &self.world.bodies[mover.body];
        let velocity = body.linvel();
        let at = from_rapier(body.position());
        if let Some((joint, weight_n)) = mover.friction
            && let Some(joint) = self.world.impulse_joints.get_mut(joint, false)
        {
            // In motion the friction acts along the direction of motion, not along each axis; at rest its
            // direction is not known in advance.
            let speed_mps = velocity.length();
            let share =
                if speed_mps > 1e-3 { velocity.abs() / speed_mps } else { rapier::Vector::splat(1.0) };
            joint.data.set_motor_max_force(rapier::JointAxis::LinX, weight_n * share.x);
            joint.data.set_motor_max_force(rapier::JointAxis::LinY, weight_n * share.y);
        }
        at
    }
}
