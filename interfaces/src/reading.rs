use crate::{Cell, Scan, Twist};
use nalgebra::{Isometry2, Point2, Vector2};

/// What every reading contains, in every world.
pub trait Reading {
    /// The time of the reading: seconds, or steps in a grid world.
    fn time(&self) -> f64;

    /// The estimated pose of the robot in the frame of the map, m and rad.
    fn pose(&self) -> &Isometry2<f64>;

    /// The observation from which a map is updated.
    fn observation(&self) -> Observation<'_>;

    /// The reading of the laser; `None` of a sensor without error.
    fn laser_mut(&mut self) -> Option<&mut LaserReading> {
        None
    }
}

/// The observation from which a map is updated.
#[derive(Clone, Copy, Debug)]
pub enum Observation<'a> {
    /// The ranges of a laser: evidence from which the states of cells are inferred.
    Scan(&'a LaserReading),
    /// The states of cells, without error.
    Cells(&'a CellReading),
}

/// The mean velocity of a robot over an interval that ends at a time; it begins at the time of the sample before.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct VelocitySample {
    /// The end of the interval, s.
    pub time_s: f64,
    /// The mean velocity, by odometry, m/s and rad/s.
    pub twist: Twist,
}

/// A laser scan, and the pose of the robot at the same time. A scan that sweeps ([`Scan::sweep_s`]) ends at this time.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct LaserReading {
    /// The time of the last beam of the scan and of the pose, s.
    pub time_s: f64,
    /// The pose of the robot in the frame of the map, by odometry, m and rad.
    #[serde(with = "crate::serde_pose")]
    pub pose: Isometry2<f64>,
    /// The velocity of the robot, by odometry, m/s and rad/s.
    pub twist: Twist,
    /// The velocities of the robot, by odometry, while the scan was measured, the earliest first. Empty if the source
    /// knows only `twist`. A scan that sweeps needs them: the robot may brake or start to turn within a scan.
    #[serde(default)]
    pub velocities: Vec<VelocitySample>,
    /// The pose of the laser in the frame of the robot, m and rad.
    #[serde(with = "crate::serde_pose")]
    pub mount: Isometry2<f64>,
    /// The scan, in the frame of the laser.
    pub scan: Scan,
}

impl LaserReading {
    /// The points that the beams hit, in the frame of the robot, m: one per range within the limits of the scan
    /// (REP-117), in the order of the beams.
    pub fn hits(&self) -> impl Iterator<Item = Point2<f64>> {
        let scan = &self.scan;
        let limits_m = scan.range_min_m..=scan.range_max_m;
        let ranges_m = scan.ranges_m.iter().map(|range_m| f64::from(*range_m)).enumerate();
        ranges_m.filter(move |(_, range_m)| limits_m.contains(range_m)).map(|(beam, range_m)| {
            let along = crate::rotation(scan.angle_rad(beam)) * Vector2::new(range_m, 0.0);
            self.mount * Point2::from(along)
        })
    }
}

impl Reading for LaserReading {
    fn time(&self) -> f64 {
        self.time_s
    }

    fn pose(&self) -> &Isometry2<f64> {
        &self.pose
    }

    fn observation(&self) -> Observation<'_> {
        Observation::Scan(self)
    }

    fn laser_mut(&mut self) -> Option<&mut LaserReading> {
        Some(self)
    }
}

/// The cells that a sensor without error observes.
#[derive(Clone, Debug, PartialEq)]
pub struct CellReading {
    /// The time of the reading, in steps.
    pub time: f64,
    /// The pose of the robot in the frame of the map, m and rad.
    pub pose: Isometry2<f64>,
    /// The cells in view, and for each cell whether it is blocked. Cells outside of the map are ignored.
    pub cells: Vec<(Cell, bool)>,
}

impl Reading for CellReading {
    fn time(&self) -> f64 {
        self.time
    }

    fn pose(&self) -> &Isometry2<f64> {
        &self.pose
    }

    fn observation(&self) -> Observation<'_> {
        Observation::Cells(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn hits_are_in_the_frame_of_the_robot_and_within_the_limits() {
        let nothing = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 0.05, 8.5];
        let reading = LaserReading {
            pose: crate::pose(5.0, 5.0, 1.0), // has no influence
            mount: crate::pose(0.2, 0.0, FRAC_PI_2),
            scan: Scan {
                angle_min_rad: -FRAC_PI_2,
                angle_increment_rad: FRAC_PI_2 / 6.0,
                range_min_m: 0.1,
                range_max_m: 8.0,
                ranges_m: [&[2.0][..], &nothing, &[8.0]].concat(),
                ..Scan::default()
            },
            ..LaserReading::default()
        };
        let hits: Vec<_> = reading.hits().collect();
        // The first beam points ahead of the robot, the last one to its left.
        let expected = [Point2::new(2.2, 0.0), Point2::new(0.2, 8.0)];
        assert_eq!(hits.len(), expected.len());
        assert!(hits.iter().zip(&expected).all(|(hit, at)| (hit - at).norm() < 1e-12), "{hits:?}");
    }
}
