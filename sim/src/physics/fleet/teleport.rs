//! Setting robots down somewhere else.

use super::{Fleet, corners};
use crate::physics::shape::{Rectangle, TOUCH_M};
use crate::physics::spec::RobotSpec;
use geometry::heading_rad;
use nalgebra::{Isometry2, Point2};

/// Why a robot stayed where it was.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TeleportError {
    /// There are fewer robots.
    #[error("there is no robot {robot}: there are {robots}, counted from 0")]
    NoSuchRobot {
        /// The one asked for.
        robot: usize,
        /// How many there are.
        robots: usize,
    },
    /// It would reach out of the map, or a number is not finite.
    #[error("[{x_m}, {y_m}] is not within the map")]
    Outside {
        /// The place asked for, m.
        x_m: f64,
        /// The place asked for, m.
        y_m: f64,
    },
    /// A wall, an obstacle or another robot is there.
    #[error("at [{x_m:.3}, {y_m:.3}] there is something else")]
    Occupied {
        /// The place asked for, m.
        x_m: f64,
        /// The place asked for, m.
        y_m: f64,
    },
}

impl Fleet {
    /// Sets a robot (by its place in the world file) down at `pose`, at rest. It knows where it is
    /// then, as at the start, and looks around when its next scan is due.
    ///
    /// # Errors
    ///
    /// When there is no such robot, or it would not fit there; everything stays as it was.
    pub fn teleport(&mut self, robot: usize, pose: &Isometry2<f64>) -> Result<(), TeleportError> {
        let Some(RobotSpec { radius_m, .. }) = self.spec.robots.get(robot) else {
            return Err(TeleportError::NoSuchRobot { robot, robots: self.robots.len() });
        };
        let at = Point2::from(pose.translation.vector);
        let (low, high) = corners(&self.spec.frame);
        let inside_m = (at - low).min().min((high - at).min());
        let heading_rad = heading_rad(pose);
        // Not a number is in no range.
        if !(inside_m >= radius_m - TOUCH_M && heading_rad.is_finite()) {
            return Err(TeleportError::Outside { x_m: at.x, y_m: at.y });
        }
        let is_in = |shape: &Rectangle| shape.distance_m(&at) < radius_m - TOUCH_M;
        let others = self.robots.iter().enumerate().filter(|(index, _)| *index != robot);
        let mut gaps = others.map(|(_, other)| (other.at() - at).norm() - other.spec.radius_m);
        if self.standing_boxes().iter().any(is_in) || gaps.any(|gap_m| gap_m < radius_m - TOUCH_M) {
            return Err(TeleportError::Occupied { x_m: at.x, y_m: at.y });
        }
        self.bodies.put(robot, &geometry::pose(at.x, at.y, heading_rad));
        self.robots[robot].put(self.bodies.pose(robot));
        self.scene.move_disc(robot, self.robots[robot].at());
        Ok(())
    }
}
