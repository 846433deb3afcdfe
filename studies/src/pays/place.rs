use calendar::{Habit, Schedule};
use interfaces::{GridFrame, Purpose, RandomStream, pose};
use nalgebra::{Point2, Vector2};
use rand::seq::SliceRandom;
use serde::Serialize;
use sim::physics::shape::Rectangle;
use sim::physics::{
    BehaviorSpec, ContactModel, DrivenError, FleetSpec, Motion, ObstacleSpec, RobotSpec, WorldSpec,
};

/// The side of a block, m: the smallest room. Larger rooms have several blocks.
const BLOCK_M: f64 = 4.0;
/// The thickness of a wall, and the width of a doorway, m.
const WALL_M: f64 = 0.1;
const DOORWAY_M: f64 = 1.0;
/// The share of blocks with things.
const SHARE: f64 = 0.3;
/// The probability of a doorway between two rooms that are connected anyway.
const DOORWAY_PROBABILITY: f64 = 0.5;
/// The side of a thing, and the places of things in a block, m.
const THING_M: f64 = 0.5;
const PLACES_M: [[f64; 2]; 4] = [[1.2, 1.2], [2.8, 2.8], [1.2, 2.8], [2.8, 1.2]];
/// The median of the mean stay of things, s, and the range of the logarithm of the ratio of the mean stays there and away.
const STAY_S: f64 = 600.0;
const LOG_RATIO: f64 = 1.0;
/// The side of a cell of the map, m.
const CELL_M: f64 = 0.05;

/// What places have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// The number of rooms along each side of the building.
    pub rooms: usize,
    /// The side of a room, m: a multiple of 4.
    pub side_m: f64,
    /// The range of the laser, m.
    pub laser_m: f64,
    /// The number of things in a part of 4 × 4 m that has any.
    pub things: usize,
    /// Whether the things of such a part have the same rates.
    pub alike: bool,
    /// The standard deviation of the logarithm of the mean stays.
    pub spread: f64,
    /// The share of the time that the robot is on patrol; from 1 on it is always moving.
    pub duty: f64,
}

/// A thing: a box that comes and goes as a two-state Markov chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item {
    /// The room, by column and row.
    pub room: [usize; 2],
    /// The lower left corner in the free space of its room, m.
    pub corner_m: [f64; 2],
    /// The mean stays, away and there, s.
    pub stays_s: [f64; 2],
    /// Whether it is there at the start.
    pub starts_there: bool,
}

/// A building of square rooms in which things come and go.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// What it has in common with others.
    pub setting: Setting,
    /// The seed.
    pub seed: u64,
    /// Pairs of rooms beside each other with a doorway in the middle of their wall: the left or lower room, and the axis on which the
    /// other one follows.
    pub doorways: Vec<([usize; 2], usize)>,
    /// The things.
    pub things: Vec<Item>,
}

impl Place {
    /// The place of a setting and a seed.
    pub fn generate(setting: Setting, seed: u64) -> Self {
        let mut rng = RandomStream::new(seed, Purpose::DayGenerator);
        let n = setting.rooms;
        let rooms: Vec<[usize; 2]> = (0..n * n).map(|room| [room % n, room / n]).collect();
        let mut beside: Vec<([usize; 2], usize)> = rooms
            .iter()
            .flat_map(|room| [0, 1].map(|axis| (*room, axis)))
            .filter(|(room, axis)| room[*axis] + 1 < n)
            .collect();
        beside.shuffle(&mut rng);
        let mut parts: Vec<usize> = (0..n * n).collect();
        let mut doorways = Vec::new();
        for (room, axis) in beside {
            let other = room[1] * n + room[0] + if axis == 0 { 1 } else { n };
            let [part, joined] = [parts[room[1] * n + room[0]], parts[other]];
            if part != joined || rng.bernoulli(DOORWAY_PROBABILITY) {
                parts.iter_mut().filter(|now| **now == joined).for_each(|now| *now = part);
                doorways.push((room, axis));
            }
        }
        let per_side = (setting.side_m / BLOCK_M).round().max(1.0) as usize;
        let block = |room: [usize; 2], part: usize| {
            (room, [part % per_side, part / per_side].map(|along| along as f64 * BLOCK_M))
        };
        let blocks = rooms.iter().flat_map(|room| (0..per_side * per_side).map(|part| block(*room, part)));
        let mut blocks: Vec<([usize; 2], [f64; 2])> = blocks.skip(1).collect(); // the robot starts in the first one
        blocks.shuffle(&mut rng);
        blocks.truncate((SHARE * blocks.len() as f64).round() as usize);
        let mut things = Vec::new();
        for (room, from_m) in blocks {
            let mut places = PLACES_M;
            places.shuffle(&mut rng);
            let mut stays_s = stays(setting.spread, &mut rng);
            for place in places.iter().take(setting.things) {
                let [away, there] = stays_s;
                let corner_m = [0, 1].map(|axis| from_m[axis] + place[axis] - THING_M / 2.0);
                let starts_there = rng.bernoulli(there / (away + there));
                things.push(Item { room, corner_m, stays_s, starts_there });
                if !setting.alike {
                    stays_s = stays(setting.spread, &mut rng);
                }
            }
        }
        Self { setting, seed, doorways, things }
    }

    /// The schedule of a thing.
    pub fn schedule(&self, thing: &Item) -> Schedule {
        let [away_s, there_s] = thing.stays_s;
        Schedule { habit: Habit::chain(away_s, there_s), starts_blocked: thing.starts_there }
    }

    /// The distance from a room to the next one, m.
    fn pitch_m(&self) -> f64 {
        self.setting.side_m + WALL_M
    }

    /// The place as a physics world. A robot with exact poses starts in the middle of the first block.
    ///
    /// # Errors
    ///
    /// Never: the world has one robot.
    pub fn world(&self) -> Result<WorldSpec, DrivenError> {
        let (n, pitch, side) = (self.setting.rooms, self.pitch_m(), self.setting.side_m);
        let size = n as f64 * pitch + WALL_M;
        let mut walls = Vec::new();
        for axis in [0, 1] {
            let mut wall = |across: f64, [from, to]: [f64; 2]| {
                let corners = [[across, from], [across + WALL_M, to]];
                let [low, high] =
                    corners.map(|[x, y]| if axis == 0 { Point2::new(x, y) } else { Point2::new(y, x) });
                walls.push(Rectangle::between(low, high));
            };
            for line in 0..=n {
                let across = line as f64 * pitch;
                let mut from = 0.0;
                for along in 0..n {
                    let room =
                        if axis == 0 { [line.wrapping_sub(1), along] } else { [along, line.wrapping_sub(1)] };
                    if self.doorways.contains(&(room, axis)) {
                        let middle = along as f64 * pitch + WALL_M + side / 2.0;
                        wall(across, [from, middle - DOORWAY_M / 2.0]);
                        from = middle + DOORWAY_M / 2.0;
                    }
                }
                wall(across, [from, size]);
            }
        }
        let obstacle = |(number, thing): (usize, &Item)| {
            let low = [0, 1].map(|axis| thing.room[axis] as f64 * pitch + WALL_M + thing.corner_m[axis]);
            let shape = Rectangle::between(Point2::from(low), Point2::from(low) + Vector2::repeat(THING_M));
            ObstacleSpec::new(
                &format!("box {number}"),
                shape,
                Motion::Scheduled(Box::new(self.schedule(thing))),
            )
        };
        let start_m = WALL_M + BLOCK_M / 2.0;
        let mut robot = RobotSpec::new("curious", pose(start_m, start_m, 0.0), BehaviorSpec::Driven);
        robot.laser.range_max_m = self.setting.laser_m;
        let frame = GridFrame::covering(Point2::origin(), size, size, CELL_M);
        let fleet = FleetSpec {
            name: format!("pays-{}", self.seed),
            description: String::new(),
            frame: frame.ok_or(DrivenError::None)?,
            step_s: 0.05,
            contacts: ContactModel::Sliding,
            walls,
            glass: Vec::new(),
            obstacles: self.things.iter().enumerate().map(obstacle).collect(),
            robots: vec![robot],
            starts_s: Some(0.0),
        };
        WorldSpec::new(fleet)
    }
}

/// Mean stays away and there, s.
fn stays(spread: f64, rng: &mut RandomStream) -> [f64; 2] {
    // A normal variable from twelve uniform ones.
    let normal = (0..12).map(|_| rng.uniform(-0.5..0.5)).sum::<f64>();
    let half = rng.uniform(-LOG_RATIO..LOG_RATIO) / 2.0;
    let stay_s = STAY_S * libm::exp(spread * normal);
    [stay_s * libm::exp(-half), stay_s * libm::exp(half)]
}
