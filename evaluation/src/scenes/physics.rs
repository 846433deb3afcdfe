//! The scene of a physics world.

use super::{Displayed, Visible};
use draw::scene::{Obstacle, Outline, RobotState, Scene, SceneRobot, Sector, Sight, TimeUnit};
use interfaces::LaserReading;
use nalgebra::{Isometry2, Point2};
use sim::physics::{
    BehaviorSpec, FleetSpec, Motion, ObstacleSpec, PhysicsWorld, Rectangle, Repeat, RobotSpec, WorldSpec,
};

/// The number of outlines that show the swing of a door.
const SWING: u32 = 24;

impl Displayed for FleetSpec {
    fn scene(&self) -> Scene {
        Scene {
            title: self.name.to_owned(),
            unit: PhysicsWorld::UNIT,
            frame: self.frame,
            walls: self.walls.iter().map(|wall| wall.corners().to_vec()).collect(),
            obstacles: self.obstacles.iter().map(obstacle).collect(),
            robots: self.robots.iter().map(robot).collect(),
        }
    }
}

impl Displayed for WorldSpec {
    fn scene(&self) -> Scene {
        self.fleet().scene()
    }
}

impl Visible for PhysicsWorld {
    const UNIT: TimeUnit = TimeUnit::Second;

    fn robots<'a>(&'a self, reading: &'a LaserReading) -> Vec<RobotState<'a>> {
        let state = |robot: sim::physics::RobotView<'a>| RobotState {
            pose: robot.pose,
            sight: robot.is_driven.then_some(Sight::Laser(reading)),
        };
        self.fleet().robots().map(state).collect()
    }

    fn obstacles(&self) -> Vec<Option<Outline>> {
        let mut outlines = vec![None; self.spec().obstacles.len()];
        for obstacle in self.fleet().obstacles() {
            outlines[obstacle.index] = Some(obstacle.corners.to_vec());
        }
        outlines
    }
}

fn obstacle(spec: &ObstacleSpec) -> Obstacle {
    let corners = |shape: Rectangle| shape.corners().to_vec();
    let start = corners(spec.start());
    let mut reach: Vec<Outline> = match &spec.motion {
        Motion::Fixed => Vec::new(),
        Motion::Scheduled(_) => vec![start.clone()],
        Motion::Pushed(_) => vec![start.clone()],
        Motion::Path(path) => path
            .keys
            .iter()
            .map(|(_, middle)| {
                let pose = Isometry2::from_parts((*middle).into(), spec.shape.pose.rotation);
                corners(Rectangle { pose, ..spec.shape })
            })
            .collect(),
        Motion::Door(door) => (0..=SWING)
            .map(|part| corners(door.shape(&spec.shape, f64::from(part) / f64::from(SWING))))
            .collect(),
    };
    if spec.appears_s.is_some() || spec.disappears_s.is_some() {
        reach.push(start.clone());
    }
    let outline = if spec.starts_present() { start } else { Vec::new() };
    Obstacle { name: spec.name.clone(), outline, reach }
}

fn robot(spec: &RobotSpec) -> SceneRobot {
    let lasers = spec.lasers().map(|laser| (laser.mount, laser.fov_rad, laser.range_max_m));
    let sonars = spec.sonars.iter().map(|sonar| (sonar.mount, sonar.cone_rad, sonar.range_max_m));
    let sector = |(mount, angle_rad, range_m)| Sector { mount, angle_rad, range_m };
    SceneRobot {
        name: spec.name.clone(),
        pose: spec.pose,
        radius_m: spec.radius_m,
        corners: spec.corners.clone(),
        sectors: lasers.chain(sonars).map(sector).collect(),
        route: route(&spec.behavior),
        is_driven: spec.behavior == BehaviorSpec::Driven,
    }
}

/// The points of the way of a robot; empty if it has none.
fn route(behavior: &BehaviorSpec) -> Vec<Point2<f64>> {
    match behavior {
        BehaviorSpec::Waypoints(way) if way.repeat == Repeat::Loop => {
            way.points.iter().chain(way.points.first()).copied().collect()
        }
        BehaviorSpec::Waypoints(way) => way.points.clone(),
        BehaviorSpec::WallPatrol(patrol) => vec![patrol.from, patrol.to],
        _ => Vec::new(),
    }
}
