//! The doors of a house.

use super::draw::{time_s, value};
use super::layout::{CORRIDOR, Doorway, Layout, WALL};
use super::plan::Plan;
use crate::physics::shape::Rectangle;
use crate::physics::spec::{DoorSpec, Leaf, Motion, ObstacleSpec, Opening};
use interfaces::RandomStream;
use rand::RngExt;
use std::f64::consts::FRAC_PI_2;

/// The thickness of the leaf of a door, m: half of that of a wall.
const LEAF_M: f64 = 0.05;

/// The doors of all doorways that have one.
pub(super) fn doors(layout: &Layout, plan: &Plan, rng: &mut RandomStream) -> Vec<ObstacleSpec> {
    let ranges = layout.ranges;
    let mut doors = Vec::new();
    for doorway in layout.doorways.iter().filter(|doorway| doorway.can_have_door) {
        if !rng.bernoulli(ranges.door_probability) {
            continue;
        }
        let is_sliding = rng.bernoulli(ranges.sliding_probability);
        let pocket = pocket(layout, doorway).filter(|_| is_sliding);
        let (shape, leaf) = match pocket {
            Some(is_low) => sliding(doorway, is_low, plan),
            None => hinged(doorway, plan, rng),
        };
        let [closed_s, open_s] = [ranges.closed_s, ranges.open_s].map(|range_s| time_s(range_s, rng));
        let opening = match rng.bernoulli(ranges.periodic_probability) {
            true => Opening::Periodic { closed_s, open_s },
            false => Opening::Random { closed_s, open_s },
        };
        let (move_s, starts_open) = (value(ranges.move_s, rng), rng.random());
        let motion = Motion::Door(DoorSpec { leaf, opening, move_s, starts_open });
        doors.push(ObstacleSpec::new(&format!("door {}", doors.len() + 1), shape, motion));
    }
    doors
}

/// The side on which a sliding door has room in the wall: `true` at the lower end of the doorway.
fn pocket(layout: &Layout, doorway: &Doorway) -> Option<bool> {
    let ([low, high], width) = (doorway.ends, doorway.width());
    let sides = [(true, [low - width, low]), (false, [high, high + width])];
    sides.into_iter().find(|(_, ends)| layout.is_solid(doorway, *ends)).map(|(is_low, _)| is_low)
}

/// A leaf in the lower half of the wall, which slides into the wall.
fn sliding(doorway: &Doorway, is_low: bool, plan: &Plan) -> (Rectangle, Leaf) {
    let [from, to] = ends(doorway, 0.5, is_low, plan);
    // As a world file says it: from the second end toward the first one, by the length.
    let (back_m, length_m) = (from - to, (to - from).norm());
    (Rectangle::along(from, to, LEAF_M), Leaf::Sliding { by_m: back_m / length_m * length_m })
}

/// A leaf at one face of the wall, which swings into a room.
fn hinged(doorway: &Doorway, plan: &Plan, rng: &mut RandomStream) -> (Rectangle, Leaf) {
    let (is_low, into_upper) = (doorway.is_hinge_low(), rng.random());
    let into_upper = match doorway.spaces {
        [CORRIDOR, _] => true,
        [_, CORRIDOR] => false,
        _ => into_upper,
    };
    let from_face = if into_upper { f64::from(WALL) - 0.5 } else { 0.5 };
    let [hinge, end] = ends(doorway, from_face, is_low, plan);
    let [inside, _] = ends(doorway, if into_upper { 10.0 } else { -10.0 }, is_low, plan);
    let is_left = (end - hinge).perp(&(inside - hinge)) > 0.0;
    let open_rad = if is_left { FRAC_PI_2 } else { -FRAC_PI_2 };
    (Rectangle::along(hinge, end, LEAF_M), Leaf::Hinged { hinge, open_rad })
}

/// The ends of a line through a doorway, at a distance from the lower face of the wall; the lower end comes first if
/// `is_low`.
fn ends(doorway: &Doorway, from_face: f64, is_low: bool, plan: &Plan) -> [nalgebra::Point2<f64>; 2] {
    let mut ends = doorway.ends.map(|end| plan.point(doorway.position(from_face, f64::from(end))));
    if !is_low {
        ends.reverse();
    }
    ends
}
