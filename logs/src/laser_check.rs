//! What the scans of a robot say about its lasers.

use crate::beam_order::BeamOrder;
use crate::own_parts::OwnParts;
use interfaces::LaserReading;
use nalgebra::Isometry2;

/// Lasers beyond this number are not looked at.
pub(crate) const MAX_LASERS: usize = 8;

/// Learns from readings which ranges of a laser are parts of the robot itself, and in which order it measures its beams.
#[derive(Clone, Debug, Default)]
pub struct LaserCheck {
    /// The lasers by their place on the robot.
    pub(crate) lasers: Vec<(Isometry2<f64>, OwnParts, BeamOrder)>,
}

impl LaserCheck {
    /// Learns from the next reading, as it was measured, with its pose by odometry.
    pub fn add(&mut self, reading: &LaserReading) {
        let is_new = self.lasers.iter().all(|(mount, ..)| *mount != reading.mount);
        if is_new && self.lasers.len() < MAX_LASERS {
            self.lasers.push((reading.mount, OwnParts::default(), BeamOrder::default()));
        }
        for (_, own_parts, order) in self.lasers.iter_mut().filter(|(mount, ..)| *mount == reading.mount) {
            own_parts.add(reading);
            order.add(reading);
        }
    }

    /// Decides by the readings so far what [`apply`](Self::apply) does. Returns notes on what is known now and was not before.
    pub fn judge(&mut self) -> Vec<String> {
        let notes =
            self.lasers.iter_mut().flat_map(|(_, own_parts, order)| [own_parts.judge(), order.judge()]);
        notes.flatten().collect()
    }

    /// Makes ranges of the robot's own parts invalid, and puts the beams in the order in which they are measured.
    pub fn apply(&self, reading: &mut LaserReading) {
        let of_reading = reading.mount;
        for (_, own_parts, order) in self.lasers.iter().filter(|(mount, ..)| *mount == of_reading) {
            own_parts.remove(reading);
            order.apply(reading);
        }
    }
}
