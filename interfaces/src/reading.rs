use crate::{Cell, Scan, Twist};
use nalgebra::Isometry2;

/// What every reading tells, whatever the world.
pub trait Reading {
    /// The time of the reading: seconds, or steps in a grid world.
    fn time(&self) -> f64;

    /// Where the robot believes it is, in the map's frame, m and rad.
    fn pose(&self) -> &Isometry2<f64>;
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
}

/// The cells that a sensor without error sees.
#[derive(Clone, Debug, PartialEq)]
pub struct CellReading {
    /// The time of the reading, in steps.
    pub time: f64,
    /// Where the robot is, in the map's frame.
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
}
