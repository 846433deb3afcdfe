//! Random rooms in a grid. In some of them things of several shapes come and go, move between places, or leave for good.

use super::building_ranges::{BuildingRanges, HOUSE, Placement};
use super::draw::{CELLS_PER_M, between, cells, integer, value};
use super::layout::{Area, BESIDE_DOORWAY, CORNER, Doorway, Layout, WALL, Wall};
use super::plan::Plan;
use super::{STEP_S, doors, furniture, robot};
use crate::building_calendar::{BuildingCalendar, Chains};
use crate::physics::shape::Rectangle;
use crate::physics::spec::{
    BehaviorSpec, ContactModel, FleetSpec, Motion, ObstacleSpec, ThingPart, WorldSpec,
};
use calendar::HOUR_S;
use interfaces::{GridFrame, Purpose, RandomStream};
use nalgebra::{Point2, Vector2};
use rand::RngExt;
use rand::seq::{IndexedRandom, SliceRandom};
use std::f64::consts::PI;

// All ranges in this file were frozen before anything was tuned on these worlds. Results depend on every one of them.

/// `rooms` is the number of columns, and of rows; mean stays are those of the kind of world.
const ROOMS: BuildingRanges = BuildingRanges {
    rooms: [2, 8],
    doorway_m: [0.8, 1.2],
    door_probability: 0.5,
    periodic_probability: 0.0,
    clearance_m: 0.6,
    ..HOUSE
};
/// The free length and width of a room, m.
const ROOM_M: [f64; 2] = [3.0, 5.0];
/// The probability of a doorway between two rooms that are connected anyway. Only such a doorway can have a door.
const DOORWAY_PROBABILITY: f64 = 0.5;
/// The probability that such doorways have doors.
const DOORS_PROBABILITY: f64 = 0.5;
/// The share of rooms with things.
const SHARE: [f64; 2] = [0.2, 0.6];
/// The number of things in such a room.
const THINGS: [i32; 2] = [1, 3];
/// The number of places of a thing that moves.
const PLACES: [i32; 2] = [2, 3];
/// The probability that the next place of a thing is in the same room.
const SAME_ROOM_PROBABILITY: f64 = 0.5;
/// The sides of boxes, and the diameters of discs, m.
const SIDE_M: [f64; 2] = [0.2, 1.2];
/// The sides of an L, and the width of its arms, m.
const L_M: [f64; 2] = [0.5, 1.2];
const ARM_M: [f64; 2] = [0.2, 0.35];
/// The side of a chair, and that of its legs, m. A robot does not fit between them.
const CHAIR_M: [f64; 2] = [0.4, 0.45];
const LEG_M: [f64; 2] = [0.03, 0.05];
/// The diameter of a parked robot, m.
const ROBOT_M: f64 = 0.4;
/// The number of rectangles that make a disc: a polygon with twice this number of sides.
const DISC_PARTS: u32 = 6;
/// The probability of a place at a wall.
const WALL_PROBABILITY: f64 = 0.5;
/// The probability that a thing moves between places, and that another thing leaves for good. Other things come and go.
const MOVE_PROBABILITY: f64 = 0.25;
const LEAVE_PROBABILITY: f64 = 0.2;
/// The mean time that a thing takes from place to place, s.
const MOVE_S: f64 = 10.0;
/// The stay away of a thing that leaves for good, s.
const FOR_GOOD_S: f64 = 1e9;
/// The range of the laser of the robot, m, and its number of beams in multiples of 90.
const RANGE_M: [f64; 2] = [2.5, 12.0];
const BEAMS: [i32; 2] = [1, 8];
/// The space in front of a doorway without a door that stays free, m.
const IN_FRONT_M: f64 = 0.7;
/// The number of draws until a thing has room.
const MAX_TRIES: usize = 60;

/// The world of a kind and a seed.
pub(super) fn rooms(kind: &str, chains: &'static Chains, seed: u64) -> Option<WorldSpec> {
    let mut rng = RandomStream::new(seed, Purpose::HouseGenerator);
    let ranges = BuildingRanges { closed_s: chains.stays_s, open_s: chains.stays_s, ..ROOMS };
    let (layout, plan) = (grid(&ranges, &mut rng), Plan { is_upright: false });
    let mut obstacles = doors::doors(&layout, &plan, &mut rng);
    let doors = obstacles.len();
    let calendar = BuildingCalendar::of_chains(chains, seed);
    let start = rng.random_range(0..layout.spaces.len());
    let mut things =
        Things { layout: &layout, chains, calendar, taken: Vec::new(), obstacles: Vec::new(), count: 0 };
    things.fill(start, doors, &mut rng);
    let count = things.count;
    obstacles.append(&mut things.obstacles);
    let Area { low, high } = layout.spaces[start];
    let middle = plan.point([0, 1].map(|axis| f64::from((low[axis] + high[axis]) / 2)));
    let mut explorer = robot("curious", middle, BehaviorSpec::Driven, ROBOT_M / 2.0, 0.8, &mut rng);
    explorer.laser.beams = 90 * integer(BEAMS, &mut rng) as usize;
    explorer.laser.range_max_m = value(RANGE_M, &mut rng);
    let size = plan.point(layout.size.map(f64::from));
    let change = match things.calendar.change_s() {
        change_s if change_s.is_finite() => format!(", rates change after {} h", change_s / HOUR_S),
        _ => String::new(),
    };
    let fleet = FleetSpec {
        name: format!("{kind}-{seed}"),
        description: format!(
            "{} rooms, things: {count}, doors: {doors}{change}; made at random from the seed {seed}.",
            layout.spaces.len()
        ),
        frame: GridFrame::covering(Point2::origin(), size.x, size.y, 1.0 / CELLS_PER_M)?,
        step_s: STEP_S,
        contacts: ContactModel::Sliding,
        walls: layout.solid_walls().iter().map(|wall| plan.rectangle(wall)).collect(),
        glass: Vec::new(),
        obstacles,
        robots: vec![explorer],
        starts_s: Some(0.0),
    };
    WorldSpec::new(fleet).ok()
}

/// Rooms in columns and rows. The doorways without a door connect all of them.
fn grid<'a>(ranges: &'a BuildingRanges, rng: &mut RandomStream) -> Layout<'a> {
    let [columns, rows] = [(); 2].map(|()| {
        let mut end = 0;
        let mut next = |rng: &mut RandomStream| {
            let from = end + WALL;
            end = from + between(ROOM_M, rng);
            [from, end]
        };
        (0..integer(ranges.rooms, rng)).map(|_| next(rng)).collect::<Vec<_>>()
    });
    let [right, top] = [&columns, &rows].map(|extents| extents[extents.len() - 1][1]);
    let mut layout = Layout::empty(ranges, [right + WALL, top + WALL]);
    let mut between_rooms = Vec::new();
    for (y, row) in rows.iter().enumerate() {
        for (x, column) in columns.iter().enumerate() {
            let room = layout.spaces.len();
            layout.spaces.push(Area::new(*column, *row));
            if x + 1 < columns.len() {
                between_rooms.push((Wall { across: 0, face: column[1], ends: *row }, [room, room + 1]));
            }
            if y + 1 < rows.len() {
                let wall = Wall { across: 1, face: row[1], ends: *column };
                layout.walls.push(wall);
                between_rooms.push((wall, [room, room + columns.len()]));
            }
        }
    }
    let inner = columns.iter().take(columns.len() - 1);
    layout.walls.extend(inner.map(|column| Wall { across: 0, face: column[1], ends: [WALL, top] }));
    between_rooms.shuffle(rng);
    let has_doors = rng.bernoulli(DOORS_PROBABILITY);
    let mut parts: Vec<usize> = (0..layout.spaces.len()).collect();
    let mut spare = Vec::new();
    for (wall, spaces) in between_rooms {
        let [part, other] = spaces.map(|space| parts[space]);
        if part == other && !rng.bernoulli(DOORWAY_PROBABILITY) {
            continue;
        }
        if part == other && has_doors {
            spare.push(layout.doorways.len());
        }
        parts.iter_mut().filter(|now| **now == other).for_each(|now| *now = part);
        let width = between(ranges.doorway_m, rng);
        let from = rng.random_range(wall.ends[0] + CORNER..=wall.ends[1] - CORNER - width);
        let ends = [from, from + width];
        layout.doorways.push(Doorway { wall, ends, spaces, can_have_door: false });
    }
    // A door has a leaf that must meet no other doorway.
    for index in spare {
        let door = layout.doorways[index];
        layout.doorways[index].can_have_door = [0, 1].into_iter().all(|side| {
            let others = layout.doorways.iter().enumerate().filter(|(other, _)| *other != index);
            let zones = others.flat_map(|(_, other)| zones(other, door.spaces[side]));
            zones.into_iter().all(|zone| !zone.overlaps(&door.zone(side)))
        });
    }
    layout
}

/// The areas of a doorway in a room that stay free.
fn zones(doorway: &Doorway, room: usize) -> impl Iterator<Item = Area> + use<> {
    let doorway = *doorway;
    [0, 1].into_iter().filter(move |side| doorway.spaces[*side] == room).map(move |side| {
        if doorway.can_have_door {
            return doorway.zone(side);
        }
        let (depth, [low, high]) = (cells(IN_FRONT_M), doorway.ends);
        let face = doorway.wall.face + if side == 0 { -depth } else { WALL };
        let (faces, ends) = ([face, face + depth], [low - BESIDE_DOORWAY, high + BESIDE_DOORWAY]);
        if doorway.wall.across == 1 { Area::new(ends, faces) } else { Area::new(faces, ends) }
    })
}

/// The things of a world while they are drawn.
struct Things<'a> {
    layout: &'a Layout<'a>,
    chains: &'static Chains,
    calendar: BuildingCalendar,
    /// The boxes around all places of all things, which never overlap.
    taken: Vec<Area>,
    obstacles: Vec<ObstacleSpec>,
    count: usize,
}

impl Things<'_> {
    /// Puts things into some of the rooms, but not into that where the robot starts; `first` is the index of their first obstacle.
    fn fill(&mut self, start: usize, first: usize, rng: &mut RandomStream) {
        let mut rooms: Vec<usize> = (0..self.layout.spaces.len()).filter(|room| *room != start).collect();
        rooms.shuffle(rng);
        let share = rng.uniform(SHARE[0]..SHARE[1]);
        rooms.truncate(((share * self.layout.spaces.len() as f64) as usize).max(1));
        for room in &rooms {
            for _ in 0..integer(THINGS, rng) {
                self.thing(*room, &rooms, first, rng);
            }
        }
    }

    /// Adds a thing to a room, with further places there or in others of `rooms`, if there is space.
    fn thing(&mut self, room: usize, rooms: &[usize], first: usize, rng: &mut RandomStream) {
        let moves = rng.bernoulli(MOVE_PROBABILITY);
        let leaves = !moves && rng.bernoulli(LEAVE_PROBABILITY);
        let wanted = if moves { integer(PLACES, rng) } else { 1 };
        let is_at_wall = rng.bernoulli(WALL_PROBABILITY);
        let shape = Shape::draw(is_at_wall, rng);
        let mut places = Vec::new();
        for number in 0..wanted {
            let other = *rooms.choose(rng).unwrap_or(&room);
            let room = if number == 0 || rng.bernoulli(SAME_ROOM_PROBABILITY) { room } else { other };
            places.extend(self.place(&shape, room, is_at_wall, rng));
        }
        let away_s = if leaves { Some(FOR_GOOD_S) } else { (places.len() > 1).then_some(MOVE_S) };
        let mut schedule = self.calendar.draw_chain(self.chains, away_s);
        schedule.starts_blocked |= leaves;
        self.count += usize::from(!places.is_empty());
        let (name, thing) = (format!("{} {}", shape.name, self.count), first + self.obstacles.len());
        for (place, (corner, quarters)) in places.iter().enumerate() {
            for (number, part) in shape.parts.iter().enumerate() {
                let name = match (place, number) {
                    (0, 0) => name.clone(),
                    _ => format!("{name}, place {}, part {}", place + 1, number + 1),
                };
                let box_ = part.placed(corner, shape.size, *quarters);
                let motion = Motion::Scheduled(Box::new(schedule.clone()));
                let part = ThingPart { thing, place, places: places.len() };
                let part = (places.len() * shape.parts.len() > 1).then_some(part);
                self.obstacles.push(ObstacleSpec { part, ..ObstacleSpec::new(&name, box_, motion) });
            }
        }
    }

    /// The lower left corner of a place for a shape in a room, and the quarter turns of the shape there.
    fn place(
        &mut self,
        shape: &Shape,
        room: usize,
        is_at_wall: bool,
        rng: &mut RandomStream,
    ) -> Option<([i32; 2], u32)> {
        let (area, clearance) = (&self.layout.spaces[room], cells(self.layout.ranges.clearance_m));
        let zones: Vec<Area> = self.layout.doorways.iter().flat_map(|doorway| zones(doorway, room)).collect();
        let place = if is_at_wall { Placement::Wall } else { Placement::Free };
        for _ in 0..MAX_TRIES {
            let quarters = rng.random_range(0..4);
            let [x, y] = shape.size;
            let size = if quarters % 2 == 0 { [x, y] } else { [y, x] };
            let wall = (place, rng.random_range(0..2), rng.random());
            let low = furniture::corner(size, wall, area, clearance, rng);
            let taken = Area { low, high: [low[0] + size[0], low[1] + size[1]] };
            let beside = taken.grown(clearance);
            // The notch of an L in a corner of the room must not face the corner: a robot there could not leave.
            let faces_high = [quarters % 3 == 0, quarters < 2];
            let faces_wall = |axis: usize| match faces_high[axis] {
                true => taken.high[axis] == area.high[axis],
                false => taken.low[axis] == area.low[axis],
            };
            if !(faces_wall(0) && faces_wall(1))
                && furniture::keeps_off(area, &taken, clearance)
                && zones.iter().all(|zone| !zone.overlaps(&taken))
                && self.taken.iter().all(|other| !other.overlaps(&beside))
            {
                self.taken.push(taken);
                return Some((low, quarters));
            }
        }
        None
    }
}

/// The shape of a thing.
struct Shape {
    name: &'static str,
    /// The sides of the upright box around it, cells.
    size: [i32; 2],
    parts: Vec<Part>,
}

/// A rectangle of a shape: its center from that of the shape, and its sides, m; its heading, degrees.
struct Part {
    center: Vector2<f64>,
    sides: Vector2<f64>,
    heading_deg: u32,
}

impl Shape {
    fn draw(is_at_wall: bool, rng: &mut RandomStream) -> Self {
        let [x, y] = [between(SIDE_M, rng), between(SIDE_M, rng)];
        let m = |cells: i32| f64::from(cells) / CELLS_PER_M;
        let upright = |low: [f64; 2], high: [f64; 2]| {
            let (low, high) = (Vector2::from(low), Vector2::from(high));
            Part { center: (low + high) / 2.0, sides: high - low, heading_deg: 0 }
        };
        match rng.random_range(0..5) {
            0 => {
                // In the middle of a room at any angle.
                let heading_deg = if is_at_wall { 0 } else { 15 * rng.random_range(0..6) };
                let (sin, cos) = libm::sincos(f64::from(heading_deg).to_radians());
                let extent = |x: f64, y: f64| ((x * cos + y * sin) - 1e-9).ceil() as i32;
                let size = [extent(f64::from(x), f64::from(y)), extent(f64::from(y), f64::from(x))];
                let sides = Vector2::new(m(x), m(y));
                Self { name: "box", size, parts: vec![Part { center: Vector2::zeros(), sides, heading_deg }] }
            }
            1 => Self { name: "disc", size: [x; 2], parts: disc(m(x)) },
            2 => Self { name: "parked robot", size: [cells(ROBOT_M); 2], parts: disc(ROBOT_M) },
            3 => {
                let (side, leg_m) = (between(CHAIR_M, rng), value(LEG_M, rng));
                let (far, near) = (m(side) / 2.0, m(side) / 2.0 - leg_m);
                let ends = [[-far, -near], [near, far]];
                let legs = ends.iter().flat_map(|x| ends.map(|y| upright([x[0], y[0]], [x[1], y[1]])));
                Self { name: "chair", size: [side; 2], parts: legs.collect() }
            }
            _ => {
                let [x, y] = [between(L_M, rng), between(L_M, rng)];
                let (arm_m, [right, top]) = (m(between(ARM_M, rng)), [x, y].map(|side| m(side) / 2.0));
                let along = upright([-right, -top], [right, arm_m - top]);
                let across = upright([-right, -top], [arm_m - right, top]);
                Self { name: "L-shape", size: [x, y], parts: vec![along, across] }
            }
        }
    }
}

/// A disc of a diameter, m, as the regular polygon in it: a rectangle from each side to the opposite one.
fn disc(diameter_m: f64) -> Vec<Part> {
    let (sin, cos) = libm::sincos(PI / f64::from(2 * DISC_PARTS));
    let sides = Vector2::new(diameter_m * cos, diameter_m * sin);
    let part = |number| Part { center: Vector2::zeros(), sides, heading_deg: 180 / DISC_PARTS * number };
    (0..DISC_PARTS).map(part).collect()
}

impl Part {
    /// The part of a shape with its lower left corner in a cell, after quarter turns of the shape. With short numbers.
    fn placed(&self, corner: &[i32; 2], size: [i32; 2], quarters: u32) -> Rectangle {
        let [x, y] = if quarters.is_multiple_of(2) { size } else { [size[1], size[0]] };
        let middle =
            Vector2::new(corner[0] * 2 + x, corner[1] * 2 + y).map(|at| f64::from(at) / 2.0 / CELLS_PER_M);
        let turned = (0..quarters).fold(self.center, |at, _| Vector2::new(-at.y, at.x));
        let short = |at: Vector2<f64>| Point2::from(at.map(|at_m| (at_m * 1000.0).round() / 1000.0));
        let (at, half_m) = (middle + turned, self.sides / 2.0);
        match (self.heading_deg + 90 * quarters) % 180 {
            0 => Rectangle::between(short(at - half_m), short(at + half_m)),
            90 => Rectangle::between(short(at - half_m.yx()), short(at + half_m.yx())),
            heading_deg => {
                let sides = short(self.sides).coords;
                Rectangle::around(short(at), sides, f64::from(heading_deg).to_radians())
            }
        }
    }
}
