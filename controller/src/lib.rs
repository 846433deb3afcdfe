//! Drives the robot to a goal and explores around it (paper, section 2). It must not know how the map is
//! learned, who selects the goals, or which world the robot is in.
//!
//! ```text
//! map ─▶ Inflation ─▶ Costmap ─▶ Wavefront ─▶ Path ─▶ Drive ─▶ command
//! ```
//!
//! A loop needs only the [`Controller`]: set a goal, and pass a [`ControlInput`] at every tick. A [`Drive`]
//! describes the robot and converts paths into commands: [`DiffDrive`] for a differential drive robot, [`CellDrive`] for
//! a robot in a grid world.

mod controller;
mod driver;
mod drives;
mod dynamic_obstacles;
mod navigation;
mod planner;
#[cfg(test)]
mod tests;

pub use controller::Controller;
pub use driver::{ControlInput, Driver, DriverView, Outcome, Status};
pub use drives::{Body, CellDrive, DiffDrive, DiffDriveSettings, Drive, DriveScene};
pub use dynamic_obstacles::DynamicObstacleFilter;
pub use planner::{
    Costmap, DIAGONAL, FREE, Inflation, InflationSettings, LETHAL, MAX_COST, Moves, Path, PlanEnd, Planner,
    STRAIGHT, Wavefront,
};
