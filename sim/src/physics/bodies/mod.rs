//! Rigid bodies and contacts: the only folder that knows rapier.

mod mend;
mod movers;
#[cfg(test)]
mod oracle;
mod touch;

pub(super) use movers::Mover;
pub(super) use touch::Touch;

use super::command::Velocity;
use super::report::Body;
use super::shape::Rectangle;
use super::snapshot::{Played, Tape, Torn};
use super::spec::{FleetSpec, Motion, RobotSpec};
use interfaces::{heading_rad, rotation};
use nalgebra::{Isometry2, Translation2, Vector2};
use rapier2d::prelude as rapier;

/// The most that an obstacle's surface moves by itself in a step, m, with some room.
const MOVER_M: f64 = 0.125;
/// How far corners turn in a step is foreseen up to this way, m: farther on, they do not go straight.
const MOST_TURN_M: f64 = 0.25;

/// All bodies: walls and obstacles that stand, robots that drive.
pub(super) struct Bodies {
    world: rapier::PhysicsWorld,
    robots: Vec<Robot>,
    /// Robots and what is pushed, with their poses before the last step.
    free: Vec<(rapier::RigidBodyHandle, rapier::Pose)>,
    /// What boxes rub on.
    floor: Option<rapier::RigidBodyHandle>,
    /// Whether contacts are foreseen alike for all bodies, and not by each one's own velocity.
    foresees_all: bool,
}

#[derive(Clone)]
struct Robot {
    body: rapier::RigidBodyHandle,
    collider: rapier::ColliderHandle,
    /// The heading of the wheels half way through the last step.
    forward: Vector2<f64>,
}

/// An obstacle's body, to take it away again.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Handle(rapier::ColliderHandle);

impl Handle {
    /// Writes or reads it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        let (mut index, mut generation) = self.0.into_raw_parts();
        tape.u32(&mut index)?;
        tape.u32(&mut generation)?;
        self.0 = rapier::ColliderHandle::from_raw_parts(index, generation);
        Ok(())
    }
}

impl Clone for Bodies {
    fn clone(&self) -> Self {
        // Of what rapier has no copy, there is only workspace, and what is not used here.
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
            foresees_all: self.foresees_all,
        }
    }
}

impl Bodies {
    /// No bodies yet, but all of `spec` are to come.
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let mut world = rapier::PhysicsWorld { gravity: rapier::Vector::ZERO, ..Default::default() };
        world.integration_parameters.dt = spec.step_s as f32;
        let foreseen_m = foreseen_m(spec);
        if let Some(foreseen_m) = foreseen_m {
            let parameters = &mut world.integration_parameters;
            parameters.normalized_prediction_distance =
                parameters.normalized_prediction_distance.max(foreseen_m);
        }
        // Distances of contacts are read at every step, so they must not be stale.
        world.integration_parameters.contact_recycling = false;
        Self { world, robots: Vec::new(), free: Vec::new(), floor: None, foresees_all: foreseen_m.is_some() }
    }

    /// Writes or reads all that moves and touches. The same bodies must have been added before.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        let mut bytes = match tape {
            Tape::Writing(_) => postcard::to_stdvec(&self.world).map_err(|_| Torn)?,
            Tape::Reading(_) => Vec::new(),
        };
        tape.bytes(&mut bytes)?;
        if let Tape::Reading(_) = tape {
            self.world = postcard::from_bytes(&bytes).map_err(|_| Torn)?;
        }
        for robot in &mut self.robots {
            tape.f64(&mut robot.forward.x)?;
            tape.f64(&mut robot.forward.y)?;
        }
        Ok(())
    }

    /// Adds a body that stands still.
    pub(super) fn add_box(&mut self, body: Body, shape: &Rectangle) -> Handle {
        let collider = cuboid(body, shape).position(to_rapier(&shape.pose));
        Handle(self.world.insert_collider(collider, None))
    }

    /// Takes such a body away.
    pub(super) fn remove_box(&mut self, handle: Handle) {
        self.world.remove_collider(handle.0);
    }

    /// Adds a robot; robots are numbered in the order in which they are added.
    pub(super) fn add_robot(&mut self, spec: &RobotSpec, step_s: f64) {
        // Friction 0: a round robot slides along a wall, as one with a bumper ring does.
        let corners = spec.corners.iter().map(|corner| rapier::Vector::new(corner.x as f32, corner.y as f32));
        let is_round = spec.corners.is_empty();
        let hull = if is_round { None } else { rapier::ColliderBuilder::convex_polyline(corners.collect()) };
        let collider = hull
            .unwrap_or_else(|| rapier::ColliderBuilder::ball(spec.radius_m as f32))
            .friction(0.0)
            .user_data(pack(Body::Robot(self.robots.len())));
        let collider = match spec.mass_kg {
            // The wheels turn it about its middle, wherever the middle of its outline is.
            _ if !is_round => collider.density(0.0),
            Some(mass_kg) => collider.mass(mass_kg as f32),
            None => collider,
        };
        // Contacts are foreseen over a step's way, so that a fast robot does not enter a wall. (rapier
        // would leave those out that a body does not drive into by itself.)
        let own_way_m = if self.foresees_all { 0.0 } else { 2.0 * spec.drive.fastest_mps() * step_s };
        let body = rapier::RigidBodyBuilder::dynamic()
            .pose(to_rapier(&spec.pose))
            .can_sleep(false)
            .soft_ccd_prediction(own_way_m as f32);
        let body = if is_round { body } else { body.additional_mass_properties(disc_mass(spec)) };
        let (body, collider) = self.world.insert(body, collider);
        self.free.push((body, to_rapier(&spec.pose)));
        self.robots.push(Robot { body, collider, forward: Vector2::x() });
    }

    /// Sets a robot's velocity for the next step: along the heading half way through it, so that
    /// steps make up an arc.
    pub(super) fn set_velocity(&mut self, robot: usize, own_velocity: &Velocity, step_s: f64) {
        let own = &mut self.robots[robot];
        let body = &mut self.world.bodies[own.body];
        let heading = f64::from(body.rotation().angle()) + own_velocity.turn_radps * step_s / 2.0;
        own.forward = rotation(heading) * Vector2::x();
        let velocity = own.forward * own_velocity.forward_mps + left(&own.forward) * own_velocity.left_mps;
        body.set_linvel(rapier::Vector::new(velocity.x as f32, velocity.y as f32), true);
        body.set_angvel(own_velocity.turn_radps as f32, true);
    }

    /// Lets one step pass.
    pub(super) fn step(&mut self) {
        for (body, was) in &mut self.free {
            *was = *self.world.bodies[*body].position();
        }
        self.world.step();
        self.mend();
    }

    /// Where a robot is.
    pub(super) fn pose(&self, robot: usize) -> Isometry2<f64> {
        from_rapier(self.world.bodies[self.robots[robot].body].position())
    }

    /// The velocity that the contacts left a robot in the last step.
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

    /// Sets a robot down somewhere else, at rest.
    pub(super) fn put(&mut self, robot: usize, pose: &Isometry2<f64>) {
        let body = &mut self.world.bodies[self.robots[robot].body];
        body.set_position(to_rapier(pose), true);
        body.set_linvel(rapier::Vector::ZERO, true);
        body.set_angvel(0.0, true);
    }
}

/// Over which way contacts are foreseen for all bodies, m, if there are any that each one's own
/// velocity does not foretell: what is pushed moves as others drive, and corners move as they turn.
/// Where all robots are round and nothing else moves, that is rare enough to do without.
fn foreseen_m(spec: &FleetSpec) -> Option<f32> {
    let has_movers = spec.obstacles.iter().any(|obstacle| !matches!(obstacle.motion, Motion::Fixed));
    if !has_movers && spec.robots.iter().all(|robot| robot.corners.is_empty()) {
        return None;
    }
    let ways_m = spec.robots.iter().map(|robot| {
        let turn_radps = if robot.corners.is_empty() { 0.0 } else { robot.drive.max_angular_radps };
        let turn_m = (turn_radps * robot.radius_m * spec.step_s).min(MOST_TURN_M);
        robot.drive.fastest_mps() * spec.step_s + turn_m
    });
    let farthest_m = ways_m.fold(if has_movers { MOVER_M } else { 0.0 }, f64::max);
    // Twice: another one may come towards it.
    Some((2.0 * farthest_m) as f32)
}

/// The mass of a disc about a robot's middle.
fn disc_mass(spec: &RobotSpec) -> rapier::MassProperties {
    let square_m2 = spec.radius_m * spec.radius_m;
    let mass_kg = spec.mass_kg.unwrap_or(std::f64::consts::PI * square_m2);
    rapier::MassProperties::new(rapier::Vector::ZERO, mass_kg as f32, (mass_kg * square_m2 / 2.0) as f32)
}

/// The direction to the left.
fn left(forward: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-forward.y, forward.x)
}

/// A rectangle's collider, without a place. All sides are smooth.
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

/// A body's name in the 128 bits that rapier keeps for us.
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
