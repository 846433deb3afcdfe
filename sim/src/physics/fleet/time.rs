//! The steps of a fleet.

use super::Fleet;
use crate::physics::bodies::Touch;
use crate::physics::convex;
use crate::physics::drives::Velocity;
use crate::physics::form::Form;
use crate::physics::obstacles::{Blockers, Obstacle};
use crate::physics::past::Recent;
use crate::physics::report::Contact;
use crate::physics::robot::{RobotView, SimulatedRobot};
use crate::physics::sensors::{self, Surroundings};
use crate::physics::shape::Rectangle;
use interfaces::LaserReading;
use nalgebra::Point2;
use rayon::prelude::*;
use std::sync::Arc;

impl Fleet {
    /// Simulates one physics step. Robots whose scan is due measure first, and decide; `controller` decides for
    /// driven robots.
    pub fn step(&mut self, controller: &mut impl Controller) {
        self.contacts.clear();
        self.take_step(controller);
    }

    fn take_step(&mut self, controller: &mut impl Controller) {
        self.think(|_| true);
        for robot in &mut self.robots {
            if robot.is_driven()
                && robot.decides(self.step)
                && let Some(command) = controller.drive(&robot.view())
            {
                robot.command(&command);
            }
        }
        self.advance();
        self.update_obstacles(|_, _, _| ());
    }

    /// Simulates steps until the time is `time_s`, s.
    pub fn run_until(&mut self, time_s: f64, controller: &mut impl Controller) {
        self.contacts.clear();
        // Half a microsecond of slack: times are multiples of the step.
        while self.time_s() < time_s - 5e-7 {
            self.take_step(controller);
        }
    }

    /// Robots for which `is_meant` is true measure with the sensors that are due, and decide.
    pub(crate) fn think(&mut self, is_meant: impl Fn(&SimulatedRobot) -> bool + Sync) {
        let (step, time_s) = (self.step, self.time_s());
        let is_due = |robot: &SimulatedRobot| {
            robot.senses(step) && is_meant(robot) && !robot.has_thought(step, time_s)
        };
        let mut due = self.robots.iter().filter(|robot| is_due(robot)).peekable();
        if due.peek().is_none() {
            return;
        }
        let sweeps = due.any(SimulatedRobot::sweeps);
        let surroundings = &self.surroundings(sweeps);
        self.for_robots(is_due, |robot| robot.think(surroundings));
    }

    /// Lets the robots for which `is_meant` is true measure, in parallel if this is set.
    pub(super) fn for_robots(
        &mut self,
        is_meant: impl Fn(&SimulatedRobot) -> bool + Sync,
        measure: impl Fn(&mut SimulatedRobot) + Send + Sync,
    ) {
        if self.parallel_lasers {
            self.robots.par_iter_mut().filter(|robot| is_meant(robot)).for_each(measure);
        } else {
            self.robots.iter_mut().filter(|robot| is_meant(robot)).for_each(measure);
        }
    }

    /// What sensors that measure now can see. `sweeps`: a laser of theirs sweeps.
    pub(super) fn surroundings(&self, sweeps: bool) -> Arc<Surroundings> {
        let robots = self.robots.iter().map(|robot| robot.pose);
        let obstacles = self.obstacles.iter();
        let obstacles = obstacles.map(|obstacle| obstacle.is_standing().then_some(obstacle.shape.pose));
        let recent =
            if sweeps { self.past.recent(self.spec(), robots, obstacles) } else { Recent::default() };
        let (scene, time_s, glass) = (self.scene.clone(), self.time_s(), self.spec().glass.clone());
        Arc::new(Surroundings { step: self.step, time_s, scene, glass, recent })
    }

    /// Moves robots and obstacles by one physics step.
    pub(crate) fn advance(&mut self) {
        let step_s = self.spec().step_s;
        for robot in &mut self.robots {
            robot.start_step(&mut self.bodies, step_s);
        }
        let mut before = std::mem::take(&mut self.before);
        before.clear();
        before.extend(self.obstacles.iter().map(|obstacle| obstacle.shape));
        self.step += 1;
        let time_s = self.time_s();
        self.start_obstacles();
        if !self.slide() {
            self.bodies.step();
        }
        for index in 0..self.robots.len() {
            self.robots[index].end_step(&self.bodies, time_s, step_s);
            if self.robots[index].has_moved() {
                self.show_robot(index);
            }
        }
        self.moved.clear();
        for (index, before) in before.iter().enumerate() {
            self.obstacles[index].end_step(&mut self.bodies);
            if self.obstacles[index].shape != *before {
                self.moved.push((index, *before));
                self.show_obstacle(index);
            }
        }
        self.past.note(
            self.robots.iter().map(|robot| ([robot.previous_pose, robot.pose], robot.odometry_twist())),
            self.obstacles.iter().zip(&before).map(|(obstacle, before)| {
                obstacle.is_standing().then_some([before.pose, obstacle.shape.pose])
            }),
        );
        self.before = before;
        self.update_contacts();
        self.carry_robots();
    }

    /// Starts the motion of doors and blocks for the step that has begun.
    fn start_obstacles(&mut self) {
        if !self.obstacles.iter().any(Obstacle::moves_itself) {
            return;
        }
        let (time_s, step_s, blockers) = (self.time_s(), self.spec().step_s, self.blockers());
        for (index, obstacle) in self.obstacles.iter_mut().enumerate() {
            let is_needed = self.start.rooms.is_needed(index, &self.robots);
            obstacle.start_step([time_s, step_s], is_needed, &mut self.bodies, &blockers);
        }
    }

    /// All bodies that an obstacle must not run into.
    fn blockers(&self) -> Blockers {
        let mut blockers = Blockers::default();
        for robot in &self.robots {
            blockers.add(robot.at(), robot.spec.radius_m, robot.form());
        }
        for Obstacle { shape, .. } in self.obstacles.iter().filter(|obstacle| obstacle.is_pushed()) {
            let (center, radius_m) = (shape.pose.translation.vector.into(), shape.half_m.norm());
            blockers.add(center, radius_m, Form::Convex(shape.corners().to_vec()));
        }
        blockers
    }

    /// Updates what robots touch, and lists new contacts.
    fn update_contacts(&mut self) {
        let time_s = self.time_s();
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let mut touching = Vec::new();
            robot.pressed_bumpers = 0;
            for Touch { with, at, towards, ends, impulse_ns } in self.bodies.touches(index) {
                let touched_before = robot.touching.contains(&with);
                if impulse_ns <= 0.0 && !touched_before {
                    continue;
                }
                if let Some(spec) = &robot.spec.bumper {
                    robot.pressed_bumpers |= sensors::pressed(spec, &robot.pose, &ends);
                }
                if !touched_before {
                    let moving = robot.driven != Velocity::STOP;
                    let own_speed_mps = robot.speed_mps(&at, &towards);
                    let contact =
                        Contact { time_s, robot: index, with, at, moving, own_speed_mps, impulse_ns };
                    self.contacts.push(contact);
                }
                touching.push(with);
            }
            robot.touching = touching;
        }
    }

    /// The corners of what is to appear together with an obstacle that appears: the convex hull of its thing, so that no robot is
    /// ever between the legs of a chair.
    fn place(&self, index: usize) -> Vec<Point2<f64>> {
        let Some(own) = self.obstacles[index].spec.part else {
            return self.obstacles[index].shape.corners().to_vec();
        };
        let parts = self.obstacles.iter().filter(|other| other.spec.part == Some(own));
        convex::hull(parts.flat_map(|part| part.shape.corners()))
    }

    /// Makes obstacles appear and disappear. Each time, `report` receives the index of the obstacle, whether it
    /// appeared, and the walls and obstacles that are present now.
    pub(crate) fn update_obstacles(&mut self, mut report: impl FnMut(usize, bool, &[Rectangle])) {
        let time_s = self.time_s();
        for index in 0..self.obstacles.len() {
            let Some(is_present) = self.obstacles[index].due(time_s) else { continue };
            // If a body is in its place, an obstacle appears later; after its time to disappear, never.
            if is_present && !self.blockers().has_room(&self.place(index)) {
                continue;
            }
            self.obstacles[index].set_present(is_present, index, &mut self.bodies);
            self.show_obstacle(index);
            report(index, is_present, &self.standing_boxes());
        }
    }
}

/// A controller of driven robots: any type, or a closure that takes a robot and the reading of its main laser and
/// returns an [`interfaces::Twist`] or a [`Velocity`].
///
/// The fleet calls the controller at every scan of the main laser of a driven robot. Sensors that the controller does
/// not read are not simulated. The controller `&mut ()` gives no commands: the robots keep the command of
/// [`Fleet::command`](super::Fleet::command).
pub trait Controller {
    /// The new command; `None` if the robot keeps its command. The readings of all sensors are in the view of the
    /// robot. A command that contains NaN stops the robot; a command beyond the limits of the drive is limited to
    /// them.
    fn drive(&mut self, robot: &RobotView<'_>) -> Option<Velocity>;
}

impl<F, C> Controller for F
where
    F: FnMut(&RobotView<'_>, &LaserReading) -> C,
    C: Into<Velocity>,
{
    fn drive(&mut self, robot: &RobotView<'_>) -> Option<Velocity> {
        Some(self(robot, robot.reading()?).into())
    }
}

impl Controller for () {
    fn drive(&mut self, _: &RobotView<'_>) -> Option<Velocity> {
        None
    }
}

// Time that passes while all bodies rest.

impl Fleet {
    /// The number of steps, at most `most`, in which nothing happens in a world with a calendar: no body moves, and no
    /// obstacle is due to change. 0 in other worlds.
    ///
    /// Such steps are not simulated, however many of them are taken at once: a large step is many small ones, bit for bit.
    pub(crate) fn steps_at_rest(&mut self, most: u64) -> u64 {
        let Some(until_s) = self.rests_until_s() else { return 0 };
        // The step in which something happens, and the one before it, are simulated.
        let steps = ((until_s - self.time_s()) / self.spec().step_s - 1.0).floor();
        if steps >= most as f64 { most } else { steps.max(0.0) as u64 }
    }

    /// The time until which nothing happens in a world with a calendar, s; `None` if a body moves, and in other worlds.
    fn rests_until_s(&mut self) -> Option<f64> {
        if self.spec().starts_s.is_none() || !self.bodies.boxes_rest() {
            return None;
        }
        let (time_s, mut until_s) = (self.time_s(), f64::INFINITY);
        for robot in &self.robots {
            until_s = until_s.min(robot.rests_until_s()?);
        }
        for (index, obstacle) in self.obstacles.iter_mut().enumerate() {
            let is_needed = self.start.rooms.is_needed(index, &self.robots);
            until_s = until_s.min(obstacle.rests_until_s(time_s, is_needed)?);
        }
        Some(until_s)
    }

    /// Lets a number of [steps at rest](Self::steps_at_rest) pass.
    pub(crate) fn pass(&mut self, steps: u64) {
        self.step += steps;
        for _ in 0..steps.min(self.past.kept() as u64) {
            self.past.note(
                self.robots.iter().map(|robot| ([robot.pose; 2], robot.odometry_twist())),
                self.obstacles
                    .iter()
                    .map(|obstacle| obstacle.is_standing().then_some([obstacle.shape.pose; 2])),
            );
        }
    }
}
