//! Measures a run in the physics world against the ground truth, from outside the loop.

use crate::known_things::KnownThings;
use crate::metrics::{
    ChangingAccuracy, Forecasts, Latency, MapScores, PoseErrors, Prediction, TrueChains, map_scores,
};
use crate::scheduled_things::ScheduledThings;
use interfaces::{LaserReading, Twist};
use mapper::Mapper;
use results::thinned::{Goals, Thinned};
use robot::{Level, Message, Pilot, Robot, Turn};
use sim::physics::{Body, PhysicsWorld};
use xxhash_rust::xxh3::Xxh3;

/// Coverage, quality and predictions need a pass over many cells: they are computed once in this many readings.
const SCORE_EVERY: usize = 100;
/// The accuracy on changing cells is sampled once in this many readings.
const SAMPLE_EVERY: usize = 10;

/// A robot that moves towards a body at this speed or less when they touch has not driven into the body, m/s: a robot
/// that turns on the spot or passes by has no speed towards what runs into it, but for rounding.
const OWN_MPS: f64 = 0.005;

/// Coverage and map quality over time, s: all points of a run of nearly three hours at 10 Hz.
pub type Curve = Thinned<(f64, MapScores), 1024>;

/// The measurements of a run so far.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct Observer {
    /// The delays between changes that a beam has shown and the map.
    pub latency: Latency,
    /// The number of things that have appeared or disappeared.
    pub appearances: usize,
    /// The accuracy on swept cells.
    pub changing: ChangingAccuracy,
    /// The quality of the predicted map on swept cells out of view.
    pub prediction: Prediction,
    /// The forecasts.
    pub forecasts: Forecasts,
    /// The comparison with the things of a calendar, also at rest.
    pub scheduled: ScheduledThings,
    /// The comparison with the things that come and go.
    pub known_things: KnownThings,
    /// The true chains of all cells.
    pub true_chains: TrueChains,
    /// The errors of the poses that the robot used.
    pub poses: PoseErrors,
    /// Coverage and map quality over time.
    pub curve: Curve,
    /// The positions of the goals of the curious robot, m.
    pub goals: Goals,
    /// The number of contacts of the curious robot that began while it stood still, and of those that began while
    /// it moved.
    pub contacts: [usize; 2],
    /// The number of these contacts in which the curious robot drove into the other body.
    pub own_contacts: usize,
    /// The messages of the last tick.
    pub messages: Vec<Message>,
}

impl Observer {
    /// Measures one turn.
    pub fn observe<P: Pilot<Command = Twist>>(
        &mut self,
        world: &PhysicsWorld,
        robot: &mut Robot<LaserReading, P>,
        Turn { reading, belief, .. }: &Turn<LaserReading, Twist>,
    ) {
        self.poses.observe(reading.time_s, &belief.pose, world.true_pose(), belief.estimate.as_ref());
        self.measure(world, reading, &robot.mapper);
        self.collect_messages(world, &mut robot.pilot);
        if let Some(correction) = &belief.correction {
            self.poses.correct(correction);
            self.messages.push(Message { level: Level::Event, text: correction.to_string() });
        }
    }

    /// The latest coverage and map quality.
    pub fn scores(&self) -> Option<MapScores> {
        self.curve.samples().last().map(|(_, scores)| *scores)
    }

    fn measure(&mut self, world: &PhysicsWorld, reading: &LaserReading, mapper: &Mapper) {
        let (truth, laser) = (world.truth(), world.true_pose() * reading.mount);
        self.latency.observe(truth, mapper, reading, &laser);
        self.true_chains.observe(truth);
        self.forecasts.observe(mapper, truth, Some(&self.true_chains));
        self.scheduled.sample(world, mapper);
        self.known_things.sample(world, mapper);
        if mapper.readings().is_multiple_of(SAMPLE_EVERY) {
            self.changing.sample(mapper, truth);
        }
        if mapper.readings() % SCORE_EVERY == 1 {
            let is_hidden = |index| !mapper.is_in_view(index);
            self.prediction.sample(mapper, truth, Some(&self.true_chains), is_hidden);
            self.curve.push((reading.time_s, map_scores(mapper, truth)));
        }
    }

    /// Collects the messages of this tick, and the goal if there is a new one.
    fn collect_messages(&mut self, world: &PhysicsWorld, pilot: &mut impl Pilot<Command = Twist>) {
        self.messages = pilot.take_messages();
        if self.messages.iter().any(|message| message.level == Level::Decision) {
            self.goals.extend(pilot.view().goal);
        }
        let mut log = |level, text| self.messages.push(Message { level, text });
        for event in world.obstacle_events().iter().skip(self.appearances) {
            let verb = if event.appeared { "appeared" } else { "disappeared" };
            log(Level::Event, format!("{} {verb}", event.name));
        }
        self.appearances = world.obstacle_events().len();
        for contact in world.contacts() {
            let is_own = contact.own_speed_mps > OWN_MPS;
            self.contacts[usize::from(contact.moving)] += 1;
            self.own_contacts += usize::from(is_own);
            let how = if is_own { "drove into" } else { "was hit by" };
            log(Level::Trouble, format!("the curious robot {how} {}", name(world, contact.with)));
        }
    }
}

fn name(world: &PhysicsWorld, body: Body) -> String {
    match body {
        Body::Wall(_) => "a wall".into(),
        Body::Obstacle(index) => world.spec().obstacles[index].name.clone(),
        Body::Robot(index) => world.spec().robots[index].name.clone(),
    }
}

// The hash of everything that a mapper has learned.

/// A hash of the state and the statistics of every cell. Two runs with equal hashes learned the same, bit for bit.
pub fn map_hash(mapper: &Mapper) -> String {
    let mut hash = Xxh3::new();
    for index in 0..mapper.frame().len() {
        let seen = mapper.statistics(index);
        hash.update(&[mapper.states().cells()[index] as u8, u8::from(mapper.was_ever_seen(index))]);
        let figures = [
            seen.first_seen,
            seen.last_seen,
            seen.unobserved,
            seen.watched_free,
            seen.watched_blocked,
            mapper.rate(index),
            mapper.recency(index),
            mapper.change_probability(index),
        ];
        figures.iter().for_each(|figure| hash.update(&figure.to_bits().to_le_bytes()));
        let events =
            [seen.block_events, seen.free_events, seen.block_events_after_gap, seen.free_events_after_gap];
        events.iter().for_each(|count| hash.update(&count.to_le_bytes()));
    }
    format!("{:032x}", hash.digest128())
}
