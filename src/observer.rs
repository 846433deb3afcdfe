//! Watches a run in the physics world from outside: measures it against the truth, and shows it
//! to the recording and to whoever waits for it to end.

use crate::metrics::{self, Changing, ChangingScores, Delays, Latency, ThingReport, Things};
use crate::pilot::{Now, Pilot};
use crate::recording::{Recorder, RecordingError};
use crate::summary::CurvePoint;
use crate::view::{
    Level, Message, ObstacleView, Outline, RobotView, Scene, Scores, Sight, StrategyView, TimeUnit, Trail,
    View,
};
use interfaces::{LaserReading, Twist};
use mapper::Mapper;
use nalgebra::Point2;
use sim::physics::{Body, PhysicsWorld};

/// Coverage and quality take a pass over the map: once in this many readings.
const SCORE_EVERY: usize = 100;
/// The accuracy on changing cells is sampled once in this many readings.
const SAMPLE_EVERY: usize = 10;

/// What was seen of a run so far.
pub struct Observer {
    recorder: Option<Recorder>,
    latency: Latency,
    things: Things,
    changing: Changing,
    curve: Vec<CurvePoint>,
    trails: Vec<Trail>,
    goals: Vec<Point2<f64>>,
    /// Of every obstacle in the world file, present or not.
    outlines: Vec<Outline>,
    contacts_told: usize,
    messages: Vec<Message>,
}

impl Observer {
    /// An observer that also shows the run to `recorder`.
    pub fn new(world: &PhysicsWorld, recorder: Option<Recorder>) -> Self {
        let obstacles = world.spec().obstacles.iter();
        Self {
            recorder,
            latency: Latency::default(),
            things: Things::default(),
            changing: Changing::default(),
            curve: Vec::new(),
            trails: world.robots().map(|robot| Trail::new(robot.name, robot.is_driven)).collect(),
            goals: Vec::new(),
            outlines: obstacles.map(|obstacle| obstacle.shape.corners().to_vec()).collect(),
            contacts_told: 0,
            messages: Vec::new(),
        }
    }

    /// What stays the same for a whole run in this world.
    pub fn scene(world: &PhysicsWorld) -> Scene {
        Scene {
            title: world.spec().name.to_owned(),
            place: "house",
            unit: TimeUnit::Second,
            walls: world.walls().map(|corners| corners.to_vec()).collect(),
        }
    }

    /// Looks at one tick.
    ///
    /// # Errors
    ///
    /// When the recording cannot go on.
    pub fn watch(
        &mut self,
        world: &PhysicsWorld,
        reading: &LaserReading,
        now: &Now,
        pilot: &mut impl Pilot<Command = Twist>,
    ) -> Result<(), RecordingError> {
        self.measure(world, reading, now.mapper);
        self.note(world, pilot);
        let Some(mut recorder) = self.recorder.take() else { return Ok(()) };
        let result = self.show(world, now, pilot, |view| recorder.log(view));
        self.recorder = Some(recorder);
        result
    }

    /// The run so far, in numbers.
    pub fn findings(&self) -> Findings {
        let [block_latency, free_latency] = self.latency.delays();
        Findings {
            map_quality_changing: self.changing.scores(),
            block_latency,
            free_latency,
            things: self.things.reports().cloned().collect(),
            curve: self.curve.clone(),
        }
    }

    /// Where the robots have been, and the goals that the curious one chose, m.
    pub fn ways(&self) -> (&[Trail], &[Point2<f64>]) {
        (&self.trails, &self.goals)
    }

    /// The last coverage and quality.
    pub fn scores(&self) -> Option<Scores> {
        self.curve.last().map(|&CurvePoint { coverage, map_quality, .. }| Scores { coverage, map_quality })
    }

    /// Why a viewer is not shown the run, or not any more.
    pub fn live_problem(&self) -> Option<String> {
        self.recorder.as_ref().and_then(Recorder::live_problem)
    }

    /// Closes the recording.
    ///
    /// # Errors
    ///
    /// When not all of it could be written.
    pub fn finish(
        &mut self,
        world: &PhysicsWorld,
        now: &Now,
        pilot: &impl Pilot<Command = Twist>,
    ) -> Result<(), RecordingError> {
        match self.recorder.take() {
            Some(recorder) => self.show(world, now, pilot, |view| recorder.finish(view)),
            None => Ok(()),
        }
    }

    fn measure(&mut self, world: &PhysicsWorld, reading: &LaserReading, mapper: &Mapper) {
        let (truth, laser) = (world.truth(), world.true_pose() * reading.mount);
        self.latency.watch(truth, mapper, reading, &laser);
        self.things.watch(world.obstacle_events(), truth, mapper, reading, &laser);
        if mapper.readings().is_multiple_of(SAMPLE_EVERY) {
            self.changing.count(mapper, truth);
        }
        if mapper.readings() % SCORE_EVERY == 1 {
            let Scores { coverage, map_quality } = metrics::scores(mapper, truth);
            self.curve.push(CurvePoint { time_s: reading.time_s, coverage, map_quality });
        }
    }

    /// Collects what is worth a line in the log, and where the robots went.
    fn note(&mut self, world: &PhysicsWorld, pilot: &mut impl Pilot<Command = Twist>) {
        self.messages = pilot.take_messages();
        if self.messages.iter().any(|message| message.level == Level::Decision) {
            self.goals.extend(pilot.goal());
        }
        let mut say = |level, text| self.messages.push(Message { level, text });
        self.things.take_news().into_iter().for_each(|text| say(Level::Event, text));
        for contact in &world.contacts()[self.contacts_told..] {
            let how = if contact.moving { "drove into" } else { "was run into by" };
            say(Level::Trouble, format!("the curious robot {how} {}", name(world, contact.with)));
        }
        self.contacts_told = world.contacts().len();
        for (trail, robot) in self.trails.iter_mut().zip(world.robots()) {
            trail.push(robot.pose.translation.vector.into());
        }
    }

    /// Puts together what the run looks like now.
    fn show<T>(
        &self,
        world: &PhysicsWorld,
        now: &Now,
        pilot: &impl Pilot<Command = Twist>,
        log: impl FnOnce(&View) -> T,
    ) -> T {
        let robots: Vec<RobotView> = world
            .robots()
            .map(|robot| RobotView {
                name: robot.name,
                pose: robot.pose,
                radius_m: robot.radius_m,
                is_curious: robot.is_driven,
                sight: robot.sweep.map(|sweep| Sight::Laser(&sweep.reading)),
            })
            .collect();
        // Those that are there, where they are now; the others, where they were or will be.
        let mut outlines = self.outlines.clone();
        let mut present = vec![false; outlines.len()];
        for obstacle in world.obstacles() {
            outlines[obstacle.index] = obstacle.corners.to_vec();
            present[obstacle.index] = true;
        }
        let obstacles: Vec<ObstacleView> = world
            .spec()
            .obstacles()
            .iter()
            .zip(outlines.iter().zip(present))
            .map(|(obstacle, (outline, is_present))| ObstacleView {
                name: &obstacle.name,
                outline,
                is_present,
            })
            .collect();
        let strategies: Vec<StrategyView> =
            pilot.strategies(now.features).into_iter().map(StrategyView::from).collect();
        log(&View {
            time: now.mapper.time(),
            step: now.mapper.readings() as u64,
            mapper: now.mapper,
            features: now.features,
            robots: &robots,
            obstacles: &obstacles,
            path: pilot.path(),
            goal: pilot.goal(),
            scores: self.scores(),
            rate_errors: None,
            strategies: &strategies,
            messages: &self.messages,
        })
    }
}

/// What was measured while the run went on.
#[derive(Clone, Debug)]
pub struct Findings {
    /// Balanced accuracy on the cells that truly change.
    pub map_quality_changing: ChangingScores,
    /// How soon the map followed block events.
    pub block_latency: Delays,
    /// How soon the map followed free events.
    pub free_latency: Delays,
    /// Things that appeared or went.
    pub things: Vec<ThingReport>,
    /// Coverage and quality over time.
    pub curve: Vec<CurvePoint>,
}

fn name(world: &PhysicsWorld, body: Body) -> String {
    match body {
        Body::Wall(_) => "a wall".into(),
        Body::Obstacle(index) => world.spec().obstacles[index].name.clone(),
        Body::Robot(index) => world.spec().robots[index].name.clone(),
    }
}
