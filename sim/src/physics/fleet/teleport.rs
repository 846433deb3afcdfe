//! Putting robots at other poses.

use super::Fleet;
use crate::physics::free_space::FreePoses;
use crate::physics::robot::SimulatedRobot;
use crate::physics::shape::{Rectangle, TOUCH_M, grid_corners};
use interfaces::{RandomStream, heading_rad};
use nalgebra::{Isometry2, Point2};
use std::f64::consts::PI;

/// The error for a robot that was not moved.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TeleportError {
    /// The index is too large.
    #[error("there is no robot {robot}: there are {robots}, counted from 0")]
    NoSuchRobot {
        /// The requested index.
        robot: usize,
        /// The number of robots.
        robots: usize,
    },
    /// A part of the robot would be outside of the map, or a number is not finite.
    #[error("[{x_m}, {y_m}] is not within the map")]
    Outside {
        /// The x coordinate of the requested position, m.
        x_m: f64,
        /// The y coordinate of the requested position, m.
        y_m: f64,
    },
    /// A wall, an obstacle or another robot is at the requested pose.
    #[error("at [{x_m:.3}, {y_m:.3}] there is something else")]
    Occupied {
        /// The x coordinate of the requested position, m.
        x_m: f64,
        /// The y coordinate of the requested position, m.
        y_m: f64,
    },
}

impl Fleet {
    /// Moves a robot (by index) to `pose`, at rest. The odometry is then exact, as at the start, and the sensors
    /// measure when they are due.
    ///
    /// # Errors
    ///
    /// When there is no such robot, or when the robot does not fit at the pose. The state is then unchanged.
    pub fn teleport(&mut self, robot: usize, pose: &Isometry2<f64>) -> Result<(), TeleportError> {
        self.check_fit(robot, pose)?;
        let at = pose.translation.vector;
        self.bodies.put(robot, &interfaces::pose(at.x, at.y, heading_rad(pose)));
        self.robots[robot].put(self.bodies.pose(robot));
        self.past.put(robot, &self.robots[robot].pose);
        self.show_robot(robot);
        Ok(())
    }

    /// Checks that a robot (by index) fits at `pose` now.
    ///
    /// # Errors
    ///
    /// The errors of [`Fleet::teleport`].
    pub fn check_fit(&self, robot: usize, pose: &Isometry2<f64>) -> Result<(), TeleportError> {
        let Some(spec) = self.spec().robots.get(robot) else {
            return Err(TeleportError::NoSuchRobot { robot, robots: self.robots.len() });
        };
        let at = Point2::from(pose.translation.vector);
        let ((low, high), form) = (grid_corners(&self.spec().frame), spec.form(pose));
        let (least, most) = form.bounds();
        let inside_m = (least - low).min().min((high - most).min());
        let is_finite = at.x.is_finite() && at.y.is_finite() && heading_rad(pose).is_finite();
        if !is_finite || inside_m < -TOUCH_M {
            return Err(TeleportError::Outside { x_m: at.x, y_m: at.y });
        }
        let is_in = |shape: &Rectangle| form.gap_m(&shape.corners()) < -TOUCH_M;
        let mut others = self.robots.iter().enumerate().filter(|(index, _)| *index != robot);
        let meets = |(_, other): (usize, &SimulatedRobot)| form.apart_m(&other.form()) < -TOUCH_M;
        if self.standing_boxes().iter().any(is_in) || others.any(meets) {
            return Err(TeleportError::Occupied { x_m: at.x, y_m: at.y });
        }
        Ok(())
    }
}

// Robots that are set down elsewhere.

/// The number of poses that are tried for a robot.
const ATTEMPTS: usize = 100;

impl Fleet {
    /// A pose with any heading in `free`, at which the robot (by index) fits in the fleet as it is now; `None` if others
    /// stand at each of a hundred such poses, or if there is no such robot.
    pub fn draw_pose(
        &self,
        free: &FreePoses,
        robot: usize,
        random: &mut RandomStream,
    ) -> Option<Isometry2<f64>> {
        let mut poses = (0..ATTEMPTS).map(|_| {
            let at = free.draw_point(random);
            interfaces::pose(at.x, at.y, random.uniform(-PI..PI))
        });
        poses.find(|pose| self.check_fit(robot, pose).is_ok())
    }

    /// Carries away the robots for which it is time.
    pub(super) fn carry_robots(&mut self) {
        let time_s = self.time_s();
        for index in 0..self.robots.len() {
            let robot = &mut self.robots[index];
            let Some(mut carried) = robot.carried.take_if(|carried| carried.is_due(time_s)) else { continue };
            let (from, heading_rad) = (robot.at(), heading_rad(&robot.pose));
            let mut poses = (0..ATTEMPTS).map(|_| {
                let (at, heading_rad) = carried.draw(&from, heading_rad);
                interfaces::pose(at.x, at.y, heading_rad)
            });
            let is_good = |pose: &Isometry2<f64>| {
                let reached = self.start.carried[index].as_ref();
                reached.is_some_and(|reached| reached.contain(&pose.translation.vector.into()))
                    && self.check_fit(index, pose).is_ok()
            };
            if let Some(pose) = poses.find(is_good) {
                self.bodies.put(index, &pose);
                self.robots[index].carry(self.bodies.pose(index));
                self.show_robot(index);
            }
            self.robots[index].carried = Some(carried);
        }
    }
}
