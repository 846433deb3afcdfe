//! Random worlds with a calendar: rooms with doors, and things that come and go.

use super::{GenerateSettings, between, frame, rooms, stands_free};
use crate::building_calendar::{self, BuildingCalendar};
use crate::grid::spec::{BlockSpec, Course, GridCalendar, GridSpec};
use calendar::{Kind, Schedule, ThingKind};
use interfaces::{Cell, Grid, Purpose, RandomStream};
use rand::RngExt;
use rand::seq::IndexedRandom;
use std::collections::BTreeSet;

/// The time of a step, s; and in rooms without a calendar.
const STEP_S: f64 = 10.0;
const ROOMS_STEP_S: f64 = 1.0;
/// The largest number of draws until a thing has room.
const MAX_TRIES: usize = 50;
/// How far a thing goes when it is not in its place, cells.
const AWAY: [i32; 2] = [1, 3];
const THINGS: [(ThingKind, &str); 3] =
    [(ThingKind::Person, "person"), (ThingKind::Box, "box"), (ThingKind::ParkedRobot, "parked robot")];
const SIDES: [(i32, i32); 4] = [(1, 0), (-1, 0), (0, 1), (0, -1)];

/// What is drawn for a kind of building. The ranges stay: every result depends on them.
struct Ranges {
    size: [[u32; 2]; 2],
    walls: [u32; 2],
    things: [u32; 2],
    has_doors: bool,
}

fn ranges(kind: Kind) -> Ranges {
    let of = |size, walls, things| Ranges { size, walls, things, has_doors: true };
    match kind {
        Kind::Home => of([[15, 21], [15, 19]], [3, 5], [3, 6]),
        Kind::Office => of([[25, 35], [21, 27]], [5, 9], [6, 12]),
        Kind::Warehouse => Ranges { has_doors: false, ..of([[25, 35], [21, 27]], [1, 2], [8, 14]) },
        Kind::Clinic => of([[25, 35], [21, 27]], [7, 11], [6, 12]),
    }
}

/// Of rooms, whose things change at any time of the day. Frozen before anything was tuned on these worlds.
const ROOMS: Ranges =
    Ranges { size: [[15, 45], [15, 45]], walls: [3, 20], things: [3, 20], has_doors: false };
const ROOMS_SENSOR: [u64; 2] = [3, 12];

impl GridSpec {
    /// The generated world with this name, as `generated-7`, `calendar-office-7`, `grid-rooms-7` or `grid-rooms-day-7`; `None` for
    /// other names.
    ///
    /// In `grid-rooms-`, boxes, people and parked robots are in their places or a few cells away, with mean stays of 10 s to 30 min
    /// (`grid-rooms-day-`: to 12 h), in steps of 1 s, in all rooms. In one of four worlds all these stays change once.
    pub fn generated(name: &str) -> Option<Self> {
        let (kind, seed) = name.rsplit_once('-')?;
        let seed = seed.parse().ok()?;
        let chains = match kind {
            "generated" => return Some(Self::generate(&GenerateSettings::default(), seed)),
            "grid-rooms" => &building_calendar::ROOMS,
            "grid-rooms-day" => &building_calendar::ROOMS_DAY,
            _ => return Some(Self::generate_calendar(kind.strip_prefix("calendar-")?.parse().ok()?, seed)),
        };
        let calendar = BuildingCalendar::of_chains(chains, seed);
        let world = building(kind, &ROOMS, calendar, ROOMS_STEP_S, seed);
        let sensor_radius = ROOMS_SENSOR[0] + seed % (ROOMS_SENSOR[1] - ROOMS_SENSOR[0] + 1);
        Some(world.with_sensor_radius(sensor_radius as u32))
    }

    /// A random world with a calendar, named `calendar-`, its kind and the seed, from Monday 0:00 on, in steps of 10 s: rooms with
    /// doors of one cell (a warehouse has none), and people, boxes and parked robots that are in their places or a few cells away,
    /// with schedules drawn from the ranges of [`WorldSpec::generate_calendar`](crate::physics::WorldSpec::generate_calendar).
    pub fn generate_calendar(kind: Kind, seed: u64) -> Self {
        let name = format!("calendar-{}", kind.name());
        building(&name, &ranges(kind), BuildingCalendar::new(kind, seed), STEP_S, seed)
    }
}

/// The world of a seed, whose name begins with that of its kind.
fn building(kind: &str, ranges: &Ranges, calendar: BuildingCalendar, step_s: f64, seed: u64) -> GridSpec {
    let mut rng = RandomStream::new(seed, Purpose::WorldGenerator);
    let [width, height] = ranges.size.map(|size| between(&mut rng, size));
    let frame = frame(width, height);
    let start = Cell::new(width / 2, height / 2);
    let settings =
        GenerateSettings { walls: ranges.walls, opening: [1, 1], pillars: [0, 0], ..Default::default() };
    let walls = rooms::walls(&settings, frame, start, &mut rng);
    let mut drawn = Drawn { walls: &walls, taken: BTreeSet::from([start]), calendar, blocks: Vec::new() };
    if ranges.has_doors {
        drawn.doors(&mut rng);
    }
    for _ in 0..between(&mut rng, ranges.things) {
        drawn.thing(&mut rng);
    }
    let (blocks, place) = (drawn.blocks, kind.trim_start_matches("calendar-"));
    GridSpec {
        name: format!("{kind}-{seed}"),
        description: format!("{place}: {width} × {height} cells made at random from the seed {seed}."),
        walls,
        blocks,
        start,
        sensor_radius: settings.sensor_radius,
        block_probability: 1.0,
        robot_probability: 1.0,
        calendar: Some(GridCalendar { starts_s: 0.0, step_s }),
    }
}

/// A world while it is drawn.
struct Drawn<'a> {
    walls: &'a Grid<bool>,
    /// The cells of the paths of all blocks, and the start of the robot.
    taken: BTreeSet<Cell>,
    calendar: BuildingCalendar,
    blocks: Vec<BlockSpec>,
}

impl Drawn<'_> {
    /// A door in every opening that has room beside it: an open one stands at the wall, in a random room and on a random side.
    fn doors(&mut self, rng: &mut RandomStream) {
        let frame = *self.walls.frame();
        for cell in (0..frame.len()).map(|index| frame.cell(index)) {
            let paths = self.leaves(cell);
            if let Some(path) = paths.choose(rng) {
                let schedule = self.calendar.draw(ThingKind::Door);
                self.add("door", path.clone(), schedule);
            }
        }
    }

    /// The ways on which a door in this cell can open: through a room, to the wall beside the opening. None if it is no opening.
    fn leaves(&self, cell: Cell) -> Vec<Vec<Cell>> {
        let by = |cell: Cell, (x, y): (i32, i32)| Cell::new(cell.x + x, cell.y + y);
        let is_wall = |cell: Cell| self.walls.get(cell) != Some(&false);
        if is_wall(cell) {
            return Vec::new();
        }
        let ways = SIDES.into_iter().flat_map(|(x, y)| {
            let along = [(y, x), (-y, -x)];
            let is_opening = along.iter().all(|side| is_wall(by(cell, *side)))
                && [(x, y), (-x, -y)].iter().all(|side| !is_wall(by(cell, *side)));
            let inside = by(cell, (x, y));
            along
                .into_iter()
                .filter(move |_| is_opening)
                .map(move |side| vec![cell, inside, by(inside, side)])
        });
        ways.filter(|path| path.iter().all(|cell| !is_wall(*cell) && self.is_clear(*cell))).collect()
    }

    /// Adds a thing that is in its place or a few cells away, if there is room.
    fn thing(&mut self, rng: &mut RandomStream) {
        let frame = *self.walls.frame();
        let path = (0..MAX_TRIES).find_map(|_| {
            let place = frame.cell(rng.random_range(0..frame.len()));
            let (x, y) = SIDES[rng.random_range(0..SIDES.len())];
            let away = rng.random_range(AWAY[0]..=AWAY[1]);
            let path: Vec<Cell> =
                (0..=away).map(|step| Cell::new(place.x + step * x, place.y + step * y)).collect();
            let has_room = path.iter().all(|cell| stands_free(self.walls, *cell) && self.is_clear(*cell));
            has_room.then_some(path)
        });
        let (kind, name) = THINGS[self.calendar.rng.random_range(0..THINGS.len())];
        let schedule = self.calendar.draw(kind);
        if let Some(path) = path {
            self.add(name, path, schedule);
        }
    }

    /// Whether a cell touches nothing that is there already.
    fn is_clear(&self, cell: Cell) -> bool {
        !cell.neighbours8().iter().chain([&cell]).any(|near| self.taken.contains(near))
    }

    fn add(&mut self, name: &str, path: Vec<Cell>, schedule: Schedule) {
        self.taken.extend(&path);
        let name = format!("{name} {}", self.blocks.len() + 1);
        let schedule = Some(Box::new(schedule));
        self.blocks.push(BlockSpec {
            name,
            dwell: 1,
            stood: 0,
            course: Course::BackAndForth,
            path,
            schedule,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GridWorld;
    use interfaces::{GroundTruth, Step, World};

    #[test]
    fn a_week_in_generated_buildings_has_doors_and_things_that_change() {
        for (name, kind) in Kind::ALL {
            let (mut doors, mut changes) = (0, 0);
            for seed in 0..8 {
                let spec = GridSpec::generate_calendar(kind, seed);
                assert_eq!(spec, GridSpec::generate_calendar(kind, seed), "{name} {seed}");
                assert!(spec.warnings().is_empty(), "{name} {seed}: {:?}", spec.warnings());
                assert!(spec.blocks.len() >= 2, "{name} {seed}");
                doors += spec.blocks.iter().filter(|block| block.name.starts_with("door")).count();
                let mut world = GridWorld::new(&spec, seed);
                for _ in 0..2 * 8640 {
                    world.act(&Step::Stay);
                }
                let truth = world.truth();
                changes += (0..truth.frame().len()).map(|cell| truth.block_events(cell)).sum::<u32>();
            }
            assert_eq!(doors > 0, kind != Kind::Warehouse, "{name}");
            assert!(changes > 300, "{name}: {changes}");
        }
    }
}
