//! The scene of a physics world.

use super::Displayed;
use draw::scene::{Obstacle, Outline, RobotState, Scene, SceneRobot, Sector};
use draw::view::{Measured, View};
use interfaces::{LaserReading, Twist, World};
use mapper::Mapper;
use nalgebra::Isometry2;
use robot::{Pilot, Turn};
use sim::physics::{
    BehaviorSpec, FleetSpec, Motion, ObstacleSpec, PhysicsWorld, Rectangle, RobotSpec, WorldSpec,
};

/// The number of outlines that show the swing of a door.
const SWING: u32 = 24;

impl Displayed for FleetSpec {
    fn scene(&self) -> Scene {
        Scene {
            title: self.name.to_owned(),
            is_grid: false,
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

/// The state of a run after a turn of the robot.
pub fn view<'a>(
    world: &'a PhysicsWorld,
    turn: &'a Turn<LaserReading, Twist>,
    mapper: &'a Mapper,
    pilot: &'a impl Pilot<Command = Twist>,
    measured: Measured<'a>,
) -> View<'a> {
    let robot = |robot: sim::physics::RobotView<'a>| RobotState {
        pose: robot.pose,
        sight: robot.is_driven.then_some(&turn.reading),
    };
    let mut obstacles = vec![None; world.spec().obstacles.len()];
    for obstacle in world.fleet().obstacles() {
        obstacles[obstacle.index] = Some(obstacle.corners.to_vec());
    }
    View {
        time_s: mapper.time(),
        step: mapper.readings() as u64,
        mapper,
        features: turn.features,
        robots: world.fleet().robots().map(robot).collect(),
        belief: Some(&turn.belief).filter(|_| !world.poses_are_exact()),
        obstacles,
        path: pilot.view().path,
        goal: pilot.view().goal,
        strategies: pilot.strategies(turn.features),
        measured,
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
        is_driven: spec.behavior == BehaviorSpec::Driven,
    }
}
