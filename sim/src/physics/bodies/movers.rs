//! Obstacles that move: driven ones, and those that are pushed.

use super::{Bodies, cuboid, from_rapier, to_rapier};
use crate::physics::report::Body;
use crate::physics::shape::Rectangle;
use crate::physics::spec::PushedSpec;
use nalgebra::Isometry2;
use rapier2d::prelude as rapier;

/// Standard gravity: what presses boxes onto the floor.
const GRAVITY_MPS2: f64 = 9.806_65;
/// How hard friction holds, as long as its force is enough, 1/s: what is left of a speed after a
/// step is next to nothing.
const RUB_PER_S: f32 = 1e5;

/// The body of an obstacle that moves.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Mover {
    body: rapier::RigidBodyHandle,
    /// What makes a box rub on the floor, with the force that it takes to move it, N.
    rubs: Option<(rapier::ImpulseJointHandle, f32)>,
}

impl Bodies {
    /// Adds a body that goes where it is told to, whatever is in its way.
    pub(in crate::physics) fn add_driven(&mut self, body: Body, shape: &Rectangle) -> Mover {
        let collider = cuboid(body, shape);
        let body = rapier::RigidBodyBuilder::kinematic_position_based()
            .pose(to_rapier(&shape.pose))
            .can_sleep(false);
        Mover { body: self.world.insert(body, collider).0, rubs: None }
    }

    /// Tells such a body where to be after the next step.
    pub(in crate::physics) fn drive(&mut self, mover: &Mover, to: &Isometry2<f64>) {
        self.world.bodies[mover.body].set_next_kinematic_position(to_rapier(to));
    }

    /// Adds a body that is pushed, and rubs on the floor.
    pub(in crate::physics) fn add_pushed(
        &mut self,
        body: Body,
        shape: &Rectangle,
        pushed: &PushedSpec,
    ) -> Mover {
        let collider = cuboid(body, shape).mass(pushed.mass_kg as f32);
        let body = rapier::RigidBodyBuilder::dynamic().pose(to_rapier(&shape.pose));
        let body = self.world.insert(body, collider).0;
        self.free.push((body, to_rapier(&shape.pose)));
        let mut mover = Mover { body, rubs: None };
        let weight_n = pushed.friction * pushed.mass_kg * GRAVITY_MPS2;
        if weight_n > 0.0 {
            let world = &mut self.world;
            let floor =
                *self.floor.get_or_insert_with(|| world.insert_body(rapier::RigidBodyBuilder::fixed()));
            // The mean distance of a rectangle's points from its middle is 0.87 (long) to 0.94 (square)
            // times the root of their mean square.
            let lever_m = 0.9 * (shape.half_m.norm_squared() / 3.0).sqrt();
            let mut rub = rapier::GenericJointBuilder::new(rapier::JointAxesMask::empty());
            for (axis, force) in [
                (rapier::JointAxis::LinX, weight_n),
                (rapier::JointAxis::LinY, weight_n),
                (rapier::JointAxis::AngX, weight_n * lever_m),
            ] {
                rub = rub.motor_velocity(axis, 0.0, RUB_PER_S).motor_max_force(axis, force as f32);
            }
            let joint = world.insert_impulse_joint(floor, body, rub.build());
            mover.rubs = Some((joint, weight_n as f32));
        }
        mover
    }

    /// Where the last step brought a body that is pushed.
    pub(in crate::physics) fn pushed_pose(&mut self, mover: &Mover) -> Isometry2<f64> {
        let body = &self.world.bodies[mover.body];
        let velocity = body.linvel();
        let at = from_rapier(body.position());
        if let Some((joint, weight_n)) = mover.rubs
            && let Some(joint) = self.world.impulse_joints.get_mut(joint, false)
        {
            // In motion the force of the weight acts along it, and not along each axis; at rest it
            // is not known where it will be needed.
            let speed_mps = velocity.length();
            let share =
                if speed_mps > 1e-3 { velocity.abs() / speed_mps } else { rapier::Vector::splat(1.0) };
            joint.data.set_motor_max_force(rapier::JointAxis::LinX, weight_n * share.x);
            joint.data.set_motor_max_force(rapier::JointAxis::LinY, weight_n * share.y);
        }
        at
    }
}
