use super::fleet::Fleet;
use super::ground_truth::PhysicsGroundTruth;
use super::report::{Body, Contact, ObstacleEvent};
use super::snapshot::{self, SnapshotError};
use super::spec::WorldSpec;
use interfaces::{LaserReading, Twist, Values, World, value};
use nalgebra::Isometry2;
use std::sync::Arc;

/// A world in which one robot is driven, with the ground truth of every cell.
///
/// The same spec, seed and commands give the same bits, on every machine. A clone is independent.
#[derive(Clone)]
pub struct PhysicsWorld {
    spec: Arc<WorldSpec>,
    fleet: Fleet,
    /// Shared with that at the start until the first step.
    truth: Arc<PhysicsGroundTruth>,
    /// The ground truth at the start, which is the same for every seed.
    start: Arc<PhysicsGroundTruth>,
    contacts: Vec<Contact>,
    obstacle_events: Vec<ObstacleEvent>,
    /// Whether readings have the true pose in place of that by odometry.
    is_corrected: bool,
}

impl PhysicsWorld {
    /// The world of `spec` at its start. All random streams are seeded by `seed`: sensor noise, odometry noise, and
    /// the decisions of robots and doors, each with a separate stream.
    pub fn new(spec: &WorldSpec, seed: u64) -> Self {
        let fleet = Fleet::new(spec.fleet(), seed);
        let start = fleet.robots[spec.driven_index()].at();
        let mut truth = PhysicsGroundTruth::new(spec.frame, &spec.walls, &start);
        let boxes = fleet.standing_boxes();
        for (index, obstacle) in
            spec.obstacles.iter().enumerate().filter(|(i, _)| fleet.obstacles[*i].is_standing())
        {
            let mover = obstacle.is_mover().then_some(Body::Obstacle(index));
            truth.change_box(&obstacle.start(), &boxes, mover);
        }
        for index in others(spec) {
            truth.move_robot(index, &fleet.robots[index].form());
        }
        truth.begin();
        let truth = Arc::new(truth);
        Self {
            spec: Arc::new(spec.clone()),
            fleet,
            start: Arc::clone(&truth),
            truth,
            contacts: Vec::new(),
            obstacle_events: Vec::new(),
            is_corrected: false,
        }
    }

    /// Resets the world to the start, with the same seed or another one: the result is that of [`PhysicsWorld::new`], bit
    /// for bit. Corrected odometry stays so. The place is kept: a reset takes a small part of the time.
    pub fn reset(&mut self, seed: u64) {
        self.fleet.reset(seed);
        self.truth = Arc::clone(&self.start);
        self.contacts.clear();
        self.obstacle_events.clear();
    }

    /// From now on, readings have the true pose in place of that by odometry: for comparisons. Nothing else changes.
    pub fn correct_odometry(&mut self) {
        self.is_corrected = true;
    }

    /// The time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.fleet.time_s()
    }

    /// The spec of the world.
    pub fn spec(&self) -> &WorldSpec {
        &self.spec
    }

    /// The simulated robots and obstacles.
    pub fn fleet(&self) -> &Fleet {
        &self.fleet
    }

    /// The ground truth of every cell, for metrics only.
    pub fn truth(&self) -> &PhysicsGroundTruth {
        &self.truth
    }

    /// The true pose of the driven robot, for metrics only.
    pub fn true_pose(&self) -> &Isometry2<f64> {
        &self.fleet.robots[self.spec.driven_index()].pose
    }

    /// The contacts of the driven robot that began in the last [`act`](World::act), in the order of their beginning.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// All appearances and disappearances of obstacles since the start, in order of time: at most two per obstacle. Those by a
    /// schedule are not among them.
    pub fn obstacle_events(&self) -> &[ObstacleEvent] {
        &self.obstacle_events
    }

    /// Copies the state.
    pub fn snapshot(&self) -> WorldSnapshot {
        let Self { fleet, truth, contacts, obstacle_events, .. } = self;
        let (contacts, obstacle_events) = (contacts.clone(), obstacle_events.clone());
        WorldSnapshot { fleet: fleet.snapshot(), truth: Arc::clone(truth), contacts, obstacle_events }
    }

    /// Goes on from the bytes of a snapshot of a world with the same spec, bit for bit.
    ///
    /// # Errors
    ///
    /// When the bytes are not a snapshot, are damaged, or were taken of a world with another spec. The world must not be
    /// used then.
    pub fn restore(&mut self, mut snapshot: &[u8]) -> Result<(), SnapshotError> {
        let mut fleet = Vec::new();
        snapshot::read(&mut snapshot, vec![value(&mut fleet)])?;
        self.fleet.restore(&fleet)?;
        let truth = Arc::make_mut(&mut self.truth);
        let values = values(truth, &mut self.contacts, &mut self.obstacle_events);
        interfaces::restore(values, snapshot).map_err(|_| SnapshotError::Damaged)
    }

    /// Lets time pass until `until_s`, s, while the driven robot rests: it stops, and nobody reads its sensors. In a world
    /// with a calendar, steps in which nothing happens take no time to compute.
    pub fn rest(&mut self, until_s: f64) {
        self.rest_watched(until_s, f64::INFINITY, |_| ());
    }

    /// The same; shows the world at each multiple of `every_s`, s.
    pub fn rest_watched(&mut self, until_s: f64, every_s: f64, mut watch: impl FnMut(&Self)) {
        const ROUNDING_S: f64 = 1e-6;
        Arc::make_mut(&mut self.truth).changes.clear();
        self.contacts.clear();
        self.fleet.command(self.spec.driven_index(), Twist::STOP);
        let step_s = self.spec.step_s;
        let steps_to = |now_s: f64, time_s: f64| ((time_s - now_s) / step_s - 1e-6).ceil().max(0.0) as u64;
        // At least one: a robot that rests until it may leave must get there, however few parts of a step are missing.
        let mut left = steps_to(self.time_s(), until_s).max(u64::from(until_s > self.time_s()));
        while left > 0 {
            let number = ((self.time_s() + ROUNDING_S) / every_s).floor();
            let due = steps_to(self.time_s(), (number + 1.0) * every_s).max(1);
            left -= self.advance(left.min(due));
            if ((self.time_s() + ROUNDING_S) / every_s).floor() > number {
                watch(self);
            }
        }
    }

    /// Does one physics step, or up to `most` steps in which nothing happens. Returns their number.
    fn advance(&mut self, most: u64) -> u64 {
        let at_rest = self.fleet.steps_at_rest(most);
        if at_rest > 0 {
            self.fleet.pass(at_rest);
            Arc::make_mut(&mut self.truth).elapsed_s = self.fleet.time_s();
            return at_rest;
        }
        self.fleet.think(|robot| !robot.is_driven());
        self.fleet.advance();
        let time_s = self.time_s();
        let truth = Arc::make_mut(&mut self.truth);
        truth.elapsed_s = time_s;
        for index in others(&self.spec) {
            let robot = &self.fleet.robots[index];
            if robot.has_moved() {
                truth.move_robot(index, &robot.form());
            }
        }
        if self.fleet.moved().len() > 0 {
            let boxes = self.fleet.standing_boxes();
            for (index, before, after) in self.fleet.moved() {
                truth.move_box(&before, &after, &boxes, Body::Obstacle(index));
            }
        }
        let contacts = self.fleet.contacts.drain(..);
        self.contacts.extend(contacts.filter(|contact| contact.robot == self.spec.driven_index()));
        self.fleet.update_obstacles(|obstacle, appeared, standing| {
            let spec = &self.spec.obstacles[obstacle];
            let cells = truth.change_box(&spec.shape, standing, Some(Body::Obstacle(obstacle)));
            if spec.schedule().is_some() {
                return;
            }
            let name = spec.name.clone();
            self.obstacle_events.push(ObstacleEvent { time_s, obstacle, name, appeared, cells });
        });
        1
    }
}

/// A copy of the state of a world. It takes longer to turn it into bytes than to make it.
#[derive(Clone, Debug)]
pub struct WorldSnapshot {
    fleet: Vec<u8>,
    truth: Arc<PhysicsGroundTruth>,
    contacts: Vec<Contact>,
    obstacle_events: Vec<ObstacleEvent>,
}

impl WorldSnapshot {
    /// The state as bytes: that of the [fleet](Fleet::snapshot), and the ground truth.
    pub fn into_bytes(mut self) -> Vec<u8> {
        let mut all = vec![value(&mut self.fleet)];
        let truth = Arc::make_mut(&mut self.truth);
        all.extend(values(truth, &mut self.contacts, &mut self.obstacle_events));
        interfaces::snapshot(all)
    }
}

/// The values of a world beside those of the fleet.
fn values<'a>(
    truth: &'a mut PhysicsGroundTruth,
    contacts: &'a mut Vec<Contact>,
    obstacle_events: &'a mut Vec<ObstacleEvent>,
) -> Values<'a> {
    let mut values = truth.values();
    values.extend([value(contacts), value(obstacle_events)]);
    values
}

/// The robots that are not driven.
fn others(spec: &WorldSpec) -> impl Iterator<Item = usize> + use<> {
    let driven = spec.driven_index();
    (0..spec.robots.len()).filter(move |&index| index != driven)
}

impl World for PhysicsWorld {
    type Reading = LaserReading;
    type Command = Twist;

    /// The scan of the main laser of the driven robot, and the pose by odometry at the same time. The other sensors
    /// of the robot measure at most as often. Two calls at the same time return the same reading.
    fn sense(&mut self) -> LaserReading {
        let robot = self.fleet.look(self.spec.driven_index());
        let reading = robot.and_then(|robot| robot.reading());
        let mut reading = reading.expect("the main laser scanner has just measured").clone();
        if self.is_corrected {
            reading.pose = *self.true_pose();
        }
        reading
    }

    fn poses_are_exact(&self) -> bool {
        self.is_corrected || self.spec.driven().odometry.is_exact()
    }

    fn act(&mut self, command: &Twist) {
        Arc::make_mut(&mut self.truth).changes.clear();
        self.contacts.clear();
        self.fleet.command(self.spec.driven_index(), *command);
        for _ in 0..self.spec.driven().laser.period_steps {
            self.advance(1);
        }
    }
}
