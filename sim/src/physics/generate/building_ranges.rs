//! The parameter ranges of generated buildings. A pair is the smallest and the largest value; each building draws its own
//! values between them. All lengths are rounded to cells of 0.05 m.
//!
//! The values of [`HOUSE`] and [`OFFICE`] are frozen: a building with a seed, and so every result on generated buildings,
//! depends on all of them. A change of a value, or of the order in which values are drawn, needs new results in
//! `docs/houses.md`.

/// What a kind of building draws its values from.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildingRanges {
    /// The kind, the first part of the name of a building.
    pub kind: &'static str,
    /// The length of a building along its corridor, outer walls included, m.
    pub length_m: [f64; 2],
    /// The width of a house across its corridor, outer walls included, m.
    pub width_m: [f64; 2],
    /// The width of the corridor, m.
    pub corridor_m: [f64; 2],
    /// The smallest side of a room, m.
    pub min_room_m: f64,
    /// The number of rooms on each side of the corridor.
    pub rooms: [i32; 2],
    /// The probability of a room as wide as the building at the end of the corridor.
    pub end_room_probability: f64,
    /// The length of this room along the corridor, m.
    pub end_room_m: [f64; 2],
    /// The probability that a room can only be entered through the room beside it.
    pub inner_room_probability: f64,
    /// The probability of another doorway between two rooms that lie side by side.
    pub side_doorway_probability: f64,
    /// The width of a doorway, m.
    pub doorway_m: [f64; 2],
    /// The probability that a doorway has a door.
    pub door_probability: f64,
    /// The probability that a door slides, where the wall beside it is long enough. Other doors are hinged.
    pub sliding_probability: f64,
    /// The probability that a door opens periodically. Other doors open and close at random, with exponentially
    /// distributed times.
    pub periodic_probability: f64,
    /// The time for which a door is closed, s (at random: the mean). All orders of magnitude are equally likely.
    pub closed_s: [f64; 2],
    /// The time for which a door is open, s (at random: the mean). All orders of magnitude are equally likely.
    pub open_s: [f64; 2],
    /// The duration of the motion of a door, s.
    pub move_s: [f64; 2],
    /// The probability of each piece of furniture of [`Self::furnished_rooms`], if the room has space for it.
    pub furniture_probability: f64,
    /// The free space around furniture, m: between two pieces, and between a piece and a wall that it does not
    /// touch. Every robot of a generated house fits through.
    pub clearance_m: f64,
    /// The number of people: robots that walk from room to room.
    pub people: [i32; 2],
    /// The radius of a person, m.
    pub person_radius_m: [f64; 2],
    /// The walking speed of a person, m/s.
    pub person_speed_mps: [f64; 2],
    /// The number of rooms that a person visits on a round.
    pub person_rooms: [i32; 2],
    /// The probability of a vacuum cleaner: a robot that wanders.
    pub vacuum_cleaner_probability: f64,
    /// The names of rooms and their furniture. The largest room has the first name, the others have the next names
    /// in a random order.
    pub furnished_rooms: &'static [(&'static str, &'static [Furniture])],
}

/// A house: small rooms at a corridor, doors that move every minute or two, one to three people.
pub const HOUSE: BuildingRanges = BuildingRanges {
    kind: "house",
    length_m: [9.5, 13.0],
    width_m: [8.0, 9.5],
    corridor_m: [1.1, 1.6],
    min_room_m: 2.4,
    rooms: [2, 4],
    end_room_probability: 0.5,
    end_room_m: [3.0, 4.5],
    inner_room_probability: 0.15,
    side_doorway_probability: 0.25,
    doorway_m: [0.8, 1.0],
    door_probability: 0.75,
    sliding_probability: 0.25,
    periodic_probability: 0.3,
    closed_s: [10.0, 120.0],
    open_s: [15.0, 180.0],
    move_s: [1.0, 2.0],
    furniture_probability: 0.85,
    clearance_m: 0.7,
    people: [1, 3],
    person_radius_m: [0.18, 0.25],
    person_speed_mps: [0.3, 0.8],
    person_rooms: [2, 5],
    vacuum_cleaner_probability: 0.5,
    furnished_rooms: &[
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
                FRIDGE,
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
    ],
};

/// An office: more and larger rooms, a wide corridor, doors that stay for minutes, three to six people.
pub const OFFICE: BuildingRanges = BuildingRanges {
    kind: "office",
    length_m: [20.0, 30.0],
    width_m: [11.0, 15.0],
    corridor_m: [1.8, 2.4],
    min_room_m: 2.8,
    rooms: [4, 7],
    end_room_probability: 0.6,
    end_room_m: [5.0, 7.0],
    inner_room_probability: 0.1,
    side_doorway_probability: 0.1,
    doorway_m: [0.85, 1.1],
    door_probability: 0.85,
    sliding_probability: 0.1,
    periodic_probability: 0.1,
    closed_s: [60.0, 600.0],
    open_s: [60.0, 900.0],
    move_s: [1.5, 3.0],
    furniture_probability: 0.8,
    clearance_m: 0.7,
    people: [3, 6],
    person_radius_m: [0.18, 0.25],
    person_speed_mps: [0.5, 1.0],
    person_rooms: [2, 4],
    vacuum_cleaner_probability: 0.3,
    furnished_rooms: &[
        ("meeting room", &[piece("table", [1.8, 2.8], [0.9, 1.2], Placement::Free), CUPBOARD]),
        ("kitchenette", &[piece("counter", [1.5, 2.4], [0.6, 0.6], Placement::Wall), FRIDGE]),
        ("copy room", &[piece("copier", [0.7, 1.2], [0.6, 0.7], Placement::Wall), SHELF]),
        ("shared office", &[DESK, SECOND_DESK, CUPBOARD, CHAIR]),
        ("office", &[DESK, SHELF, CHAIR]),
        ("team office", &[DESK, SECOND_DESK, SHELF]),
    ],
};

/// A warehouse, for buildings with a calendar: few large halls, hardly a door.
pub const WAREHOUSE: BuildingRanges = BuildingRanges {
    kind: "warehouse",
    length_m: [24.0, 36.0],
    width_m: [18.0, 26.0],
    corridor_m: [2.4, 3.2],
    min_room_m: 5.0,
    rooms: [2, 4],
    doorway_m: [1.1, 1.8],
    door_probability: 0.2,
    furnished_rooms: &[("hall", &[SHELF, SECOND_SHELF, CUPBOARD])],
    ..OFFICE
};

/// A clinic, for buildings with a calendar: many rooms, all of them with doors.
pub const CLINIC: BuildingRanges = BuildingRanges {
    kind: "clinic",
    length_m: [26.0, 36.0],
    rooms: [6, 9],
    door_probability: 1.0,
    furnished_rooms: &[("ward", &[BED, CHEST, CHAIR]), ("office", &[DESK, SHELF, CHAIR])],
    ..OFFICE
};

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
const SECOND_SHELF: Furniture = piece("second shelf", SHELF.length_m, SHELF.depth_m, Placement::Wall);
const WARDROBE: Furniture = piece("wardrobe", [1.0, 2.0], [0.6, 0.6], Placement::Wall);
const DESK: Furniture = piece("desk", [1.0, 1.6], [0.6, 0.8], Placement::Wall);
const SECOND_DESK: Furniture = piece("second desk", DESK.length_m, DESK.depth_m, Placement::Wall);
const BED: Furniture = piece("bed", [0.9, 1.8], [2.0, 2.0], Placement::Wall);
const FRIDGE: Furniture = piece("fridge", [0.6, 0.6], [0.6, 0.7], Placement::Wall);
const CUPBOARD: Furniture = piece("cupboard", [0.8, 1.6], [0.4, 0.5], Placement::Wall);
const CHAIR: Furniture = piece("chair", [0.5, 0.5], [0.5, 0.5], Placement::Turned);
const ARMCHAIR: Furniture = piece("armchair", [0.75, 0.75], [0.75, 0.75], Placement::Turned);
const CHEST: Furniture = piece("chest", [0.6, 1.0], [0.4, 0.5], Placement::Wall);
