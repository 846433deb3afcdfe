use crate::scan_points::ScanPoint;
use nalgebra::{Isometry2, Point2, Vector2, Vector3};

/// Where a scan lies on the map: the pose at its end, and for a scan that sweeps the pose at its begin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// The pose at the end of the scan.
    pub(crate) pose: Isometry2<f64>,
    /// The pose for which the scan was deskewed.
    deskewed: Isometry2<f64>,
    /// How far the robot was from where it was expected at the last scan, where the way begins: x, y (m) and heading
    /// (rad). `None` for a rigid scan, whose points move with the pose.
    begin: Option<Vector3<f64>>,
}

impl Placement {
    /// A rigid scan.
    pub(crate) fn rigid(pose: &Isometry2<f64>) -> Self {
        Self { pose: *pose, deskewed: *pose, begin: None }
    }

    /// A scan whose begin and end can move apart.
    pub(crate) fn elastic(pose: &Isometry2<f64>) -> Self {
        Self { begin: Some(Vector3::zeros()), ..Self::rigid(pose) }
    }

    /// How far the robot was from where it was expected at the last scan.
    pub(crate) fn begin(&self) -> Vector3<f64> {
        self.begin.unwrap_or_default()
    }

    /// The share with which a point follows the pose at the end; the rest follows the begin.
    #[inline]
    pub(crate) fn share(&self, point: &ScanPoint) -> f64 {
        if self.begin.is_some() { point.passed } else { 1.0 }
    }

    /// The place of a point on the map. What the robot moved more or less than was expected, it did on the whole way
    /// since the last scan: a beam from the middle of the way is off by half of it.
    #[inline]
    pub(crate) fn place(&self, point: &ScanPoint) -> Point2<f64> {
        let end = self.pose * point.at;
        match self.begin {
            Some(begin) if point.passed < 1.0 => {
                let expected = self.deskewed * point.at;
                let arm = expected - Point2::from(self.deskewed.translation.vector);
                let shift = begin.xy() + Vector2::new(-arm.y, arm.x) * begin.z;
                (expected + shift).lerp(&end, point.passed)
            }
            _ => end,
        }
    }

    /// Moves the end, and the begin of an elastic scan.
    pub(crate) fn correct(&mut self, end: &Vector3<f64>, begin: &Vector3<f64>) {
        self.pose = shifted(&self.pose, end);
        if let Some(at) = &mut self.begin {
            *at += begin;
        }
    }
}

/// A pose after a shift in the frame of the map, and a turn about the robot.
pub(crate) fn shifted(pose: &Isometry2<f64>, by: &Vector3<f64>) -> Isometry2<f64> {
    let mut shifted = *pose;
    shifted.translation.vector += by.xy();
    shifted.rotation = interfaces::rotation(by.z) * pose.rotation;
    shifted
}
