//! How the simulated worlds are displayed.

use draw::scene::{Obstacle, Outline, RobotState, Scene, SceneRobot, Sector};
use draw::view::{Measured, View};
use interfaces::{Cell, Grid, LaserReading, Twist, World};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use robot::{Pilot, Turn};
use sim::grid::GridSpec;
use sim::physics::{
    BehaviorSpec, FleetSpec, Motion, ObstacleSpec, PhysicsWorld, Rectangle, RobotSpec, WorldSpec,
};
use std::f64::consts::TAU;

/// The description of a world that can be displayed.
pub trait Displayed {
    /// The world at its start.
    fn scene(&self) -> Scene;
}

// The scene of a grid world. Cells are 1 m wide, with `[0, 0]` at the origin.

/// The name of the only robot.
const ROBOT: &str = "robot";
/// The radius that the robot is drawn with, m: a little less than half a cell.
const ROBOT_RADIUS_M: f64 = 0.35;
impl Displayed for GridSpec {
    fn scene(&self) -> Scene {
        let square = |cell: &Cell| rectangle(*cell, *cell);
        let start = self.frame().center(self.start);
        Scene {
            title: self.name.to_owned(),
            is_grid: true,
            frame: *self.frame(),
            walls: rectangles(&self.walls),
            obstacles: self
                .blocks
                .iter()
                .map(|block| Obstacle {
                    name: block.name.clone(),
                    outline: block.path.first().map_or(Vec::new(), square),
                    reach: block.path.iter().map(square).collect(),
                })
                .collect(),
            robots: vec![SceneRobot {
                name: ROBOT.to_owned(),
                pose: Isometry2::translation(start.x, start.y),
                radius_m: ROBOT_RADIUS_M,
                corners: Vec::new(),
                sectors: vec![Sector {
                    mount: Isometry2::identity(),
                    angle_rad: TAU,
                    range_m: f64::from(self.sensor_radius),
                }],
                is_driven: true,
            }],
        }
    }
}

/// The rectangle from one cell to another, both included, m.
fn rectangle(low: Cell, high: Cell) -> Outline {
    let from = Point2::new(f64::from(low.x), f64::from(low.y));
    let to = Point2::new(f64::from(high.x + 1), f64::from(high.y + 1));
    vec![from, Point2::new(to.x, from.y), to, Point2::new(from.x, to.y)]
}

/// Few rectangles that cover the cells: runs along the rows, joined with runs of the same columns above.
fn rectangles(cells: &Grid<bool>) -> Vec<Outline> {
    let mut done: Vec<(Cell, Cell)> = Vec::new();
    let mut open: Vec<(Cell, Cell)> = Vec::new();
    for (row, y) in cells.rows().zip(0..) {
        let row: Vec<bool> = row.copied().collect();
        let mut x = 0;
        let mut still_open = Vec::new();
        for run in row.chunk_by(|a, b| a == b) {
            let (from, to) = (x, x + run.len() as i32 - 1);
            x = to + 1;
            if run[0] {
                let below = open.iter().position(|(low, high)| (low.x, high.x) == (from, to));
                let low = below.map_or(Cell::new(from, y), |below| open.swap_remove(below).0);
                still_open.push((low, Cell::new(to, y)));
            }
        }
        done.append(&mut open);
        open = still_open;
    }
    done.append(&mut open);
    done.sort_unstable();
    done.into_iter().map(|(low, high)| rectangle(low, high)).collect()
}

// The scene of a physics world.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_cover_the_walls_once_and_nothing_else() {
        let rows = ["#######", "#..#..#", "####R.#", "#..##.#", "#.....#", "##.##.#", "#######"];
        let text = format!("name = 'x'\nsensor_radius = 1\nmap = '''\n{}\n'''", rows.join("\n"));
        let walls = worldfile::grid::parse("x.toml", &text).unwrap().walls;
        let rectangles = rectangles(&walls);
        assert_eq!(rectangles.len(), 10);
        for (index, is_wall) in walls.cells().iter().enumerate() {
            let middle = walls.frame().center(walls.frame().cell(index));
            let is_between = |axis: usize, of: &Outline| (of[0][axis]..of[2][axis]).contains(&middle[axis]);
            let holds = |outline: &&Outline| is_between(0, outline) && is_between(1, outline);
            assert_eq!(rectangles.iter().filter(holds).count(), usize::from(*is_wall), "{middle}");
        }
    }
}
