//! The layout of a house: a corridor, rooms on both sides and at one end, walls and doorways. Lengths are in cells; axis
//! 0 runs along the corridor, axis 1 across it.

use super::building_ranges::BuildingRanges;
use super::draw::{between, cells, integer};
use interfaces::RandomStream;
use rand::RngExt;

/// The thickness of walls.
pub(super) const WALL: i32 = 2;
/// The index of the corridor in [`Layout::spaces`]; the other spaces are rooms.
pub(super) const CORRIDOR: usize = 0;
/// The wall between a doorway and the corner of a room.
pub(super) const CORNER: i32 = 5;
/// Beside a doorway this much stays free of furniture.
pub(super) const BESIDE_DOORWAY: i32 = 3;
/// Around the leaf of an open door this much stays free of furniture: with less, leaf and furniture could divide a room.
const AROUND_LEAF: i32 = 14;
/// The number of draws until a doorway has room.
const MAX_TRIES: usize = 30;

/// A box of cells, by its lower left and its upper right corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) low: [i32; 2],
    pub(super) high: [i32; 2],
}

impl Area {
    /// From the extent along the corridor and across it.
    pub(super) fn new(along: [i32; 2], across: [i32; 2]) -> Self {
        Self { low: [along[0], across[0]], high: [along[1], across[1]] }
    }

    pub(super) fn size(&self, axis: usize) -> i32 {
        self.high[axis] - self.low[axis]
    }

    /// Whether the two share more than a border.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.low[axis] < other.high[axis] && other.low[axis] < self.high[axis])
    }

    pub(super) fn grown(&self, by: i32) -> Self {
        Self { low: self.low.map(|end| end - by), high: self.high.map(|end| end + by) }
    }
}

/// A straight wall between two spaces or more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    /// The axis across the wall.
    pub(super) across: usize,
    /// The lower face.
    pub(super) face: i32,
    /// The ends.
    pub(super) ends: [i32; 2],
}

impl Wall {
    /// A part of the wall.
    fn part(&self, ends: [i32; 2]) -> Area {
        let faces = [self.face, self.face + WALL];
        if self.across == 1 { Area::new(ends, faces) } else { Area::new(faces, ends) }
    }
}

/// A gap in a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doorway {
    pub(super) wall: Wall,
    /// The ends of the gap along the wall.
    pub(super) ends: [i32; 2],
    /// The spaces at the lower and at the upper face of the wall.
    pub(super) spaces: [usize; 2],
    /// Whether it can have a door; otherwise it is as wide as the corridor.
    pub(super) can_have_door: bool,
}

impl Doorway {
    pub(super) fn width(&self) -> i32 {
        self.ends[1] - self.ends[0]
    }

    /// Whether the hinge of a door is at the lower end: at the end near the corner of the room, as in most houses.
    pub(super) fn is_hinge_low(&self) -> bool {
        self.ends[0] - self.wall.ends[0] <= self.wall.ends[1] - self.ends[1]
    }

    /// A position by its distance from the lower face of the wall, and by its place along the wall.
    pub(super) fn position(&self, from_face: f64, along: f64) -> [f64; 2] {
        let across = f64::from(self.wall.face) + from_face;
        if self.wall.across == 1 { [along, across] } else { [across, along] }
    }

    /// The area on one side (0: lower) that stays free of furniture.
    pub(super) fn zone(&self, side: usize) -> Area {
        let depth = self.width() + AROUND_LEAF;
        let face = self.wall.face + if side == 0 { -depth } else { WALL };
        let faces = [face, face + depth];
        let sides = [AROUND_LEAF, BESIDE_DOORWAY];
        let [low, high] = if self.is_hinge_low() { sides } else { [sides[1], sides[0]] };
        let ends = [self.ends[0] - low, self.ends[1] + high];
        if self.wall.across == 1 { Area::new(ends, faces) } else { Area::new(faces, ends) }
    }
}

/// The layout of a house.
pub(super) struct Layout<'a> {
    pub(super) ranges: &'a BuildingRanges,
    /// Length and width, outer walls included.
    pub(super) size: [i32; 2],
    /// The corridor, and then the rooms.
    pub(super) spaces: Vec<Area>,
    pub(super) doorways: Vec<Doorway>,
    pub(super) walls: Vec<Wall>,
}

impl<'a> Layout<'a> {
    pub(super) fn new(ranges: &'a BuildingRanges, rng: &mut RandomStream) -> Self {
        let size = [between(ranges.length_m, rng), between(ranges.width_m, rng)];
        let min_room = cells(ranges.min_room_m);
        let [right, top] = size.map(|extent| extent - WALL);
        let corridor = between(ranges.corridor_m, rng);
        let low = rng.random_range(WALL + min_room..=top - min_room - corridor - 2 * WALL) + WALL;
        let mut house = Self::empty(ranges, size);

        let mut along = [WALL, right];
        let end_room = rng.bernoulli(ranges.end_room_probability).then(|| {
            let (length, is_left) = (between(ranges.end_room_m, rng), rng.random());
            if is_left {
                along[0] += length + WALL;
                ([WALL, WALL + length], Wall { across: 0, face: WALL + length, ends: [WALL, top] })
            } else {
                along[1] -= length + WALL;
                ([right - length, right], Wall { across: 0, face: along[1], ends: [WALL, top] })
            }
        });
        let across = [low, low + corridor];
        house.spaces.push(Area::new(along, across));
        for (depth, face) in [([WALL, low - WALL], low - WALL), ([across[1] + WALL, top], across[1])] {
            let wall = Wall { across: 1, face, ends: along };
            house.rooms(depth, wall, rng);
        }
        if let Some((extent, wall)) = end_room {
            house.end_room(Area::new(extent, [WALL, top]), wall, rng);
        }
        house
    }

    /// Outer walls alone.
    pub(super) fn empty(ranges: &'a BuildingRanges, size: [i32; 2]) -> Self {
        let [length, width] = size;
        let along = [0, width - WALL].map(|face| Wall { across: 1, face, ends: [0, length] });
        let across = [0, length - WALL].map(|face| Wall { across: 0, face, ends: [WALL, width - WALL] });
        Self { ranges, size, spaces: Vec::new(), doorways: Vec::new(), walls: [along, across].concat() }
    }

    /// The rooms on one side of the corridor, behind `wall`.
    fn rooms(&mut self, depth: [i32; 2], wall: Wall, rng: &mut RandomStream) {
        let (min_room, [left, right]) = (cells(self.ranges.min_room_m), wall.ends);
        self.walls.push(wall);
        let most = (right - left + WALL) / (min_room + WALL);
        let count = integer(self.ranges.rooms, rng).min(most).max(1);
        let spare = right - left + WALL - count * (min_room + WALL);
        let mut cuts: Vec<i32> = (1..count).map(|_| rng.random_range(0..=spare)).collect();
        cuts.sort_unstable();
        cuts.push(spare);
        let mut from = left;
        let first = self.spaces.len();
        for (number, cut) in (1..).zip(cuts) {
            let to = left + number * (min_room + WALL) + cut - WALL;
            self.spaces.push(Area::new([from, to], depth));
            from = to + WALL;
        }
        let mut is_inner = vec![false; count as usize];
        for room in first..self.spaces.len() {
            let beside = (room > first).then(|| self.side_wall(room - 1, depth));
            if let Some(beside) = beside {
                self.walls.push(beside);
                is_inner[room - first] = !is_inner[room - first - 1]
                    && rng.bernoulli(self.ranges.inner_room_probability)
                    && self.doorway(beside, [room - 1, room], rng);
            }
            if !is_inner[room - first] {
                // Nothing else is at this part of the wall yet.
                let Area { low, high } = self.spaces[room];
                let is_below = wall.face < self.spaces[CORRIDOR].low[1];
                let spaces = if is_below { [room, CORRIDOR] } else { [CORRIDOR, room] };
                self.doorway(Wall { ends: [low[0], high[0]], ..wall }, spaces, rng);
                if let Some(beside) = beside.filter(|_| rng.bernoulli(self.ranges.side_doorway_probability)) {
                    self.doorway(beside, [room - 1, room], rng);
                }
            }
        }
    }

    /// The wall between a room and the next.
    fn side_wall(&self, room: usize, depth: [i32; 2]) -> Wall {
        Wall { across: 0, face: self.spaces[room].high[0], ends: depth }
    }

    /// The room at the end of the corridor, which opens into it.
    fn end_room(&mut self, area: Area, wall: Wall, rng: &mut RandomStream) {
        let room = self.spaces.len();
        let is_left = area.low[0] == WALL;
        let sorted = |other: usize| if is_left { [room, other] } else { [other, room] };
        self.spaces.push(area);
        self.walls.push(wall);
        let Area { low, high } = self.spaces[CORRIDOR];
        let ends = [low[1], high[1]];
        self.doorways.push(Doorway { wall, ends, spaces: sorted(CORRIDOR), can_have_door: false });
        for other in 1..room {
            let Area { low, high } = self.spaces[other];
            let touches = if is_left { low[0] == wall.face + WALL } else { high[0] == wall.face };
            if touches && rng.bernoulli(self.ranges.side_doorway_probability) {
                let part = Wall { ends: [low[1], high[1]], ..wall };
                self.doorway(part, sorted(other), rng);
            }
        }
    }

    /// Adds a doorway somewhere in a part of a wall, if there is room.
    fn doorway(&mut self, part: Wall, spaces: [usize; 2], rng: &mut RandomStream) -> bool {
        for _ in 0..MAX_TRIES {
            let width = between(self.ranges.doorway_m, rng);
            let [low, high] = [part.ends[0] + CORNER, part.ends[1] - CORNER - width];
            if low > high {
                continue;
            }
            let from = rng.random_range(low..=high);
            let doorway = Doorway { wall: part, ends: [from, from + width], spaces, can_have_door: true };
            if self.has_room(&doorway) {
                self.doorways.push(doorway);
                return true;
            }
        }
        false
    }

    /// Whether the doorway keeps away from all others, in both of its rooms.
    fn has_room(&self, doorway: &Doorway) -> bool {
        let zones = doorway.spaces.iter().enumerate().filter(|(_, space)| **space != CORRIDOR);
        zones.into_iter().all(|(side, space)| {
            let zone = doorway.zone(side);
            self.zones(*space).all(|other| !other.overlaps(&zone))
        })
    }

    /// The areas of a room that stay free of furniture.
    pub(super) fn zones(&self, space: usize) -> impl Iterator<Item = Area> {
        let sides = self.doorways.iter().flat_map(|doorway| [(doorway, 0), (doorway, 1)]);
        sides
            .filter(move |(doorway, side)| doorway.spaces[*side] == space)
            .map(|(doorway, side)| doorway.zone(side))
    }

    /// The solid parts of all walls.
    pub(super) fn solid_walls(&self) -> Vec<Area> {
        let mut solid = Vec::new();
        for wall in &self.walls {
            let is_here = |doorway: &&Doorway| {
                (doorway.wall.across, doorway.wall.face) == (wall.across, wall.face)
                    && wall.ends[0] < doorway.ends[1]
                    && doorway.ends[0] < wall.ends[1]
            };
            let mut gaps: Vec<[i32; 2]> =
                self.doorways.iter().filter(is_here).map(|doorway| doorway.ends).collect();
            gaps.sort_unstable();
            let mut from = wall.ends[0];
            for [low, high] in gaps {
                solid.push(wall.part([from, low]));
                from = high;
            }
            solid.push(wall.part([from, wall.ends[1]]));
        }
        solid.retain(|part| part.size(0) > 0 && part.size(1) > 0);
        solid
    }

    /// Whether this part of the wall of a doorway is solid: a sliding door fits into it.
    pub(super) fn is_solid(&self, doorway: &Doorway, ends: [i32; 2]) -> bool {
        let part = doorway.wall.part(ends);
        let walls = self.solid_walls();
        walls.iter().any(|wall| {
            (0..2).all(|axis| wall.low[axis] <= part.low[axis] && part.high[axis] <= wall.high[axis])
        })
    }
}
