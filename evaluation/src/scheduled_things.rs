//! How well the predicted map knew the things with a schedule, at all times of a run: while the robot drives, and while it rests
//! without looking.

use crate::metrics::{Freshness, FreshnessScores};
use interfaces::CellState;
use mapper::{Door, Mapper};
use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use sim::physics::{self, Motion, PhysicsWorld, WorldSpec};

/// A door of the map whose closed leaf is centered this near to that of the world is this door, m.
const SAME_DOOR_M: f64 = 0.3;

/// Compares the predicted map with the truth every minute, in worlds with a calendar.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct ScheduledThings {
    freshness: Freshness,
    /// The number of samples so far, which is that of the next one.
    samples: u64,
    /// Follows from the world.
    #[serde(skip)]
    things: Option<Vec<Thing>>,
}

impl Default for ScheduledThings {
    fn default() -> Self {
        Self { freshness: Freshness::new(Self::EVERY_S), samples: 0, things: None }
    }
}

/// How well the predicted map knew the things with a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScheduledScores {
    /// The number of things with a schedule.
    pub things: usize,
    /// The number of minutes.
    pub samples: u64,
    /// The scores over all minutes, in view or not.
    #[serde(flatten)]
    pub fresh: FreshnessScores,
}

impl ScheduledThings {
    /// The time from sample to sample, s.
    pub const EVERY_S: f64 = 60.0;

    /// Compares the map with the world if a sample is due. The map predicts from its last reading.
    pub fn sample(&mut self, world: &PhysicsWorld, mapper: &Mapper) {
        let is_due = world.time_s() + 1e-6 >= self.samples as f64 * Self::EVERY_S;
        if world.spec().starts_s.is_none() || !is_due {
            return;
        }
        self.samples += 1;
        let things = self.things.get_or_insert_with(|| things_of(world.spec()));
        let predicted: Vec<f64> =
            things.iter().map(|thing| thing.predicted(mapper, world.time_s())).collect();
        let is_blocked: Vec<bool> = things.iter().map(|thing| thing.is_blocked(world)).collect();
        self.freshness.add(&predicted, &is_blocked);
    }

    /// The scores; `None` in a world without a calendar.
    pub fn scores(&self) -> Option<ScheduledScores> {
        let (things, samples) = (self.freshness.things(), self.samples);
        (things > 0).then(|| ScheduledScores { things, samples, fresh: self.freshness.scores() })
    }
}

/// The things of a world that have a schedule, once for each of their places. That a door is open says as much as that it is not closed.
fn things_of(spec: &WorldSpec) -> Vec<Thing> {
    let mut things = Vec::new();
    for thing in spec.things() {
        let obstacle = &spec.obstacles[thing.obstacle];
        let door = Some(obstacle.shape).filter(|_| matches!(obstacle.motion, Motion::Door(_)));
        let places = if obstacle.schedule().is_none() { 0 } else { thing.places.len() };
        for place in 0..if door.is_some() { places.min(1) } else { places } {
            let door = door.map(|leaf| leaf.pose.translation.vector.into());
            things.push(Thing { door, place, thing: thing.clone() });
        }
    }
    things
}

/// A thing that is there, or closed, by a schedule.
#[derive(Clone, Debug)]
struct Thing {
    thing: physics::Thing,
    place: usize,
    /// The center of the leaf of a closed door, m.
    door: Option<Point2<f64>>,
}

impl Thing {
    /// The probability that it is there, or closed, as the map predicts it from its last reading: for a door of the map by its clock.
    fn predicted(&self, mapper: &Mapper, time_s: f64) -> f64 {
        match self.door.and_then(|center| door(mapper, &center)) {
            Some(door) => 1.0 - door.clock.probability(mapper.epoch_s() + time_s, mapper.calendar()),
            None => presence(mapper, &self.thing.places[self.place], (time_s - mapper.time()).max(0.0)),
        }
    }

    /// Whether it is there, or closed.
    fn is_blocked(&self, world: &PhysicsWorld) -> bool {
        world.fleet().place_of(&self.thing) == Some(self.place)
    }
}

/// The probability that a thing with these cells is there, this much time after the last reading, s: that of the object to which the
/// map counts its cells, else that of the cell that is most probably blocked. ½ if no cell was ever seen.
pub fn presence(mapper: &Mapper, cells: &[usize], ahead_s: f64) -> f64 {
    let known = cells.iter().filter(|cell| mapper.states().cells()[**cell] != CellState::Unknown);
    let by_cell = || known.map(|cell| mapper.blocked_probability_later(*cell, ahead_s)).reduce(f64::max);
    let by_object = object_cell(mapper, cells).and_then(|cell| mapper.presence(cell, ahead_s));
    by_object.or_else(by_cell).unwrap_or(0.5)
}

/// Of these cells, the one whose object is there with the median probability of all that have an object.
pub fn object_cell(mapper: &Mapper, cells: &[usize]) -> Option<usize> {
    let presence = |cell: &usize| Some((mapper.presence(*cell, 0.0)?, *cell));
    let mut known: Vec<(f64, usize)> = cells.iter().filter_map(presence).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    known.get(known.len() / 2).map(|(_, cell)| *cell)
}

/// The door of the map whose closed leaf is centered near a point, m.
fn door<'a>(mapper: &'a Mapper, center: &Point2<f64>) -> Option<&'a Door> {
    let far_m = |door: &&Door| (nalgebra::center(&door.closed.ends[0], &door.closed.ends[1]) - center).norm();
    let doors = mapper.doors().iter();
    doors.filter(|door| far_m(door) <= SAME_DOOR_M).min_by(|a, b| far_m(a).total_cmp(&far_m(b)))
}
