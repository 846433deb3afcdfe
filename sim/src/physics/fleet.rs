use super::bodies::Bodies;
use super::laser::beams;
use super::obstacles::Obstacle;
use super::rays::{Beams, Disc, Scene, Scratch};
use super::report::{Body, Contact, Move, ObstacleView, RobotView};
use super::robot::Robot;
use super::shape::{Rectangle, TOUCH_M};
use super::snapshot::{Played, SnapshotError, Tape, fingerprint};
use super::spec::{FleetSpec, LaserSpec, RobotSpec};
use geometry::{GridFrame, LaserReading, Twist, heading_rad};
use nalgebra::{Isometry2, Point2, Vector2};
use rayon::prelude::*;
use std::sync::Arc;

/// What tells driven robots where to go: any type, or a closure from a robot (by its place in the
/// world file) and its reading to a command.
pub trait Controller {
    /// What the robot is to do from this reading on until its next one. Not a number stops it;
    /// what is beyond its bounds is cut to them.
    fn command(&mut self, robot: usize, reading: &LaserReading) -> Twist;
}

impl<F: FnMut(usize, &LaserReading) -> Twist> Controller for F {
    fn command(&mut self, robot: usize, reading: &LaserReading) -> Twist {
        self(robot, reading)
    }
}

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

/// A place with any number of robots.
///
/// The same spec, seed and commands give the same bits, on every machine and any number of threads.
/// A clone is a fork: it lives on by itself, and alike under the same commands.
#[derive(Clone)]
pub struct Fleet {
    spec: FleetSpec,
    seed: u64,
    /// Steps since the start; time is a multiple, so that it never drifts.
    step: u64,
    bodies: Bodies,
    robots: Vec<Robot>,
    obstacles: Vec<Obstacle>,
    scene: Scene,
    contacts: Vec<Contact>,
    parallel_lasers: bool,
    scratch: Scratch,
}

impl Fleet {
    /// The place of `spec` at its start. `seed` starts all chance: the noise of lasers, that of
    /// odometry, and what robots do by themselves, each in a stream of its own.
    pub fn new(spec: &FleetSpec, seed: u64) -> Self {
        let mut bodies = Bodies::new(spec.step_s);
        for (index, wall) in spec.walls.iter().enumerate() {
            bodies.add_box(Body::Wall(index), wall);
        }
        let mut lasers = Lasers::default();
        let mut robots = Vec::with_capacity(spec.robots.len());
        for (index, robot) in spec.robots.iter().enumerate() {
            bodies.add_robot(robot, spec.step_s);
            let beams = lasers.beams(&robot.laser);
            robots.push(Robot::new(robot, index, bodies.pose(index), spec.step_s, seed, beams));
        }
        let obstacles = spec.obstacles.iter().enumerate().map(|(i, o)| Obstacle::new(o, i, &mut bodies));
        let obstacles = obstacles.collect();
        let discs = robots.iter().map(|robot| Disc { center: robot.at(), radius_m: robot.spec.radius_m });
        let range_m = spec.robots.iter().fold(0.0, |most: f64, robot| most.max(robot.laser.range_max_m));
        let scene = Scene::new(corners(&spec.frame), &spec.walls, discs.collect(), range_m);
        let mut fleet = Self {
            spec: spec.clone(),
            seed,
            step: 0,
            bodies,
            robots,
            obstacles,
            scene,
            contacts: Vec::new(),
            parallel_lasers: false,
            scratch: Scratch::default(),
        };
        fleet.show_obstacles();
        fleet
    }

    /// Goes back to the start, with another seed or the same.
    pub fn reset(&mut self, seed: u64) {
        let parallel_lasers = self.parallel_lasers;
        *self = Self::new(&self.spec, seed);
        self.parallel_lasers = parallel_lasers;
    }

    /// The state as bytes, from which [`Fleet::restored`] makes a fleet that lives on bit by bit as
    /// this one will.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut tape = Tape::writing(spec_fingerprint(&self.spec));
        tape = match self.clone().play(&mut tape) {
            Ok(()) => tape,
            // Writing to memory has no way to fail; an empty tape would be refused when read.
            Err(_) => Tape::Writing(Vec::new()),
        };
        tape.finish()
    }

    /// The fleet of `spec` in the state of a snapshot.
    ///
    /// # Errors
    ///
    /// When the bytes are no snapshot, are damaged, or were taken of a fleet with another spec.
    pub fn restored(spec: &FleetSpec, snapshot: &[u8]) -> Result<Self, SnapshotError> {
        let mut tape = Tape::reading(snapshot, spec_fingerprint(spec))?;
        let mut seed = 0;
        tape.u64(&mut seed).map_err(|_| SnapshotError::Damaged)?;
        let mut fleet = Self::new(spec, seed);
        fleet.play_state(&mut tape).map_err(|_| SnapshotError::Damaged)?;
        if !tape.is_at_end() {
            return Err(SnapshotError::Damaged);
        }
        for (index, robot) in fleet.robots.iter().enumerate() {
            fleet.scene.move_disc(index, robot.at());
        }
        fleet.show_obstacles();
        Ok(fleet)
    }

    fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.u64(&mut self.seed)?;
        self.play_state(tape)
    }

    fn play_state(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.u64(&mut self.step)?;
        self.bodies.play(tape)?;
        self.robots.iter_mut().try_for_each(|robot| robot.play(tape))?;
        self.obstacles.iter_mut().try_for_each(|obstacle| obstacle.play(tape))?;
        let new = Contact { time_s: 0.0, robot: 0, with: Body::Wall(0), moving: false, impulse_ns: 0.0 };
        tape.list(&mut self.contacts, new, |tape, contact| {
            tape.f64(&mut contact.time_s)?;
            tape.usize(&mut contact.robot)?;
            tape.body(&mut contact.with)?;
            tape.bool(&mut contact.moving)?;
            tape.f64(&mut contact.impulse_ns)
        })
    }

    /// The time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.step as f64 * self.spec.step_s
    }

    /// What the place was made from.
    pub fn spec(&self) -> &FleetSpec {
        &self.spec
    }

    /// All robots, in the order of the file.
    pub fn robots(&self) -> impl ExactSizeIterator<Item = RobotView<'_>> {
        self.robots.iter().map(|robot| RobotView {
            name: &robot.spec.name,
            pose: robot.pose,
            radius_m: robot.spec.radius_m,
            is_driven: robot.is_driven(),
            twist: robot.velocity,
            is_stalled: robot.drive.is_stalled(),
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

    /// The contacts that began in the last step, robot by robot.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Whether lasers look around on all threads of rayon's pool, or on this one alone, as at
    /// first. The result is the same; a step must take some 0.1 ms for it to be worth it.
    pub fn set_parallel_lasers(&mut self, parallel: bool) {
        self.parallel_lasers = parallel;
    }

    /// Lets one physics step pass. Robots whose scan is due look around first, and decide; those
    /// that are driven ask `controller`.
    pub fn step(&mut self, controller: &mut impl Controller) {
        self.think(|_| true);
        for (index, robot) in self.robots.iter_mut().enumerate() {
            if robot.is_driven()
                && robot.is_due(self.step)
                && let Some(sweep) = &robot.sweep
            {
                let wanted = controller.command(index, &sweep.reading);
                robot.command(&wanted);
            }
        }
        self.advance();
        self.move_obstacles(|_, _, _| ());
    }

    /// Steps until `time_s` has come, s.
    pub fn run_until(&mut self, time_s: f64, controller: &mut impl Controller) {
        // Half a microsecond of slack: times are multiples of the step.
        while self.time_s() < time_s - 5e-7 {
            self.step(controller);
        }
    }

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

    /// Tells a driven robot what to do.
    pub(super) fn command(&mut self, robot: usize, wanted: &Twist) {
        self.robots[robot].command(wanted);
    }

    /// One robot.
    pub(super) fn robot(&self, robot: usize) -> &Robot {
        &self.robots[robot]
    }

    /// What a robot sees now.
    pub(super) fn look(&mut self, robot: usize) -> &LaserReading {
        let time_s = self.time_s();
        self.scene.sort();
        self.robots[robot].look(time_s, &self.scene, &mut self.scratch)
    }

    /// Lets the robots that `is_meant` look and decide, where their next scan is due.
    pub(super) fn think(&mut self, is_meant: impl Fn(&Robot) -> bool + Sync) {
        let (step, time_s) = (self.step, self.time_s());
        let is_due = |robot: &&mut Robot| robot.is_due(step) && is_meant(robot);
        if !self.robots.iter_mut().any(|robot| is_due(&robot)) {
            return;
        }
        self.scene.sort();
        let scene = &self.scene;
        if self.parallel_lasers {
            let due = self.robots.par_iter_mut().filter(is_due);
            due.for_each_init(Scratch::default, |scratch, robot| robot.think(time_s, scene, scratch));
        } else {
            let due = self.robots.iter_mut().filter(is_due);
            due.for_each(|robot| robot.think(time_s, scene, &mut self.scratch));
        }
    }

    /// Lets everything that drives do so for one physics step.
    pub(super) fn advance(&mut self) {
        for robot in &mut self.robots {
            robot.push(&mut self.bodies, self.spec.step_s);
        }
        self.bodies.step();
        self.step += 1;
        for (index, robot) in self.robots.iter_mut().enumerate() {
            robot.follow(&self.bodies);
            self.scene.move_disc(index, robot.at());
        }
        self.note_contacts();
    }

    /// Notes what robots have begun to touch.
    fn note_contacts(&mut self) {
        let time_s = self.time_s();
        self.contacts.clear();
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let mut touching = Vec::new();
            for (with, impulse_ns) in self.bodies.touches(index) {
                let touched_before = robot.touching.contains(&with);
                if impulse_ns > 0.0 && !touched_before {
                    let moving = robot.drove;
                    self.contacts.push(Contact { time_s, robot: index, with, moving, impulse_ns });
                }
                if impulse_ns > 0.0 || touched_before {
                    touching.push(with);
                }
            }
            robot.touching = touching;
        }
    }

    /// Lets obstacles come and go; `tell` hears of each at once: which it is, what it did, and
    /// the walls and obstacles that stand now.
    pub(super) fn move_obstacles(&mut self, mut tell: impl FnMut(usize, Move, &[Rectangle])) {
        let time_s = self.time_s();
        for index in 0..self.obstacles.len() {
            let robots = self.robots.iter().map(|robot| (robot.at(), robot.spec.radius_m));
            if let Some(what) = self.obstacles[index].step(index, time_s, &mut self.bodies, robots) {
                self.show_obstacles();
                tell(index, what, &self.standing_boxes());
            }
        }
    }

    /// Walls, and the obstacles that stand now.
    pub(super) fn standing_boxes(&self) -> Vec<Rectangle> {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        self.spec.walls.iter().copied().chain(standing.map(|obstacle| obstacle.spec.shape)).collect()
    }

    /// Whether an obstacle stands now.
    pub(super) fn is_standing(&self, obstacle: usize) -> bool {
        self.obstacles[obstacle].is_standing()
    }

    /// Shows the lasers what stands now.
    fn show_obstacles(&mut self) {
        let standing = self.obstacles.iter().filter(|obstacle| obstacle.is_standing());
        self.scene.set_boxes(standing.map(|obstacle| &obstacle.spec.shape));
    }
}

/// The beams of all lasers, each kind once.
#[derive(Default)]
struct Lasers {
    known: Vec<(LaserSpec, Arc<Beams>)>,
}

impl Lasers {
    fn beams(&mut self, spec: &LaserSpec) -> Arc<Beams> {
        if let Some((_, beams)) = self.known.iter().find(|(known, _)| known == spec) {
            return Arc::clone(beams);
        }
        let beams = Arc::new(beams(spec));
        self.known.push((*spec, Arc::clone(&beams)));
        beams
    }
}

/// A number that another spec would hardly have.
fn spec_fingerprint(spec: &FleetSpec) -> u64 {
    fingerprint(format!("{spec:?}").as_bytes())
}

/// The lower left and the upper right corner of a grid, m.
pub(super) fn corners(frame: &GridFrame) -> (Point2<f64>, Point2<f64>) {
    let size = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
    (frame.origin(), frame.origin() + size)
}
