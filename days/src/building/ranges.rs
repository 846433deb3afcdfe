//! The ranges from which generated buildings are drawn. They were set before any strategy was tuned, and stay.

use super::{Kind, ThingKind};
use crate::calendar::{DAY_S, HOUR_S};

/// An interval; lengths and times are drawn uniformly in their logarithm.
pub(super) type Range = [f64; 2];

/// The speed of a robot, with its turns, m/s.
pub(super) const SPEED_MPS: f64 = 0.4;
/// The duration of a look around, s.
pub(super) const LOOK_S: f64 = 5.0;

const MIN_S: f64 = 60.0;

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
    /// Days, begin and end of active hours, which are jittered by an hour in each building.
    pub(super) active: &'static [(&'static [usize], f64, f64)],
    /// How many times longer stays take in quiet hours than in active ones.
    pub(super) quiet_factor: Range,
    /// The probability that a thing is put to rest in quiet hours: doors are closed, people and boxes go.
    pub(super) rest_share: f64,
}

const ALL_DAYS: &[usize] = &[0, 1, 2, 3, 4, 5, 6];
const WEEKDAYS: &[usize] = &[0, 1, 2, 3, 4];

pub(super) fn ranges(kind: Kind) -> Ranges {
    let home = Ranges {
        rooms: [4.0, 9.0],
        width_m: [3.0, 5.0],
        depth_m: [3.0, 5.0],
        viewpoints_per_room: [1.0, 3.0],
        things_per_room: [1.0, 4.0],
        things_per_hall_viewpoint: [0.0, 2.0],
        door_share: 0.8,
        active: &[(WEEKDAYS, 6.5, 8.5), (WEEKDAYS, 16.0, 23.0), (&[5, 6], 8.5, 23.5)],
        quiet_factor: [5.0, 50.0],
        rest_share: 0.3,
    };
    match kind {
        Kind::Home => home,
        Kind::Office => Ranges {
            rooms: [8.0, 17.0],
            things_per_room: [1.0, 3.0],
            viewpoints_per_room: [1.0, 2.0],
            door_share: 0.9,
            active: &[(WEEKDAYS, 8.0, 18.0)],
            quiet_factor: [20.0, 200.0],
            rest_share: 0.8,
            ..home
        },
        Kind::Warehouse => Ranges {
            rooms: [6.0, 13.0],
            width_m: [6.0, 12.0],
            depth_m: [10.0, 30.0],
            viewpoints_per_room: [2.0, 4.0],
            things_per_room: [2.0, 6.0],
            door_share: 0.1,
            active: &[(&[0, 1, 2, 3, 4, 5], 6.0, 22.0)],
            quiet_factor: [20.0, 200.0],
            rest_share: 0.2,
            ..home
        },
        Kind::Clinic => Ranges {
            rooms: [12.0, 21.0],
            things_per_room: [1.0, 4.0],
            viewpoints_per_room: [1.0, 2.0],
            door_share: 1.0,
            active: &[(ALL_DAYS, 7.0, 20.0)],
            quiet_factor: [2.0, 10.0],
            rest_share: 0.4,
            ..home
        },
    }
}

/// Mean stays in active hours, s: free short, free long, blocked short, blocked long.
pub(super) fn stays(kind: ThingKind) -> [Range; 4] {
    match kind {
        ThingKind::Door => {
            [[MIN_S, 20.0 * MIN_S], [HOUR_S, 12.0 * HOUR_S], [MIN_S, 20.0 * MIN_S], [HOUR_S, 12.0 * HOUR_S]]
        }
        ThingKind::Person => [
            [2.0 * MIN_S, 30.0 * MIN_S],
            [HOUR_S, 6.0 * HOUR_S],
            [MIN_S, 20.0 * MIN_S],
            [0.5 * HOUR_S, 4.0 * HOUR_S],
        ],
        ThingKind::Box => [
            [0.5 * HOUR_S, 4.0 * HOUR_S],
            [6.0 * HOUR_S, 3.0 * DAY_S],
            [10.0 * MIN_S, 2.0 * HOUR_S],
            [3.0 * HOUR_S, 2.0 * DAY_S],
        ],
        ThingKind::ParkedRobot => {
            [[10.0 * MIN_S, HOUR_S], [HOUR_S, 5.0 * HOUR_S], [5.0 * MIN_S, HOUR_S], [HOUR_S, 8.0 * HOUR_S]]
        }
    }
}

/// The share of stays that are long.
pub(super) const LONG_SHARE: Range = [0.05, 0.5];
/// How long a thing that rests in quiet hours still waits before it does, s, and how long it then stays so.
pub(super) const BEFORE_REST_S: Range = [5.0 * MIN_S, HOUR_S];
pub(super) const REST_S: Range = [DAY_S, 10.0 * DAY_S];
/// The distance of viewpoints in the hall, m.
pub(super) const HALL_SPACING_M: f64 = 6.0;
/// The probability that a thing in a room is seen from each of its viewpoints but the first one that sees it.
pub(super) const SEEN_ALSO: f64 = 0.4;
