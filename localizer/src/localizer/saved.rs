//! A localizer in a state file, and in the next session.

use super::{LOST_STD_M, LOST_STD_RAD, Localizer};
use crate::estimate::PoseState;
use crate::faults::FaultFinder;
use crate::hypotheses::Hypotheses;
use interfaces::{Value, ValueError, Values, read_value, value, write_value};
use nalgebra::{Isometry2, Matrix3, Vector3};
use serde::{Serialize, de::DeserializeOwned};

impl Localizer {
    /// Everything that readings have changed, as bytes; settings are not in it.
    pub fn snapshot(&mut self) -> Vec<u8> {
        // The scores of an earlier line map are never used again.
        let revision = self.surfels.revision();
        self.scores = self.scores.take().filter(|(known, _)| *known == revision);
        interfaces::snapshot(self.values())
    }

    /// Goes on from the snapshot of a localizer with the same settings and the same frame, bit for bit.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot. The localizer must not be used then.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        interfaces::restore(self.values(), snapshot)
    }

    /// Begins another session in the map that was learned: the robot can be anywhere in it. What was learned about the
    /// odometry holds on. Without a map, the session begins as the first one.
    pub fn begin_session(&mut self) {
        self.faults = FaultFinder::default();
        (self.hypotheses, self.wide) = (Hypotheses::default(), None);
        (self.odometry, self.supported_s) = (None, None);
        (self.last_motion, self.measured) = (Isometry2::identity(), Isometry2::identity());
        (self.follower, self.distrust, self.readings) = (None, 0, 0);
        (self.verification, self.ignores_guide, self.certain_s) = (None, false, f64::NEG_INFINITY);
        (self.since_search, self.accepted_support) = (u32::MAX, self.settings.min_support);
        (self.start_s, self.scores) = (None, None);
        if self.surfels.is_empty() {
            return;
        }
        // A robot that is lost looks around; it does not rest.
        self.start_s = Some(f64::NEG_INFINITY);
        self.state = PoseState::Lost;
        let std = Vector3::new(LOST_STD_M, LOST_STD_M, LOST_STD_RAD);
        self.covariance = Matrix3::from_diagonal(&std.component_mul(&std));
    }

    fn values(&mut self) -> Values<'_> {
        let mut values = self.surfels.values();
        values.extend([
            value(&mut self.checker),
            value(&mut self.faults),
            value(&mut self.calibration),
            value(&mut self.scores),
            value(&mut self.hypotheses),
            value(&mut self.pose),
            value(&mut self.covariance),
            value(&mut self.state),
            value(&mut self.odometry),
            value(&mut self.last_motion),
            value(&mut self.begin),
            value(&mut self.measured),
            value(&mut self.time_s),
            value(&mut self.supported_s),
            value(&mut self.start_s),
            value(&mut self.from_nothing),
            value(&mut self.by_odometry),
            value(&mut self.certain_s),
            value(&mut self.verification),
            value(&mut self.learns),
            value(&mut self.distrust),
            value(&mut self.readings),
            value(&mut self.since_search),
            value(&mut self.accepted_support),
            value(&mut self.ignores_guide),
            Box::new(IfAny(&mut self.wide)),
        ]);
        values
    }
}

/// The last value of a part, which takes no bytes where there is none: states from before it existed stay readable.
struct IfAny<'a, T>(&'a mut Option<T>);

impl<T: Serialize + DeserializeOwned> Value for IfAny<'_, T> {
    fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        self.0.as_ref().map_or(Ok(()), |any| write_value(any, bytes))
    }

    fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
        *self.0 = if bytes.is_empty() { None } else { Some(read_value(bytes)?) };
        Ok(())
    }
}
