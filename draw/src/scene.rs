//! The parts of a world that are constant during a run, as plain data.

use crate::palette::{self, Rgb};
use interfaces::{GridFrame, LaserReading};
use nalgebra::{Isometry2, Point2, Vector2};

/// The corners of a polygon, m; the last corner is joined to the first.
pub type Outline = Vec<Point2<f64>>;

/// A world from above, at its start.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The name of the world.
    pub title: String,
    /// Whether it is a grid world: lengths are in cells, and robots have no heading.
    pub is_grid: bool,
    /// The rectangle that is shown, and its cells.
    pub frame: GridFrame,
    /// The walls.
    pub walls: Vec<Outline>,
    /// Everything that is neither a wall nor a robot, in the order of the world file.
    pub obstacles: Vec<Obstacle>,
    /// The robots, in the order of the world file.
    pub robots: Vec<SceneRobot>,
}

impl Scene {
    /// Whether a robot is driven, or is part of the surroundings.
    pub fn has_robot(&self, is_driven: bool) -> bool {
        self.robots.iter().any(|robot| robot.is_driven == is_driven)
    }

    /// Whether an obstacle is fixed, or moves, appears or disappears.
    pub fn has_obstacle(&self, is_fixed: bool) -> bool {
        self.obstacles.iter().any(|obstacle| obstacle.is_fixed() == is_fixed)
    }
}

/// Lower left corner and size of a frame, m.
pub fn extent(frame: &GridFrame) -> (Point2<f64>, Vector2<f64>) {
    (frame.origin(), Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m())
}

/// The lowest and the highest coordinates of an outline, m.
pub fn span(outline: &[Point2<f64>]) -> [Point2<f64>; 2] {
    let first = outline.first().copied().unwrap_or(Point2::origin());
    outline.iter().fold([first; 2], |[low, high], corner| [low.inf(corner), high.sup(corner)])
}

/// An object that is neither a wall nor a robot.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// The name of the obstacle in the world file.
    pub name: String,
    /// The outline at the start, m; empty if the obstacle appears later.
    pub outline: Outline,
    /// The outlines at other times that follow from the world file: the swing of a door, the path of a block.
    pub reach: Vec<Outline>,
}

impl Obstacle {
    /// Whether the pose of the obstacle is constant during the whole run, like that of furniture.
    pub fn is_fixed(&self) -> bool {
        self.reach.is_empty()
    }

    /// The color of the obstacle.
    pub fn color(&self) -> Rgb {
        if self.is_fixed() { palette::FURNITURE } else { palette::MOVING }
    }
}

/// A robot at its start.
#[derive(Clone, Debug)]
pub struct SceneRobot {
    /// The name of the robot in the world file.
    pub name: String,
    /// The pose in the frame of the world, m and rad.
    pub pose: Isometry2<f64>,
    /// The radius of the circle around the body, m.
    pub radius_m: f64,
    /// The corners of the body in the frame of the robot, m; empty for a round body.
    pub corners: Outline,
    /// The areas that the range sensors of the robot cover.
    pub sectors: Vec<Sector>,
    /// Whether the robot executes commands: the curious robot, and not a part of its surroundings.
    pub is_driven: bool,
}

impl SceneRobot {
    /// The color of the robot.
    pub fn color(&self) -> Rgb {
        if self.is_driven { palette::CURIOUS } else { palette::OTHER_ROBOT }
    }
}

/// The area that a laser scanner or a sonar covers.
#[derive(Clone, Copy, Debug)]
pub struct Sector {
    /// The pose of the sensor in the frame of the robot, m and rad.
    pub mount: Isometry2<f64>,
    /// The angle of the area, symmetrical to the direction of the sensor, rad.
    pub angle_rad: f64,
    /// The range, m.
    pub range_m: f64,
}

/// The state of a robot at one time.
#[derive(Clone, Copy, Debug)]
pub struct RobotState<'a> {
    /// The pose in the frame of the world, m and rad.
    pub pose: Isometry2<f64>,
    /// The latest scan of the curious robot; `None` for every other robot.
    pub sight: Option<&'a LaserReading>,
}

// The scene of a log: a place of which nothing is known before.

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
