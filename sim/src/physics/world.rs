use super::bodies::Bodies;
use super::obstacles::{Move, Obstacle};
use super::rays::{Disc, Scene};
use super::report::{Body, Contact, ObstacleEvent, ObstacleView, RobotView};
use super::robot::Robot;
use super::shape::Rectangle;
use super::spec::WorldSpec;
use super::truth::Truth;
use geometry::{GridFrame, LaserReading, Twist, World};
use nalgebra::{Isometry2, Point2, Vector2};

/// A house in which robots drive and look around.
///
/// The same spec, seed and commands give the same bits, on every machine.
pub struct PhysicsWorld {
    spec: WorldSpec,
    /// Steps since the start; time is a multiple, so that it never drifts.
    step: u64,
    bodies: Bodies,
    pub(super) robots: Vec<Robot>,
    obstacles: Vec<Obstacle>,
    scene: Scene,
    truth: Truth,
    contacts: Vec<Contact>,
    /// What the driven robot touches now.
    touching: Vec<Body>,
    obstacle_events: Vec<ObstacleEvent>,
}

impl PhysicsWorld {
    /// The world of `spec` at its start. `seed` starts all chance: the noise of lasers and of
    /// odometry, each in a stream of its own.
    pub fn new(spec: &WorldSpec, seed: u64) -> Self {
        let mut bodies = Bodies::new(spec.step_s);
        for (index, wall) in spec.walls.iter().enumerate() {
            bodies.add_box(Body::Wall(index), wall);
        }
        let mut robots = Vec::new();
        for (index, robot) in spec.robots.iter().enumerate() {
            bodies.add_robot(robot, spec.step_s);
            robots.push(Robot::new(robot, index, bodies.pose(index), spec.step_s, seed));
        }
        let obstacles: Vec<Obstacle> =
            spec.obstacles.iter().enumerate().map(|(i, o)| Obstacle::new(o, i, &mut bodies)).collect();
        let start = robots[spec.driven].at();
        let discs = robots.iter().map(|robot| Disc { center: robot.at(), radius_m: robot.spec.radius_m });
        let range_m = spec.robots.iter().fold(0.0, |most: f64, robot| most.max(robot.laser.range_max_m));
        let scene = Scene::new(corners(&spec.frame), &spec.walls, discs.collect(), range_m);
        let mut world = Self {
            truth: Truth::new(spec.frame, &spec.walls, &start),
            spec: spec.clone(),
            step: 0,
            bodies,
            robots,
            obstacles,
            scene,
            contacts: Vec::new(),
            touching: Vec::new(),
            obstacle_events: Vec::new(),
        };
        world.set_scene();
        world.set_truth();
        world
    }

    /// The time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.step as f64 * self.spec.step_s
    }

    /// What the world was made from.
    pub fn spec(&self) -> &WorldSpec {
        &self.spec
    }

    /// The truth about every cell, for metrics only.
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// Where the driven robot truly is, for metrics only.
    pub fn true_pose(&self) -> &Isometry2<f64> {
        &self.robots[self.spec.driven].pose
    }

    /// Every contact of the driven robot that has begun since the start, in order.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Every coming and going of an obstacle since the start, in order.
    pub fn obstacle_events(&self) -> &[ObstacleEvent] {
        &self.obstacle_events
    }

    /// All robots, in the order of the file.
    pub fn robots(&self) -> impl ExactSizeIterator<Item = RobotView<'_>> {
        self.robots.iter().enumerate().map(|(index, robot)| RobotView {
            name: &robot.spec.name,
            pose: robot.pose,
            radius_m: robot.spec.radius_m,
            is_driven: index == self.spec.driven,
            sweep: robot.sweep.as_ref(),
        })
    }

    /// The corners of all walls, counter-clockwise, m.
    pub fn walls(&self) -> impl ExactSizeIterator<Item = [Point2<f64>; 4]> {
        self.spec.walls.iter().map(Rectangle::corners)
    }

    /// The obstacles that stand now.
    pub fn obstacles(&self) -> impl Iterator<Item = ObstacleView<'_>> {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        standing.map(|o| ObstacleView { name: &o.spec.name, corners: o.spec.shape.corners() })
    }

    /// Lets one physics step pass.
    fn advance(&mut self) {
        let (time_s, step_s) = (self.time_s(), self.spec.step_s);
        self.scene.sort();
        for robot in &mut self.robots {
            robot.think(self.step, time_s, &self.scene);
        }
        for robot in &mut self.robots {
            robot.push(&mut self.bodies, step_s);
        }
        let moving = self.robots[self.spec.driven].is_moving();
        self.bodies.step();
        self.step += 1;
        self.truth.set_time(self.time_s());
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let before = robot.follow(&self.bodies);
            self.scene.move_disc(index, robot.at());
            if index != self.spec.driven {
                self.truth.move_disc(Body::Robot(index), Some(before), robot.at(), robot.spec.radius_m);
            }
        }
        self.note_contacts(moving);
        self.move_obstacles();
    }

    /// Notes what the driven robot has begun to touch. `moving`: it drove in this step.
    fn note_contacts(&mut self, moving: bool) {
        let time_s = self.time_s();
        let mut touching = Vec::new();
        for (with, presses) in self.bodies.touches(self.spec.driven) {
            let touched_before = self.touching.contains(&with);
            if presses && !touched_before {
                self.contacts.push(Contact { time_s, with, moving });
            }
            if presses || touched_before {
                touching.push(with);
            }
        }
        self.touching = touching;
    }

    fn move_obstacles(&mut self) {
        let time_s = self.time_s();
        for index in 0..self.obstacles.len() {
            let robots = self.robots.iter().map(|robot| (robot.at(), robot.spec.radius_m));
            let Some(what) = self.obstacles[index].step(index, time_s, &mut self.bodies, robots) else {
                continue;
            };
            self.set_scene();
            let boxes = self.standing_boxes();
            let spec = &self.obstacles[index].spec;
            let cells = self.truth.change_box(&spec.shape, &boxes, Some(Body::Obstacle(index)));
            self.obstacle_events.push(ObstacleEvent {
                time_s,
                obstacle: index,
                name: spec.name.clone(),
                appeared: what == Move::Appeared,
                cells,
            });
        }
    }

    /// Walls, and the obstacles that stand now.
    fn standing_boxes(&self) -> Vec<Rectangle> {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        self.spec.walls.iter().copied().chain(standing.map(|obstacle| obstacle.spec.shape)).collect()
    }

    /// Shows the lasers what stands now.
    fn set_scene(&mut self) {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        self.scene.set_boxes(standing.map(|obstacle| &obstacle.spec.shape));
    }

    /// Tells the truth what stands at the start.
    fn set_truth(&mut self) {
        let boxes = self.standing_boxes();
        for (index, obstacle) in self.obstacles.iter().enumerate().filter(|(_, o)| o.is_standing()) {
            let mover = obstacle.spec.is_mover().then_some(Body::Obstacle(index));
            self.truth.change_box(&obstacle.spec.shape, &boxes, mover);
        }
        for (index, robot) in self.robots.iter().enumerate().filter(|(i, _)| *i != self.spec.driven) {
            self.truth.move_disc(Body::Robot(index), None, robot.at(), robot.spec.radius_m);
        }
        self.truth.begin();
    }
}

impl World for PhysicsWorld {
    type Reading = LaserReading;
    type Command = Twist;

    /// The driven robot's scan, with its pose by odometry at the same instant. Looking twice at
    /// the same time gives the same reading.
    fn sense(&mut self) -> LaserReading {
        let time_s = self.time_s();
        self.scene.sort();
        self.robots[self.spec.driven].look(time_s, &self.scene).clone()
    }

    fn act(&mut self, command: &Twist) {
        self.truth.forget_changes();
        let driven = &mut self.robots[self.spec.driven];
        driven.command(command);
        let period_steps = driven.spec.laser.period_steps;
        for _ in 0..period_steps {
            self.advance();
        }
    }
}

/// The lower left and the upper right corner of a grid, m.
pub(super) fn corners(frame: &GridFrame) -> (Point2<f64>, Point2<f64>) {
    let size = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
    (frame.origin(), frame.origin() + size)
}
