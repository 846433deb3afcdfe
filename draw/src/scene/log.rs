//! The scene of a log: a place of which nothing is known before.

use super::{Scene, SceneRobot, Sector};
use interfaces::{GridFrame, LaserReading};
use nalgebra::Isometry2;

/// The drawn radius of a robot of which a log says nothing, m.
const RADIUS_M: f64 = 0.25;

impl Scene {
    /// The scene of a log with this first reading.
    pub fn of_log(title: &str, frame: GridFrame, first: &LaserReading) -> Self {
        let scan = &first.scan;
        let angle_rad = scan.angle_increment_rad.abs() * scan.ranges_m.len().saturating_sub(1) as f64;
        let middle = scan.angle_rad(0) + scan.angle_increment_rad.signum() * angle_rad / 2.0;
        let mount = first.mount * interfaces::pose(0.0, 0.0, middle);
        let robot = SceneRobot {
            name: "the robot".to_owned(),
            pose: Isometry2::identity(),
            radius_m: RADIUS_M,
            corners: Vec::new(),
            sectors: vec![Sector { mount, angle_rad, range_m: scan.range_max_m }],
            is_driven: true,
        };
        Self {
            title: title.to_owned(),
            is_grid: false,
            frame,
            walls: Vec::new(),
            obstacles: Vec::new(),
            robots: vec![robot],
        }
    }

    /// Whether nothing but the robots is known before the run.
    pub fn is_unknown(&self) -> bool {
        self.walls.is_empty() && self.obstacles.is_empty()
    }
}
