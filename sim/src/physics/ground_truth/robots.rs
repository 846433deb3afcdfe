//! The cells under the robots.

use super::{PhysicsGroundTruth, cover};
use crate::physics::form::Form;
use crate::physics::report::Body;

impl PhysicsGroundTruth {
    /// Puts the robot with an index at its start, or moves the robot.
    pub(crate) fn move_robot(&mut self, robot: usize, to: &Form) {
        let mut after = Vec::new();
        cover::form_cells(&self.frame, to, |index, whole| after.push((index as u32, whole)));
        for &(index, whole) in &after {
            let passages = &mut self.passages[index as usize];
            passages.overlapped += 1;
            passages.covered += u16::from(whole);
            self.sweep(index as usize, Body::Robot(robot));
        }
        if self.under.len() <= robot {
            self.under.resize_with(robot + 1, Vec::new);
        }
        // First the cells that the robot was on.
        for (index, whole) in std::mem::take(&mut self.under[robot]) {
            let passages = &mut self.passages[index as usize];
            passages.overlapped -= 1;
            passages.covered -= u16::from(whole);
            self.settle(index as usize);
        }
        after.iter().for_each(|(index, _)| self.settle(*index as usize));
        self.under[robot] = after;
    }
}
