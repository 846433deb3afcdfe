//! A robot at work: its sensors, behavior, drive and odometry. Its body belongs to `bodies`.

mod odometry;
mod view;

pub use view::RobotView;

use super::behaviors::Behavior;
use super::bodies::Bodies;
use super::drives::{Motors, Velocity};
use super::form::Form;
use super::report::Body;
use super::sensors::{Look, Platform, Sensor, SharedBeams, Surroundings};
use super::snapshot::pose;
use super::spec::{BehaviorSpec, RobotSpec};
use interfaces::{LaserReading, Purpose, RandomStream, Twist, Values, values};
use nalgebra::{Isometry2, Point2, Vector2};
use odometry::{Displacements, Odometry};
use std::sync::Arc;

#[derive(Clone)]
pub(crate) struct SimulatedRobot {
    pub(super) spec: RobotSpec,
    /// The index among the robots.
    index: usize,
    /// The true pose.
    pub(super) pose: Isometry2<f64>,
    /// The true pose before the last step.
    pub(super) previous_pose: Isometry2<f64>,
    pub(super) velocity: Velocity,
    /// The velocity that the drive gave the robot in the last step.
    pub(super) driven: Velocity,
    /// The bodies that the robot touches now.
    pub(super) touching: Vec<Body>,
    /// The bumpers that touch something, as bits.
    pub(super) pressed_bumpers: u64,
    command: Velocity,
    drive: Motors,
    /// What the odometry measures in addition to the velocity of the robot: the slip of the wheels.
    slipping: Velocity,
    odometry: Odometry,
    /// When the odometry jumps, and when the robot is carried away.
    jumps: Option<Displacements>,
    pub(super) carried: Option<Displacements>,
    /// `None` if the robot executes commands.
    behavior: Option<Behavior>,
    /// All sensors, the main laser scanner first.
    sensors: Vec<Sensor>,
    /// The different numbers of steps from one measurement of a sensor to the next.
    periods: Vec<u64>,
}

impl SimulatedRobot {
    /// The robot with an index, at `pose`. `beams` are those of all robots.
    pub(super) fn new(
        spec: &RobotSpec,
        index: usize,
        pose: Isometry2<f64>,
        step_s: f64,
        seed: u64,
        beams: &mut SharedBeams,
    ) -> Self {
        let random = |purpose| RandomStream::new(seed, purpose);
        let sensors = Sensor::all(spec, beams, seed, index);
        let mut periods: Vec<u64> = sensors.iter().map(Sensor::period_steps).collect();
        periods.sort_unstable();
        periods.dedup();
        let displacements =
            |spec: Option<_>, purpose| spec.map(|spec| Displacements::new(spec, random(purpose)));
        let laser_beams = beams.of_laser(&spec.laser);
        Self {
            index,
            pose,
            previous_pose: pose,
            velocity: Velocity::STOP,
            driven: Velocity::STOP,
            touching: Vec::new(),
            pressed_bumpers: 0,
            command: Velocity::STOP,
            drive: Motors::new(spec.drive),
            slipping: Velocity::STOP,
            odometry: Odometry::new(spec, random(Purpose::OdometryNoise(index)), pose),
            jumps: displacements(spec.odometry.jump, Purpose::OdometryJump(index)),
            carried: displacements(spec.odometry.carried, Purpose::Carried(index)),
            behavior: Behavior::of(spec, step_s, &laser_beams, random(Purpose::Behavior(index))),
            sensors,
            periods,
            spec: spec.clone(),
        }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        let Self { velocity, driven, slipping, touching, pressed_bumpers, command, drive, odometry, .. } =
            self;
        let mut values = vec![pose(&mut self.pose), pose(&mut self.previous_pose)];
        values.extend(
            values![*velocity, *driven, *slipping, *touching, *pressed_bumpers, *command; drive, odometry],
        );
        let displacements = self.jumps.iter_mut().chain(&mut self.carried);
        values.extend(displacements.flat_map(Displacements::values));
        values.extend(self.behavior.iter_mut().flat_map(Behavior::values));
        values.extend(self.sensors.iter_mut().flat_map(Sensor::values));
        values
    }

    /// The center, m.
    pub(super) fn at(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    /// The outline at the present pose.
    pub(super) fn form(&self) -> Form {
        self.spec.form(&self.pose)
    }

    /// Whether the robot moved in the last step.
    pub(super) fn has_moved(&self) -> bool {
        self.pose != self.previous_pose
    }

    /// Whether the robot obeys commands.
    pub(super) fn is_driven(&self) -> bool {
        self.behavior.is_none()
    }

    /// The time until which the robot rests if no other body moves, s; `None` if it moves, or decides by itself.
    pub(super) fn rests_until_s(&self) -> Option<f64> {
        let is_still = !self.has_moved()
            && [self.velocity, self.driven, self.slipping].iter().all(|own| *own == Velocity::STOP);
        let obeys = matches!(self.spec.behavior, BehaviorSpec::Driven | BehaviorSpec::Standing);
        let displaced = self.jumps.iter().chain(&self.carried).map(Displacements::next_s);
        (is_still && obeys && self.command == Velocity::STOP).then(|| displaced.fold(f64::INFINITY, f64::min))
    }

    /// Whether the main laser scanner measures at a step. The robot then decides.
    pub(super) fn decides(&self, step: u64) -> bool {
        self.sensors[0].is_due(step)
    }

    /// Whether any sensor measures at a step.
    pub(super) fn senses(&self, step: u64) -> bool {
        self.periods.iter().any(|period| step.is_multiple_of(*period))
    }

    /// Whether nothing is left to do at a step, at the time `time_s`: the robot does not decide by itself, and no sensor is
    /// due that has not measured yet.
    pub(super) fn has_thought(&self, step: u64, time_s: f64) -> bool {
        let mut due = self.sensors.iter().filter(|sensor| sensor.is_due(step));
        self.is_driven() && due.all(|sensor| sensor.has_measured(time_s))
    }

    /// Whether the robot reads its main laser scanner at once when it decides.
    pub(super) fn looks(&self) -> bool {
        self.behavior.as_ref().is_some_and(Behavior::looks)
    }

    /// Whether a laser of the robot sweeps.
    pub(super) fn sweeps(&self) -> bool {
        self.spec.lasers().any(|laser| laser.sweep_s > 0.0)
    }

    /// The latest reading of the main laser scanner.
    pub(super) fn reading(&self) -> Option<&LaserReading> {
        self.sensors[0].laser_reading()?
    }

    /// Sets the command of the robot.
    pub(super) fn command(&mut self, command: &Velocity) {
        self.command = *command;
    }

    /// Carries the robot to `pose`, at rest. The robot keeps its command, and the odometry does not notice.
    pub(super) fn carry(&mut self, pose: Isometry2<f64>) {
        self.pose = pose;
        self.velocity = Velocity::STOP;
        self.drive = Motors::new(self.spec.drive);
        self.slipping = Velocity::STOP;
    }

    /// Moves the robot to `pose`, at rest. The odometry starts again there.
    pub(super) fn put(&mut self, pose: Isometry2<f64>) {
        self.carry(pose);
        self.previous_pose = pose;
        self.command = Velocity::STOP;
        self.odometry.restart(pose);
        self.touching.clear();
        self.pressed_bumpers = 0;
        self.sensors.iter_mut().for_each(Sensor::clear);
    }

    /// Measures with the main laser scanner, and with all other sensors that are due.
    pub(super) fn look(&mut self, surroundings: &Arc<Surroundings>) {
        self.sense(surroundings, true);
    }

    /// Measures with all sensors that are due. A robot with a behavior then decides its velocity.
    pub(super) fn think(&mut self, surroundings: &Arc<Surroundings>) {
        let decides = self.decides(surroundings.step);
        let looks = decides && self.looks();
        self.sense(surroundings, looks);
        if decides
            && let Some(behavior) = &mut self.behavior
            && let Some(twist) = behavior.decide(|| self.sensors[0].laser_reading()?)
        {
            self.command = twist.into();
        }
    }

    /// Measures with all sensors that are due, and with the main laser scanner if its reading `is_needed` now.
    fn sense(&mut self, surroundings: &Arc<Surroundings>, is_needed: bool) {
        let look = Look::new(self.platform(), Arc::clone(surroundings));
        let others = if is_needed {
            self.sensors[0].measure(&look);
            &mut self.sensors[1..]
        } else {
            &mut self.sensors[..]
        };
        let mut shared = None;
        for sensor in others.iter_mut().filter(|sensor| sensor.is_due(surroundings.step)) {
            sensor.request(shared.get_or_insert_with(|| Arc::new(look.clone())));
        }
    }

    /// The velocity by odometry.
    pub(super) fn odometry_twist(&self) -> Twist {
        let (velocity, slipping) = (self.velocity.twist(), self.slipping.twist());
        self.odometry.twist(&Twist {
            linear_mps: velocity.linear_mps + slipping.linear_mps,
            angular_radps: velocity.angular_radps + slipping.angular_radps,
        })
    }

    fn platform(&self) -> Platform {
        Platform {
            robot: self.index,
            pose: self.pose,
            odometry_pose: self.odometry.pose,
            odometry_twist: self.odometry_twist(),
        }
    }

    /// Gives the body the velocity of the next step.
    pub(super) fn start_step(&mut self, bodies: &mut Bodies, step_s: f64) {
        self.velocity = self.drive.step(&self.command, step_s);
        // Without what contacts gave: wheels that do not roll sideways drive nowhere sideways.
        self.driven = if self.spec.drive.is_omni() { self.velocity } else { self.velocity.twist().into() };
        bodies.set_velocity(self.index, &self.velocity, step_s);
    }

    /// The speed of the drive in the last step at a point of the body (m), in the direction of a unit vector, m/s.
    pub(super) fn speed_mps(&self, at: &Point2<f64>, direction: &Vector2<f64>) -> f64 {
        let Velocity { forward_mps, left_mps, turn_radps } = self.driven;
        let arm = at - self.previous_pose.translation.vector;
        let velocity = self.previous_pose.rotation * Vector2::new(forward_mps, left_mps)
            + Vector2::new(-arm.y, arm.x) * turn_radps;
        velocity.dot(direction)
    }

    /// The velocity of the wheels that the odometry measures in addition to the velocity `solved` of a robot that a contact
    /// holds back or pushes: wheels that slip turn as commanded.
    fn slip(&self, solved: &Velocity) -> Velocity {
        let (wheels, slip) = (self.drive.reached(&self.command), self.spec.odometry.slip);
        Velocity {
            forward_mps: slip * (wheels.forward_mps - solved.forward_mps),
            left_mps: slip * (wheels.left_mps - solved.left_mps),
            turn_radps: slip * (wheels.turn_radps - solved.turn_radps),
        }
    }

    /// Takes over the pose and the velocity of the body after the step, which ends at `time_s`.
    pub(super) fn end_step(&mut self, bodies: &Bodies, time_s: f64, step_s: f64) {
        self.previous_pose = std::mem::replace(&mut self.pose, bodies.pose(self.index));
        let solved = bodies.velocity(self.index);
        self.velocity = self.drive.settle(&solved);
        self.slipping = if self.drive.is_stalled { self.slip(&solved) } else { Velocity::STOP };
        self.odometry.update(&self.previous_pose, &self.pose, &self.slipping, step_s);
        if let Some(jumps) = &mut self.jumps
            && jumps.is_due(time_s)
        {
            self.odometry.jump(jumps);
        }
    }
}
