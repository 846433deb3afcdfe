use crate::{Cell, Scan, Twist};
use nalgebra::Isometry2;

/// What every reading contains, in every world.
pub trait Reading {
    /// The time of the reading: seconds, or steps in a grid world.
    fn time(&self) -> f64;

    /// The estimated pose of the robot in the frame of the map, m and rad.
    fn pose(&self) -> &Isometry2<f64>;

    /// The observation from which a map is updated.
    fn observation(&self) -> Observation<'_>;
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
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
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
