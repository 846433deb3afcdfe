//! What moves in a scene.

use interfaces::{CellReading, LaserReading};
use nalgebra::Isometry2;

/// A robot at one instant.
#[derive(Clone, Copy, Debug)]
pub struct RobotState<'a> {
    /// The pose in the frame of the world, m and rad. A robot in a grid world has no heading.
    pub pose: Isometry2<f64>,
    /// What the curious robot sees; `None` for every other robot.
    pub sight: Option<Sight<'a>>,
}

/// What a robot sees.
#[derive(Clone, Copy, Debug)]
pub enum Sight<'a> {
    /// The last scan of a laser.
    Laser(&'a LaserReading),
    /// Cells.
    Cells {
        /// The cells that are seen now.
        reading: &'a CellReading,
        /// The range of the sensor, cells.
        radius: u32,
    },
}
