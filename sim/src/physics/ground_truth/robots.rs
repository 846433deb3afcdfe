//! The cells under the robots.

use super::{PhysicsGroundTruth, cover};
use crate::physics::form::Form;
use crate::physics::report::Body;

impl PhysicsGroundTruth {
    /// Puts the robot with an index at its start, or moves the robot.
    pub(crate) fn move_robot(&mut self, robot: usize, to: &Form) {
        let mut after = std::mem::take(&mut self.spare);
        after.clear();
        cover::form_cells(&self.frame, to, |index, whole| after.push((index as u32, whole)));
        if self.under.len() <= robot {
            self.under.resize_with(robot + 1, Vec::new);
        }
        let before = std::mem::replace(&mut self.under[robot], after);
        let mut changes = std::mem::take(&mut self.under_changes);
        differences(&before, &self.under[robot], &mut changes);
        for &UnderChange { index, before, after } in &changes {
            if let Some(whole) = after {
                let passages = &mut self.passages[index];
                passages.overlapped += 1;
                passages.covered += u16::from(whole);
                if before.is_none() {
                    self.sweep(index, Body::Robot(robot));
                }
            }
        }
        // First the cells that the robot was on.
        for &UnderChange { index, before, .. } in &changes {
            if let Some(whole) = before {
                let passages = &mut self.passages[index];
                passages.overlapped -= 1;
                passages.covered -= u16::from(whole);
                self.settle(index);
            }
        }
        changes.iter().filter(|change| change.before.is_none()).for_each(|change| self.settle(change.index));
        (self.spare, self.under_changes) = (before, changes);
    }
}

/// A cell under a robot before a step or after it: each time, whether the robot covers all of the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnderChange {
    index: usize,
    before: Option<bool>,
    after: Option<bool>,
}

/// The cells that differ between two lists of cells under a robot, both in order of the index.
fn differences(before: &[(u32, bool)], after: &[(u32, bool)], changes: &mut Vec<UnderChange>) {
    changes.clear();
    let (mut before, mut after) = (before.iter().copied().peekable(), after.iter().copied().peekable());
    loop {
        let next = [before.peek(), after.peek()].map(|next| next.map_or(u32::MAX, |(index, _)| *index));
        let index = next[0].min(next[1]);
        let [was, is] = [before.next_if(|(own, _)| *own == index), after.next_if(|(own, _)| *own == index)]
            .map(|cell| cell.map(|(_, whole)| whole));
        if was.is_none() && is.is_none() {
            return;
        }
        if was != is {
            changes.push(UnderChange { index: index as usize, before: was, after: is });
        }
    }
}
