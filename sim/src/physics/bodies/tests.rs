//! Queries of the tests in `physics/tests`.

use super::Bodies;
use nalgebra::{Point2, Vector2};
use rapier2d::prelude as rapier;

impl Bodies {
    /// The kinetic energy of all dynamic bodies, J.
    pub(crate) fn kinetic_j(&self) -> f64 {
        let energy = |body: &rapier::RigidBody| {
            let inertia = body.mass_properties().effective_angular_inertia();
            let spin = body.angvel() * body.angvel() * inertia;
            f64::from(body.mass() * body.linvel().length_squared() + spin) / 2.0
        };
        self.world.bodies.iter().filter(|(_, body)| body.is_dynamic()).map(|(_, body)| energy(body)).sum()
    }

    /// Updates the positions of colliders for ray casts.
    pub(crate) fn find_again(&mut self) {
        self.world.detect_collisions(&(), &());
    }

    /// The nearest body that a ray meets, m; the oracle for our own rays.
    pub(crate) fn ray_m(
        &self,
        from: &Point2<f64>,
        along: &Vector2<f64>,
        own: usize,
        max_m: f64,
    ) -> Option<f64> {
        let filter = rapier::QueryFilter::default().exclude_rigid_body(self.robots[own].body);
        let world = &self.world;
        let query = world.broad_phase.as_query_pipeline(
            world.narrow_phase.query_dispatcher(),
            &world.bodies,
            &world.colliders,
            filter,
        );
        let origin = rapier::Vector::new(from.x as f32, from.y as f32);
        let ray = rapier::Ray::new(origin, rapier::Vector::new(along.x as f32, along.y as f32));
        query.cast_ray(&ray, max_m as f32, true).map(|(_, range_m)| f64::from(range_m))
    }
}
