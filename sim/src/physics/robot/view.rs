use super::SimulatedRobot;
use crate::physics::report::Body;
use crate::physics::sensors::{Sensor, SonarReading};
use interfaces::{LaserReading, Twist};
use nalgebra::{Isometry2, Point2};

/// The state of a robot, as controllers and viewers read it.
#[derive(Clone, Copy)]
pub struct RobotView<'a> {
    /// The index of the robot.
    pub index: usize,
    /// The name of the robot.
    pub name: &'a str,
    /// The true pose, m and rad.
    pub pose: Isometry2<f64>,
    /// The radius of the body, m. For a body with corners: the radius of the circle about its center that
    /// contains the body.
    pub radius_m: f64,
    /// The corners of the body in the frame of the robot, counter-clockwise, m. Empty if the body is round.
    pub corners: &'a [Point2<f64>],
    /// Whether the robot executes commands.
    pub is_driven: bool,
    /// The true velocity, m/s and rad/s.
    pub twist: Twist,
    /// The true velocity to the left, m/s: 0 except for an omni drive, and where a contact pushes the robot sideways.
    pub left_mps: f64,
    /// Whether a contact slowed the robot down in the last step.
    pub is_stalled: bool,
    /// The bodies that the robot touches now.
    pub touching: &'a [Body],
    robot: &'a SimulatedRobot,
}

impl<'a> RobotView<'a> {
    /// The pose and the velocity by odometry, with its errors, m and rad, m/s and rad/s.
    pub fn odometry(&self) -> (Isometry2<f64>, Twist) {
        (self.robot.odometry.pose, self.robot.odometry_twist())
    }

    /// The latest reading of the main laser scanner; `None` before the first measurement. As with all sensors, the
    /// reading is computed when it is first read.
    pub fn reading(&self) -> Option<&'a LaserReading> {
        self.robot.reading()
    }

    /// The latest reading of each laser scanner, in the order of the spec.
    pub fn lasers(&self) -> impl Iterator<Item = Option<&'a LaserReading>> + use<'a> {
        self.robot.sensors.iter().filter_map(Sensor::laser_reading)
    }

    /// The latest reading of each sonar, in the order of the spec.
    pub fn sonars(&self) -> impl Iterator<Item = Option<SonarReading>> + use<'a> {
        self.robot.sensors.iter().filter_map(Sensor::sonar_reading)
    }

    /// For each bumper, from right to left, whether it touches something now.
    pub fn bumpers(&self) -> impl ExactSizeIterator<Item = bool> + use<> {
        let pressed = self.robot.pressed_bumpers;
        let sectors = self.robot.spec.bumper.map_or(0, |bumper| bumper.sectors);
        (0..sectors).map(move |sector| pressed >> sector & 1 == 1)
    }
}

impl SimulatedRobot {
    /// The state of the robot, as controllers and viewers read it.
    pub(crate) fn view(&self) -> RobotView<'_> {
        RobotView {
            index: self.index,
            name: &self.spec.name,
            pose: self.pose,
            radius_m: self.spec.radius_m,
            corners: &self.spec.corners,
            is_driven: self.is_driven(),
            twist: self.velocity.twist(),
            left_mps: self.velocity.left_mps,
            is_stalled: self.drive.is_stalled,
            touching: &self.touching,
            robot: self,
        }
    }
}
