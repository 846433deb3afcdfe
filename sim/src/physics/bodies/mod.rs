//! Rigid bodies and contacts. This folder is the only one that knows rapier.

mod movers;
mod penetration;
mod slide;
#[cfg(test)]
mod tests;

pub(super) use movers::Mover;
pub(super) use slide::{SEPARATE_M, Touch};

use super::convex;
use super::drives::Velocity;
use super::report::Body;
use super::shape::Rectangle;
use super::snapshot::{Values, pose, value};
use super::spec::{FleetSpec, Motion, RobotSpec};
use interfaces::{heading_rad, rotation};
use nalgebra::{Isometry2, Translation2, Vector2};
use rapier2d::prelude as rapier;
use serde::{Deserialize, Serialize};

/// The maximum motion of the surface of an obstacle in a step, m, with a margin.
const MAX_MOVER_M: f64 = 0.125;
/// The largest motion of a corner in a step that contacts are predicted for, m: a longer motion is not straight.
const MAX_TURN_M: f64 = 0.25;
/// What rounding adds to the motion of a step, m.
const ROUNDING_M: f64 = 1e-4;

/// All bodies: walls, obstacles and robots.
pub(super) struct Bodies {
    world: rapier::PhysicsWorld,
    robots: Vec<RobotBody>,
    /// Robots and pushed obstacles.
    free: Vec<Free>,
    /// The body that pushed boxes have friction with.
    floor: Option<rapier::RigidBodyHandle>,
    /// The motion in a step that contacts are predicted for, m, for all bodies; `None`: by the velocity of each.
    predicted_m: Option<f64>,
    /// The bodies that follow given poses.
    movers: Vec<rapier::RigidBodyHandle>,
    /// The contacts of the last step, by robot, if it went by without rapier.
    slid: Option<Vec<(usize, Touch)>>,
}

/// A body that contacts move.
#[derive(Clone, Copy)]
struct Free {
    body: rapier::RigidBodyHandle,
    /// The pose before the last step.
    before: rapier::Pose,
    /// The radius of a circle around the origin of the body that holds the body, m.
    radius_m: f32,
    /// The longest motion in a step, m, for which it is enough to look at its end: contacts are predicted over it, and
    /// no body passes through another one in it.
    reach_m: f64,
}

#[derive(Clone)]
struct RobotBody {
    body: rapier::RigidBodyHandle,
    collider: rapier::ColliderHandle,
    /// The pose. rapier has a copy in 32 bits; in a step with a contact, the pose is rapier's.
    pose: Isometry2<f64>,
    /// The pose after the step, and rapier's velocities, if there is no contact.
    free: Isometry2<f64>,
    driven: rapier::RigidBodyVelocity<f32>,
    /// The direction of the wheels in the middle of the last step.
    forward: Vector2<f64>,
}

/// The body of an obstacle that can be removed.
#[derive(Clone, Copy, Deserialize, Serialize)]
pub(super) struct Handle(rapier::ColliderHandle);

impl Clone for Bodies {
    fn clone(&self) -> Self {
        // The parts that rapier does not copy are workspace, or not used here.
        let world = rapier::PhysicsWorld {
            gravity: self.world.gravity,
            integration_parameters: self.world.integration_parameters,
            islands: self.world.islands.clone(),
            broad_phase: self.world.broad_phase.clone(),
            narrow_phase: self.world.narrow_phase.clone(),
            bodies: self.world.bodies.clone(),
            colliders: self.world.colliders.clone(),
            impulse_joints: self.world.impulse_joints.clone(),
            ..Default::default()
        };
        Self {
            world,
            robots: self.robots.clone(),
            free: self.free.clone(),
            floor: self.floor,
            predicted_m: self.predicted_m,
            movers: self.movers.clone(),
            slid: self.slid.clone(),
        }
    }
}

impl Bodies {
    /// No bodies yet, with settings for all bodies of `spec`.
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let mut world = rapier::PhysicsWorld { gravity: rapier::Vector::ZERO, ..Default::default() };
        world.integration_parameters.dt = spec.step_s as f32;
        let predicted_m = predicted_m(spec);
        if let Some(predicted_m) = predicted_m {
            // Twice: two bodies may move towards each other.
            let distance_m = &mut world.integration_parameters.normalized_prediction_distance;
            *distance_m = distance_m.max((2.0 * predicted_m) as f32);
        }
        // Distances of contacts are read at every step, so they must be up to date.
        world.integration_parameters.contact_recycling = false;
        let (robots, free, movers) = (Vec::new(), Vec::new(), Vec::new());
        Self { world, robots, free, floor: None, predicted_m, movers, slid: None }
    }

    /// The values that a snapshot holds. The same bodies must have been added before.
    pub(super) fn values(&mut self) -> Values<'_> {
        let mut values = vec![value(&mut self.world)];
        values.extend(self.robots.iter_mut().map(|robot| pose(&mut robot.pose)));
        values
    }

    /// Adds a body that does not move.
    pub(super) fn add_box(&mut self, body: Body, shape: &Rectangle) -> Handle {
        let collider = cuboid(body, shape).position(to_rapier(&shape.pose));
        Handle(self.world.insert_collider(collider, None))
    }

    /// Removes a body that was added by `add_box`.
    pub(super) fn remove_box(&mut self, handle: Handle) {
        self.world.remove_collider(handle.0);
    }

    /// Adds a robot; robots are numbered in the order in which they are added.
    pub(super) fn add_robot(&mut self, spec: &RobotSpec, step_s: f64) {
        // Friction 0: a round robot slides along a wall, like a robot with a bumper ring.
        let corners = spec.corners.iter().map(|corner| rapier::Vector::new(corner.x as f32, corner.y as f32));
        let is_round = spec.corners.is_empty();
        let hull = if is_round { None } else { rapier::ColliderBuilder::convex_polyline(corners.collect()) };
        let collider = hull
            .unwrap_or_else(|| rapier::ColliderBuilder::ball(spec.radius_m as f32))
            .friction(0.0)
            .user_data(pack(Body::Robot(self.robots.len())));
        let collider = match spec.mass_kg {
            // The drive turns the robot about its center, even if the centroid of its outline is elsewhere.
            _ if !is_round => collider.density(0.0),
            Some(mass_kg) => collider.mass(mass_kg as f32),
            None => collider,
        };
        // Contacts are predicted over the motion of a step, so that a fast robot does not enter a wall. (rapier
        // would leave out those that a body does not drive into by itself.)
        let own_motion_m = spec.drive.fastest_mps() * step_s;
        let own_prediction_m = if self.predicted_m.is_some() { 0.0 } else { 2.0 * own_motion_m };
        let body = rapier::RigidBodyBuilder::dynamic()
            .pose(to_rapier(&spec.pose))
            .can_sleep(false)
            .soft_ccd_prediction(own_prediction_m as f32);
        let body = if is_round { body } else { body.additional_mass_properties(disc_mass(spec)) };
        let (body, collider) = self.world.insert(body, collider);
        let inner_m = if is_round { spec.radius_m } else { convex::inner_m(&spec.corners) };
        self.add_free(body, inner_m, self.predicted_m.unwrap_or(own_motion_m));
        let (pose, driven, forward) = (spec.pose, rapier::RigidBodyVelocity::zero(), Vector2::x());
        self.robots.push(RobotBody { body, collider, pose, free: pose, driven, forward });
    }

    /// Notes a body that contacts move, around a disc of `inner_m`.
    fn add_free(&mut self, body: rapier::RigidBodyHandle, inner_m: f64, predicted_m: f64) {
        // Half of it: the other body may move as well.
        let reach_m = (inner_m / 2.0).min(predicted_m + ROUNDING_M);
        let (before, colliders) = (*self.world.bodies[body].position(), self.world.bodies[body].colliders());
        let around =
            colliders.first().map(|own| self.world.colliders[*own].shape().compute_local_bounding_sphere());
        let radius_m = around.map_or(0.0, |circle| circle.center.length() + circle.radius);
        self.free.push(Free { body, before, radius_m, reach_m });
    }

    /// Sets the velocity of a robot for the next step: along the heading in the middle of the step, so that
    /// steps form an arc.
    pub(super) fn set_velocity(&mut self, robot: usize, own_velocity: &Velocity, step_s: f64) {
        let own = &mut self.robots[robot];
        let half = rotation(own_velocity.turn_radps * step_s / 2.0);
        let middle = own.pose.rotation * half;
        own.forward = middle * Vector2::x();
        let velocity = own.forward * own_velocity.forward_mps + left(&own.forward) * own_velocity.left_mps;
        let at = own.pose.translation.vector + velocity * step_s;
        own.free = Isometry2::from_parts(at.into(), middle * half);
        let velocity = rapier::Vector::new(velocity.x as f32, velocity.y as f32);
        own.driven = rapier::RigidBodyVelocity::new(velocity, own_velocity.turn_radps as f32);
        self.world.bodies[own.body].set_vels(own.driven, true);
    }

    /// Simulates one step.
    pub(super) fn step(&mut self) {
        self.slid = None;
        for Free { body, before, .. } in &mut self.free {
            *before = *self.world.bodies[*body].position();
        }
        self.world.step();
        self.resolve_penetration();
        for own in &mut self.robots {
            let body = &mut self.world.bodies[own.body];
            let free = to_rapier(&own.free);
            let off_m = f64::from((body.position().translation - free.translation).length());
            if *body.vels() == own.driven && off_m < ROUNDING_M {
                own.pose = own.free;
                body.set_position(free, true);
            } else {
                own.pose = from_rapier(body.position());
            }
        }
    }

    /// The pose of a robot.
    pub(super) fn pose(&self, robot: usize) -> Isometry2<f64> {
        self.robots[robot].pose
    }

    /// The velocity of a robot after the contacts of the last step.
    pub(super) fn velocity(&self, robot: usize) -> Velocity {
        let own = &self.robots[robot];
        let body = &self.world.bodies[own.body];
        let linear = Vector2::new(f64::from(body.linvel().x), f64::from(body.linvel().y));
        Velocity {
            forward_mps: linear.dot(&own.forward),
            left_mps: linear.dot(&left(&own.forward)),
            turn_radps: f64::from(body.angvel()),
        }
    }

    /// Puts a robot at a pose, at rest.
    pub(super) fn put(&mut self, robot: usize, pose: &Isometry2<f64>) {
        self.robots[robot].pose = *pose;
        let body = &mut self.world.bodies[self.robots[robot].body];
        body.set_position(to_rapier(pose), true);
        body.set_vels(rapier::RigidBodyVelocity::zero(), true);
    }
}

/// The motion in a step that contacts are predicted for, for all bodies, m. `None`: the velocity of each body is
/// enough. It is not enough where obstacles move (a pushed box moves as robots drive) or robots have corners
/// (which move as the robot turns).
fn predicted_m(spec: &FleetSpec) -> Option<f64> {
    let stays = |motion: &Motion| matches!(motion, Motion::Fixed | Motion::Scheduled(_));
    let has_movers = spec.obstacles.iter().any(|obstacle| !stays(&obstacle.motion));
    if !has_movers && spec.robots.iter().all(|robot| robot.corners.is_empty()) {
        return None;
    }
    let motions_m = spec.robots.iter().map(|robot| {
        let turn_radps = if robot.corners.is_empty() { 0.0 } else { robot.drive.max_angular_radps };
        let turn_m = (turn_radps * robot.radius_m * spec.step_s).min(MAX_TURN_M);
        robot.drive.fastest_mps() * spec.step_s + turn_m
    });
    Some(motions_m.fold(if has_movers { MAX_MOVER_M } else { 0.0 }, f64::max))
}

/// The mass of a disc about the center of a robot.
fn disc_mass(spec: &RobotSpec) -> rapier::MassProperties {
    let square_m2 = spec.radius_m * spec.radius_m;
    let mass_kg = spec.mass_kg.unwrap_or(std::f64::consts::PI * square_m2);
    rapier::MassProperties::new(rapier::Vector::ZERO, mass_kg as f32, (mass_kg * square_m2 / 2.0) as f32)
}

/// The direction to the left.
fn left(forward: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-forward.y, forward.x)
}

/// The collider of a rectangle, without a pose. All sides are smooth.
fn cuboid(body: Body, shape: &Rectangle) -> rapier::ColliderBuilder {
    rapier::ColliderBuilder::cuboid(shape.half_m.x as f32, shape.half_m.y as f32)
        .friction(0.0)
        .user_data(pack(body))
}

fn from_rapier(pose: &rapier::Pose) -> Isometry2<f64> {
    let at = Translation2::new(f64::from(pose.translation.x), f64::from(pose.translation.y));
    Isometry2::from_parts(at, rotation(f64::from(pose.rotation.angle())))
}

fn to_rapier(pose: &Isometry2<f64>) -> rapier::Pose {
    let at = pose.translation.vector;
    rapier::Pose::new(rapier::Vector::new(at.x as f32, at.y as f32), heading_rad(pose) as f32)
}

/// A body as the 128 bits of user data that rapier keeps.
fn pack(body: Body) -> u128 {
    let (kind, index) = match body {
        Body::Wall(index) => (0, index),
        Body::Obstacle(index) => (1, index),
        Body::Robot(index) => (2, index),
    };
    kind << 64 | index as u128
}

fn unpack(data: u128) -> Body {
    let index = data as u64 as usize;
    match data >> 64 {
        0 => Body::Wall(index),
        1 => Body::Obstacle(index),
        _ => Body::Robot(index),
    }
}
