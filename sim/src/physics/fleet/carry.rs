//! Robots that are set down elsewhere.

use super::Fleet;
use crate::physics::free_poses::FreePoses;
use interfaces::{RandomStream, heading_rad};
use nalgebra::Isometry2;
use std::f64::consts::PI;

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
