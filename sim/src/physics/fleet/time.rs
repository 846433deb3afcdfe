//! How time passes.

use super::{Controller, Fleet};
use crate::physics::bodies::Touch;
use crate::physics::bumper;
use crate::physics::form::Form;
use crate::physics::obstacles::{InTheWay, Obstacle};
use crate::physics::rays::Scratch;
use crate::physics::report::{Contact, Move};
use crate::physics::robot::{Now, Robot};
use crate::physics::shape::Rectangle;
use rayon::prelude::*;

impl Fleet {
    /// Lets one physics step pass. Robots whose scan is due look around first, and decide; those
    /// that are driven ask `controller`.
    pub fn step(&mut self, controller: &mut impl Controller) {
        self.contacts.clear();
        self.take_step(controller);
    }

    fn take_step(&mut self, controller: &mut impl Controller) {
        self.think(|_| true);
        for robot in &mut self.robots {
            if robot.is_driven()
                && robot.is_due(self.step)
                && let Some(sweep) = robot.sweep()
                && let Some(wanted) = controller.drive(&robot.view(), &sweep.reading)
            {
                robot.command(&wanted);
            }
        }
        self.advance();
        self.move_obstacles(|_, _, _| ());
    }

    /// Steps until `time_s` has come, s.
    pub fn run_until(&mut self, time_s: f64, controller: &mut impl Controller) {
        self.contacts.clear();
        // Half a microsecond of slack: times are multiples of the step.
        while self.time_s() < time_s - 5e-7 {
            self.take_step(controller);
        }
    }

    /// Lets the robots that `is_meant` look and decide, where their next scan is due.
    pub(in crate::physics) fn think(&mut self, is_meant: impl Fn(&Robot) -> bool + Sync) {
        let (step, time_s) = (self.step, self.time_s());
        let is_due = |robot: &&mut Robot| robot.looks(step) && is_meant(robot);
        if !self.robots.iter_mut().any(|robot| is_due(&robot)) {
            return;
        }
        self.scene.sort();
        let tagged = self.tagged();
        let now = &Now { step, time_s, scene: &self.scene, tagged: &tagged };
        if self.parallel_lasers {
            let due = self.robots.par_iter_mut().filter(is_due);
            due.for_each_init(Scratch::default, |scratch, robot| robot.think(now, scratch));
        } else {
            let due = self.robots.iter_mut().filter(is_due);
            due.for_each(|robot| robot.think(now, &mut self.scratch));
        }
    }

    /// Lets everything that drives do so for one physics step.
    pub(in crate::physics) fn advance(&mut self) {
        for robot in &mut self.robots {
            robot.push(&mut self.bodies, self.spec.step_s);
        }
        let before: Vec<Rectangle> = self.obstacles.iter().map(|obstacle| obstacle.shape).collect();
        self.step += 1;
        self.set_obstacles_out();
        self.bodies.step();
        for index in 0..self.robots.len() {
            self.robots[index].follow(&self.bodies);
            self.show_robot(index);
        }
        self.moved.clear();
        for (index, before) in before.into_iter().enumerate() {
            self.obstacles[index].follow(&mut self.bodies);
            if self.obstacles[index].shape != before {
                self.moved.push((index, before));
                self.show_obstacle(index);
            }
        }
        self.note_contacts();
    }

    /// Sends doors and blocks on their way for the step that has begun.
    fn set_obstacles_out(&mut self) {
        if !self.obstacles.iter().any(Obstacle::moves_itself) {
            return;
        }
        let (time_s, in_the_way) = (self.time_s(), self.in_the_way());
        for obstacle in &mut self.obstacles {
            obstacle.set_out(time_s, self.spec.step_s, &mut self.bodies, &in_the_way);
        }
    }

    /// Everything that an obstacle has to wait for.
    fn in_the_way(&self) -> InTheWay {
        let mut in_the_way = InTheWay::default();
        for robot in &self.robots {
            in_the_way.add(robot.at(), robot.spec.radius_m, robot.form());
        }
        for Obstacle { shape, .. } in self.obstacles.iter().filter(|obstacle| obstacle.is_pushed()) {
            let (center, radius_m) = (shape.pose.translation.vector.into(), shape.half_m.norm());
            in_the_way.add(center, radius_m, Form::Convex(shape.corners().to_vec()));
        }
        in_the_way
    }

    /// Notes what robots touch, and have begun to touch.
    fn note_contacts(&mut self) {
        let time_s = self.time_s();
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let mut touching = Vec::new();
            robot.pressed = 0;
            for Touch { with, at, ends, impulse_ns } in self.bodies.touches(index) {
                let touched_before = robot.touching.contains(&with);
                if impulse_ns <= 0.0 && !touched_before {
                    continue;
                }
                if let Some(spec) = &robot.spec.bumper {
                    robot.pressed |= bumper::pressed(spec, &robot.pose, &ends);
                }
                if !touched_before {
                    let moving = robot.drove;
                    self.contacts.push(Contact { time_s, robot: index, with, at, moving, impulse_ns });
                }
                touching.push(with);
            }
            robot.touching = touching;
        }
    }

    /// Lets obstacles come and go; `tell` hears of each at once: which it is, what it did, and
    /// the walls and obstacles that stand now.
    pub(in crate::physics) fn move_obstacles(&mut self, mut tell: impl FnMut(usize, Move, &[Rectangle])) {
        let time_s = self.time_s();
        for index in 0..self.obstacles.len() {
            if !self.obstacles[index].is_due(time_s) {
                continue;
            }
            let in_the_way = self.in_the_way();
            let what = self.obstacles[index].come_or_go(index, time_s, &mut self.bodies, &in_the_way);
            if let Some(what) = what {
                self.show_obstacle(index);
                tell(index, what, &self.standing_boxes());
            }
        }
    }
}
