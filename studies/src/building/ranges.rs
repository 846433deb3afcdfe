//! The ranges from which generated buildings are drawn. They were set before any strategy was tuned, and stay.

use crate::calendar::{Kind, Range};

/// The speed of a robot, with its turns, m/s.
pub(super) const SPEED_MPS: f64 = 0.4;
/// The duration of a look around, s.
pub(super) const LOOK_S: f64 = 5.0;

/// What is drawn for a kind of building.
pub(super) struct Ranges {
    /// Numbers: the second value is not reached.
    pub(super) rooms: Range,
    /// The width of a room along the hall, m.
    pub(super) width_m: Range,
    pub(super) depth_m: Range,
    pub(super) viewpoints_per_room: Range,
    pub(super) things_per_room: Range,
    pub(super) things_per_hall_viewpoint: Range,
    /// The share of rooms that have a door.
    pub(super) door_share: f64,
}

pub(super) fn ranges(kind: Kind) -> Ranges {
    let home = Ranges {
        rooms: [4.0, 9.0],
        width_m: [3.0, 5.0],
        depth_m: [3.0, 5.0],
        viewpoints_per_room: [1.0, 3.0],
        things_per_room: [1.0, 4.0],
        things_per_hall_viewpoint: [0.0, 2.0],
        door_share: 0.8,
    };
    match kind {
        Kind::Home => home,
        Kind::Office => Ranges {
            rooms: [8.0, 17.0],
            things_per_room: [1.0, 3.0],
            viewpoints_per_room: [1.0, 2.0],
            door_share: 0.9,
            ..home
        },
        Kind::Warehouse => Ranges {
            rooms: [6.0, 13.0],
            width_m: [6.0, 12.0],
            depth_m: [10.0, 30.0],
            viewpoints_per_room: [2.0, 4.0],
            things_per_room: [2.0, 6.0],
            door_share: 0.1,
            ..home
        },
        Kind::Clinic => Ranges {
            rooms: [12.0, 21.0],
            things_per_room: [1.0, 4.0],
            viewpoints_per_room: [1.0, 2.0],
            door_share: 1.0,
            ..home
        },
    }
}

/// The distance of viewpoints in the hall, m.
pub(super) const HALL_SPACING_M: f64 = 6.0;
/// The probability that a thing in a room is seen from each of its viewpoints but the first one that sees it.
pub(super) const SEEN_ALSO: f64 = 0.4;
