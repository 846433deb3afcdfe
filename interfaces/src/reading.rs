use crate::{Cell, Scan, Twist};
use nalgebra::Isometry2;

/// The content that every reading has, in every world.
pub trait Reading {
    /// The time of the reading: seconds, or steps in a grid world.
    fn time(&self) -> f64;

    /// The estimated pose of the robot in the frame of the map, m and rad.
    fn pose(&self) -> &Isometry2<f64>;

    /// What a map can learn from the reading.
    fn observation(&self) -> Observation<'_>;
}

/// What a map can learn from a reading.
#[derive(Clone, Copy, Debug)]
pub enum Observation<'a> {
    /// The ranges of a laser: evidence from which the states of cells are inferred.
    Scan(&'a LaserReading),
    /// The states of cells, without error.
    Cells(&'a CellReading),
}

/// A laser scan with the pose of the same instant.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct LaserReading {
    /// The time of scan and pose, s.
    pub time_s: f64,
    /// The robot's pose in the map's frame, by odometry.
    #[serde(with = "crate::serde_pose")]
    pub pose: Isometry2<f64>,
    /// The robot's velocity, by odometry.
    pub twist: Twist,
    /// The laser's pose in the robot's frame.
    #[serde(with = "crate::serde_pose")]
    pub mount: Isometry2<f64>,
    /// The scan, in the laser's frame.
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
    /// The pose of the robot in the frame of the map.
    pub pose: Isometry2<f64>,
    /// The cells in view, each with whether it is blocked. Cells outside of the map are ignored.
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
