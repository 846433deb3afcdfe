//! Readings that a localizer must not believe.

use crate::constants::FROZEN_MOTION;
use crate::scan_points::ScanPoint;
use interfaces::{LaserReading, is_valid_pose};
use nalgebra::Isometry2;

/// A fault of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// The scan or a pose is not valid: nothing can be learned from the reading.
    Invalid,
    /// The scan is that of an earlier reading, though the robot moved.
    Frozen,
    /// The time is not after that of the last reading.
    Time,
}

/// Remembers what is needed to find faults.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct FaultFinder {
    time_s: Option<f64>,
    ranges_m: Vec<f32>,
    /// The odometry when the present scan was first seen.
    odometry: Option<Isometry2<f64>>,
}

impl FaultFinder {
    /// The fault of a reading, if it has one.
    pub(crate) fn find(&mut self, reading: &LaserReading) -> Option<Fault> {
        let LaserReading { time_s, pose, mount, scan, .. } = reading;
        if scan.check().is_err() || !is_valid_pose(pose) || !is_valid_pose(mount) || !time_s.is_finite() {
            return Some(Fault::Invalid);
        }
        let is_old = self.time_s.is_some_and(|last| *time_s <= last);
        if !is_old {
            self.time_s = Some(*time_s);
        }
        let ranges = scan.ranges_m.iter().map(|range_m| range_m.to_bits());
        let is_same = ranges.eq(self.ranges_m.iter().map(|range_m| range_m.to_bits()));
        if !is_same {
            self.ranges_m.clone_from(&scan.ranges_m);
            self.odometry = Some(*pose);
        }
        let moved = self.odometry.map_or(Isometry2::identity(), |first| first.inv_mul(pose));
        let has_moved = !FROZEN_MOTION.contains(&moved);
        if is_same && has_moved && scan.ranges_m.iter().any(|range_m| range_m.is_finite()) {
            Some(Fault::Frozen)
        } else {
            is_old.then_some(Fault::Time)
        }
    }
}

/// The points as a laser that hangs upside down would see them.
pub(crate) fn mirrored(points: &[ScanPoint], mount: &Isometry2<f64>) -> Vec<ScanPoint> {
    let mirror = |point: &ScanPoint| {
        let (mut at, mut normal) =
            (mount.inverse_transform_point(&point.at), mount.rotation.inverse() * point.normal);
        at.y = -at.y;
        normal.y = -normal.y;
        ScanPoint { at: mount * at, normal: mount.rotation * normal, ..*point }
    };
    points.iter().map(mirror).collect()
}
