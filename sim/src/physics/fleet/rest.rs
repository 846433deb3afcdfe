//! Time that passes while all bodies rest.

use super::Fleet;

impl Fleet {
    /// The number of steps, at most `most`, in which nothing happens in a world with a calendar: no body moves, and no
    /// obstacle is due to change. 0 in other worlds.
    ///
    /// Such steps are not simulated, however many of them are taken at once: a large step is many small ones, bit for bit.
    pub(crate) fn steps_at_rest(&mut self, most: u64) -> u64 {
        let time_s = self.time_s();
        if self.spec().starts_s.is_none() || !self.bodies.boxes_rest() {
            return 0;
        }
        let mut until_s = f64::INFINITY;
        for robot in &self.robots {
            match robot.rests_until_s() {
                Some(robot_s) => until_s = until_s.min(robot_s),
                None => return 0,
            }
        }
        for (index, obstacle) in self.obstacles.iter_mut().enumerate() {
            let is_needed = self.start.rooms.is_needed(index, &self.robots);
            match obstacle.rests_until_s(time_s, is_needed) {
                Some(obstacle_s) => until_s = until_s.min(obstacle_s),
                None => return 0,
            }
        }
        // The step in which something happens, and the one before it, are simulated.
        let steps = ((until_s - time_s) / self.spec().step_s - 1.0).floor();
        if steps >= most as f64 { most } else { steps.max(0.0) as u64 }
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
