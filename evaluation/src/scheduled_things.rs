//! How well the predicted map knew the things with a schedule, at all times of a run: while the robot drives, and while it rests
//! without looking.

use crate::metrics::{Freshness, FreshnessScores};
use interfaces::{CellState, GridFrame, GroundTruth, TrueState};
use mapper::{Door, Mapper, ThingKind};
use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};
use sim::physics::{Motion, ObstacleSpec, PhysicsGroundTruth, PhysicsWorld, WorldSpec};
use std::collections::BTreeSet;

/// The part of a closed leaf whose cells are those of the door: cells at its ends can belong to the wall.
const MIDDLE: f64 = 0.6;
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
        let is_blocked: Vec<bool> = things.iter().map(|thing| thing.is_blocked(world.truth())).collect();
        self.freshness.add(&predicted, &is_blocked);
    }

    /// The scores; `None` in a world without a calendar.
    pub fn scores(&self) -> Option<ScheduledScores> {
        let (things, samples) = (self.freshness.things(), self.samples);
        (things > 0).then(|| ScheduledScores { things, samples, fresh: self.freshness.scores() })
    }
}

/// The things of a world that have a schedule.
fn things_of(spec: &WorldSpec) -> Vec<Thing> {
    let scheduled = spec.obstacles.iter().filter(|obstacle| obstacle.schedule().is_some());
    scheduled.map(|obstacle| Thing::new(obstacle, &spec.frame)).collect()
}

/// A thing that is there, or closed, by a schedule.
#[derive(Clone, Debug)]
struct Thing {
    center: Point2<f64>,
    is_door: bool,
    /// The cells that are blocked when it is there, from its center on.
    cells: Vec<usize>,
}

impl Thing {
    fn new(obstacle: &ObstacleSpec, frame: &GridFrame) -> Self {
        let (shape, is_door) = (&obstacle.shape, matches!(obstacle.motion, Motion::Door(_)));
        let cell_m = frame.resolution_m();
        let reach = match is_door {
            true => Vector2::new(MIDDLE * shape.half_m.x, 0.0),
            false => shape.half_m.map(|half_m| (half_m - cell_m / 2.0).max(0.0)),
        };
        let steps = reach.map(|reach_m| (2.0 * reach_m / cell_m).ceil() as i32);
        let offset = |step: i32, axis: usize| f64::from(step) / f64::from(steps[axis].max(1)) * reach[axis];
        let points = (-steps.x..=steps.x).flat_map(|x| (-steps.y..=steps.y).map(move |y| (x, y)));
        let cells: BTreeSet<usize> = points
            .filter_map(|(x, y)| {
                frame.index(frame.cell_at(&(shape.pose * Point2::new(offset(x, 0), offset(y, 1)))))
            })
            .collect();
        let center = Point2::from(shape.pose.translation.vector);
        let own = frame.index(frame.cell_at(&center));
        let others = cells.into_iter().filter(|cell| Some(*cell) != own);
        Self { center, is_door, cells: own.into_iter().chain(others).collect() }
    }

    /// The probability that it is there, or closed, as the map predicts it from its last reading: for a door of the map by its clock,
    /// otherwise that of the cell that is most probably blocked. ½ if no cell was ever seen.
    fn predicted(&self, mapper: &Mapper, time_s: f64) -> f64 {
        if let Some(door) = self.is_door.then(|| self.door(mapper)).flatten() {
            return 1.0 - door.clock.probability(mapper.epoch_s() + time_s, mapper.calendar());
        }
        let ahead_s = (time_s - mapper.time()).max(0.0);
        let known = self.cells.iter().filter(|cell| mapper.states().cells()[**cell] != CellState::Unknown);
        known.map(|cell| mapper.blocked_probability_later(*cell, ahead_s)).reduce(f64::max).unwrap_or(0.5)
    }

    fn door<'a>(&self, mapper: &'a Mapper) -> Option<&'a Door> {
        let doors = mapper.things().iter().filter_map(|thing| match &thing.kind {
            ThingKind::Door(door) => Some(&**door),
            ThingKind::Furniture(_) => None,
        });
        let far_m = |door: &&Door| {
            (nalgebra::center(&door.closed.ends[0], &door.closed.ends[1]) - self.center).norm()
        };
        doors.filter(|door| far_m(door) <= SAME_DOOR_M).min_by(|a, b| far_m(a).total_cmp(&far_m(b)))
    }

    /// Whether it is there, or closed.
    fn is_blocked(&self, truth: &PhysicsGroundTruth) -> bool {
        self.cells.first().is_some_and(|cell| truth.state(*cell) != TrueState::Free)
    }
}
