use super::fleet::Fleet;
use super::report::{Body, Contact, Move, ObstacleEvent, ObstacleView, RobotView};
use super::spec::WorldSpec;
use super::truth::Truth;
use interfaces::{LaserReading, Twist, World};
use nalgebra::{Isometry2, Point2};

/// A house in which one robot is driven, with the truth about every cell.
///
/// The same spec, seed and commands give the same bits, on every machine.
pub struct PhysicsWorld {
    spec: WorldSpec,
    fleet: Fleet,
    truth: Truth,
    contacts: Vec<Contact>,
    obstacle_events: Vec<ObstacleEvent>,
}

impl PhysicsWorld {
    /// The world of `spec` at its start. `seed` starts all chance: the noise of lasers, that of
    /// odometry, and what robots do by themselves, each in a stream of its own.
    pub fn new(spec: &WorldSpec, seed: u64) -> Self {
        let fleet = Fleet::new(spec.fleet(), seed);
        let start = fleet.robot(spec.driven_index()).at();
        let mut truth = Truth::new(spec.frame, &spec.walls, &start);
        let boxes = fleet.standing_boxes();
        for (index, obstacle) in spec.obstacles.iter().enumerate().filter(|(i, _)| fleet.is_standing(*i)) {
            let mover = obstacle.is_mover().then_some(Body::Obstacle(index));
            truth.change_box(&obstacle.start(), &boxes, mover);
        }
        for index in others(spec) {
            let robot = fleet.robot(index);
            truth.move_robot(Body::Robot(index), None, &robot.form());
        }
        truth.begin();
        Self { spec: spec.clone(), fleet, truth, contacts: Vec::new(), obstacle_events: Vec::new() }
    }

    /// The time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.fleet.time_s()
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
        &self.fleet.robot(self.spec.driven_index()).pose
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
        self.fleet.robots()
    }

    /// The corners of all walls, counter-clockwise, m.
    pub fn walls(&self) -> impl ExactSizeIterator<Item = [Point2<f64>; 4]> {
        self.fleet.walls()
    }

    /// The obstacles that are there now, where they are now.
    pub fn obstacles(&self) -> impl Iterator<Item = ObstacleView<'_>> {
        self.fleet.obstacles()
    }

    /// Lets one physics step pass.
    fn advance(&mut self) {
        self.fleet.think(|robot| !robot.is_driven());
        self.fleet.advance();
        let time_s = self.time_s();
        self.truth.set_time(time_s);
        for index in others(&self.spec) {
            let robot = self.fleet.robot(index);
            let was = robot.spec.form(&robot.was);
            self.truth.move_robot(Body::Robot(index), Some(&was), &robot.form());
        }
        if self.fleet.moved().len() > 0 {
            let boxes = self.fleet.standing_boxes();
            for (index, before, after) in self.fleet.moved() {
                for shape in [before, after] {
                    self.truth.change_box(&shape, &boxes, Some(Body::Obstacle(index)));
                }
            }
        }
        let contacts = self.fleet.take_contacts().into_iter();
        self.contacts.extend(contacts.filter(|contact| contact.robot == self.spec.driven_index()));
        self.fleet.move_obstacles(|obstacle, what, standing| {
            let spec = &self.spec.obstacles[obstacle];
            let cells = self.truth.change_box(&spec.shape, standing, Some(Body::Obstacle(obstacle)));
            let (name, appeared) = (spec.name.clone(), what == Move::Appeared);
            self.obstacle_events.push(ObstacleEvent { time_s, obstacle, name, appeared, cells });
        });
    }
}

/// The robots that are not driven.
fn others(spec: &WorldSpec) -> impl Iterator<Item = usize> + use<> {
    let driven = spec.driven_index();
    (0..spec.robots.len()).filter(move |&index| index != driven)
}

impl World for PhysicsWorld {
    type Reading = LaserReading;
    type Command = Twist;

    /// The scan of the driven robot's main laser, with its pose by odometry at the same instant; its
    /// other senses look no oftener than that. Looking twice at the same time gives the same reading.
    fn sense(&mut self) -> LaserReading {
        self.fleet.look(self.spec.driven_index()).clone()
    }

    fn act(&mut self, command: &Twist) {
        self.truth.forget_changes();
        self.fleet.command(self.spec.driven_index(), *command);
        for _ in 0..self.spec.driven().laser.period_steps {
            self.advance();
        }
    }
}
