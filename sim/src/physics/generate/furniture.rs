//! The furniture of a house, and the names of its rooms. A piece touches a wall, or keeps so far away from it that every
//! robot fits through; so it does from other pieces. Furniture therefore never divides a room.

use super::building_ranges::{Furniture, Placement};
use super::draw::{between, cells};
use super::layout::{Area, Layout};
use interfaces::RandomStream;
use rand::RngExt;

/// The number of draws until a piece has room.
const MAX_TRIES: usize = 40;
/// The angles of turned pieces are multiples of this, degrees.
const ANGLE_DEG: i32 = 15;

/// A piece of furniture.
pub(super) struct Piece {
    pub(super) name: String,
    /// The box around the piece.
    pub(super) area: Area,
    /// For a turned piece the length of its sides, in cells, and its heading, degrees.
    pub(super) turned: Option<(i32, i32)>,
}

/// The furniture of all rooms.
pub(super) fn furniture(layout: &Layout, rng: &mut RandomStream) -> Vec<Piece> {
    let ranges = layout.ranges;
    let mut pieces: Vec<Piece> = Vec::new();
    for (room, (name, list)) in named(layout, rng) {
        let first = pieces.len();
        for kind in list {
            if !rng.bernoulli(ranges.furniture_probability) {
                continue;
            }
            let clearance = cells(ranges.clearance_m);
            let mut drawn = (0..MAX_TRIES).map(|_| draw(kind, &layout.spaces[room], clearance, rng));
            let fits = |(area, _): &(Area, _)| {
                let beside = area.grown(clearance);
                keeps_off(&layout.spaces[room], area, clearance)
                    && layout.zones(room).all(|zone| !zone.overlaps(area))
                    && pieces[first..].iter().all(|other| !other.area.overlaps(&beside))
            };
            if let Some((area, turned)) = drawn.find(fits) {
                pieces.push(Piece { name: format!("{name} {}", kind.name), area, turned });
            }
        }
    }
    pieces
}

/// The rooms with a name and the kinds of their furniture.
fn named(layout: &Layout, rng: &mut RandomStream) -> Vec<(usize, (String, &'static [Furniture]))> {
    let size = |room: &usize| layout.spaces[*room].size(0) * layout.spaces[*room].size(1);
    let mut rooms: Vec<usize> = (1..layout.spaces.len()).collect();
    rooms.sort_by_key(|room| -size(room));
    for index in (2..rooms.len()).rev() {
        rooms.swap(index, rng.random_range(1..=index));
    }
    let kinds = layout.ranges.furnished_rooms;
    let named = |(number, room): (usize, usize)| {
        let (name, list) = kinds[number % kinds.len()];
        let name = if number < kinds.len() { name.to_owned() } else { format!("{name} {}", number + 1) };
        (room, (name, list))
    };
    rooms.into_iter().enumerate().map(named).collect()
}

/// A piece of a kind at a random place.
fn draw(kind: &Furniture, room: &Area, clearance: i32, rng: &mut RandomStream) -> (Area, Option<(i32, i32)>) {
    let (length, depth) = (between(kind.length_m, rng), between(kind.depth_m, rng));
    // The axis along the piece, and the wall at which it stands.
    let (axis, is_high) = (rng.random_range(0..2_usize), rng.random::<bool>());
    let mut size = if axis == 0 { [length, depth] } else { [depth, length] };
    let mut turned = None;
    if kind.place == Placement::Turned {
        let heading_deg = ANGLE_DEG * rng.random_range(1..90 / ANGLE_DEG);
        let (sin, cos) = libm::sincos(f64::from(heading_deg).to_radians());
        size = [(f64::from(length) * (sin + cos)).ceil() as i32; 2];
        turned = Some((length, heading_deg));
    }
    let low = corner(size, (kind.place, axis, is_high), room, clearance, rng);
    (Area { low, high: [low[0] + size[0], low[1] + size[1]] }, turned)
}

/// The lower left corner of a piece of this size at a random place: anywhere in the room, or along `axis` at its lower or
/// higher wall.
pub(super) fn corner(
    size: [i32; 2],
    (place, axis, is_high): (Placement, usize, bool),
    room: &Area,
    clearance: i32,
    rng: &mut RandomStream,
) -> [i32; 2] {
    let mut low = [0, 1].map(|axis| {
        let spare = (room.size(axis) - size[axis]).max(0);
        let at = rng.random_range(0..=spare);
        // Near the corner of the room: into the corner.
        room.low[axis]
            + match place {
                Placement::Wall if at < clearance => 0,
                Placement::Wall if spare - at < clearance => spare,
                _ => at,
            }
    });
    if place == Placement::Wall {
        let across = 1 - axis;
        low[across] = if is_high { room.high[across] - size[across] } else { room.low[across] };
    }
    low
}

/// Whether the piece is in the room, and each of its sides touches the wall or keeps the clearance.
pub(super) fn keeps_off(room: &Area, area: &Area, clearance: i32) -> bool {
    let is_valid = |gap: i32| gap == 0 || gap >= clearance;
    (0..2)
        .all(|axis| is_valid(area.low[axis] - room.low[axis]) && is_valid(room.high[axis] - area.high[axis]))
}
