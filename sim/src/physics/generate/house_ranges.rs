//! The parameter ranges of generated houses. A pair is the smallest and the largest value; each house draws its own
//! values between them. All lengths are rounded to cells of 0.05 m.
//!
//! These values are frozen: a house with a seed, and so every result on generated houses, depends on all of them. A
//! change of a value, or of the order in which values are drawn, needs new results in `docs/houses.md`.

/// The length of a house along its corridor, outer walls included, m.
pub const LENGTH_M: [f64; 2] = [9.5, 13.0];
/// The width of a house across its corridor, outer walls included, m.
pub const WIDTH_M: [f64; 2] = [8.0, 9.5];
/// The width of the corridor, m.
pub const CORRIDOR_M: [f64; 2] = [1.1, 1.6];
/// The smallest side of a room, m.
pub const MIN_ROOM_M: f64 = 2.4;
/// The number of rooms on each side of the corridor.
pub const ROOMS: [i32; 2] = [2, 4];
/// The probability of a room as wide as the house at the end of the corridor.
pub const END_ROOM_PROBABILITY: f64 = 0.5;
/// The length of this room along the corridor, m.
pub const END_ROOM_M: [f64; 2] = [3.0, 4.5];
/// The probability that a room can only be entered through the room beside it.
pub const INNER_ROOM_PROBABILITY: f64 = 0.15;
/// The probability of another doorway between two rooms that lie side by side.
pub const SIDE_DOORWAY_PROBABILITY: f64 = 0.25;
/// The width of a doorway, m.
pub const DOORWAY_M: [f64; 2] = [0.8, 1.0];
/// The probability that a doorway has a door.
pub const DOOR_PROBABILITY: f64 = 0.75;
/// The probability that a door slides, where the wall beside it is long enough. Other doors are hinged.
pub const SLIDING_PROBABILITY: f64 = 0.25;
/// The probability that a door opens periodically. Other doors open and close at random, with exponentially
/// distributed times.
pub const PERIODIC_PROBABILITY: f64 = 0.3;
/// The time for which a door is closed, s (at random: the mean). All orders of magnitude are equally likely.
pub const CLOSED_S: [f64; 2] = [10.0, 120.0];
/// The time for which a door is open, s (at random: the mean). All orders of magnitude are equally likely.
pub const OPEN_S: [f64; 2] = [15.0, 180.0];
/// The duration of the motion of a door, s.
pub const MOVE_S: [f64; 2] = [1.0, 2.0];
/// The probability of each piece of furniture of [`ROOMS_BY_NAME`], if the room has space for it.
pub const FURNITURE_PROBABILITY: f64 = 0.85;
/// The free space around furniture, m: between two pieces, and between a piece and a wall that it does not
/// touch. Every robot of a generated house fits through.
pub const CLEARANCE_M: f64 = 0.7;
/// The number of people: robots that walk from room to room.
pub const PEOPLE: [i32; 2] = [1, 3];
/// The radius of a person, m.
pub const PERSON_RADIUS_M: [f64; 2] = [0.18, 0.25];
/// The walking speed of a person, m/s.
pub const PERSON_SPEED_MPS: [f64; 2] = [0.3, 0.8];
/// The number of rooms that a person visits on a round.
pub const PERSON_ROOMS: [i32; 2] = [2, 5];
/// The probability of a vacuum cleaner: a robot that wanders.
pub const VACUUM_CLEANER_PROBABILITY: f64 = 0.5;
/// The names of rooms and their furniture. The largest room has the first name, the others have the next names
/// in a random order.
pub const ROOMS_BY_NAME: &[(&str, &[Furniture])] = &[
    (
        "living room",
        &[
            piece("sofa", [1.8, 2.4], [0.8, 1.0], Placement::Wall),
            SHELF,
            piece("coffee table", [0.8, 1.2], [0.5, 0.7], Placement::Free),
            ARMCHAIR,
        ],
    ),
    (
        "kitchen",
        &[
            piece("counter", [1.8, 3.0], [0.6, 0.6], Placement::Wall),
            piece("table", [1.0, 1.4], [0.7, 0.9], Placement::Free),
            piece("fridge", [0.6, 0.6], [0.6, 0.7], Placement::Wall),
        ],
    ),
    ("bathroom", &[piece("bath", [1.6, 1.8], [0.7, 0.8], Placement::Wall), CHEST]),
    ("bedroom", &[BED, WARDROBE, CHEST]),
    ("children's room", &[piece("bunk bed", [2.0, 2.0], [0.9, 1.0], Placement::Wall), DESK, CHEST]),
    ("study", &[DESK, SHELF, ARMCHAIR]),
    ("guest room", &[BED, DESK]),
    (
        "dining room",
        &[
            piece("table", [1.4, 2.0], [0.9, 1.0], Placement::Free),
            piece("sideboard", [1.2, 1.8], [0.4, 0.5], Placement::Wall),
        ],
    ),
    ("storeroom", &[SHELF, CHEST, WARDROBE]),
];

/// A kind of furniture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Furniture {
    /// The name.
    pub name: &'static str,
    /// The length along the wall, m.
    pub length_m: [f64; 2],
    /// The depth away from the wall, m.
    pub depth_m: [f64; 2],
    /// Where it stands.
    pub place: Placement,
}

/// Where a piece of furniture stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// At a wall.
    Wall,
    /// Anywhere in the room.
    Free,
    /// Anywhere in the room, at any angle.
    Turned,
}

const fn piece(name: &'static str, length_m: [f64; 2], depth_m: [f64; 2], place: Placement) -> Furniture {
    Furniture { name, length_m, depth_m, place }
}

const SHELF: Furniture = piece("shelf", [0.8, 1.6], [0.3, 0.4], Placement::Wall);
const WARDROBE: Furniture = piece("wardrobe", [1.0, 2.0], [0.6, 0.6], Placement::Wall);
const DESK: Furniture = piece("desk", [1.0, 1.6], [0.6, 0.8], Placement::Wall);
const BED: Furniture = piece("bed", [0.9, 1.8], [2.0, 2.0], Placement::Wall);
const ARMCHAIR: Furniture = piece("armchair", [0.75, 0.75], [0.75, 0.75], Placement::Turned);
const CHEST: Furniture = piece("chest", [0.6, 1.0], [0.4, 0.5], Placement::Wall);
