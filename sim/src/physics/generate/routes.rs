//! The rounds of people: straight legs between places in rooms, and the two sides of doorways.

use super::building_ranges::BuildingRanges;
use super::draw::integer;
use super::layout::{CORRIDOR, Layout, WALL};
use super::plan::Plan;
use crate::physics::shape::Rectangle;
use interfaces::RandomStream;
use nalgebra::Point2;
use rand::RngExt;

/// Free space beside a leg, m: more than a world file asks for.
const BESIDE_M: f64 = 0.07;
/// The distance of the places in front of a doorway from its wall, cells.
const IN_FRONT: f64 = 9.0;
/// The number of places in a room.
const PLACES: usize = 3;
/// The number of draws for these places.
const MAX_TRIES: usize = 60;

/// The places that people and other robots can be at, and the legs between them.
pub(super) struct Routes<'a> {
    pub(super) ranges: &'a BuildingRanges,
    /// All places, m: those in rooms, with the index of the room, and those in front of doorways.
    places: Vec<(Point2<f64>, Option<usize>)>,
    /// For every place, the places at the other ends of free legs.
    legs: Vec<Vec<usize>>,
}

impl<'a> Routes<'a> {
    /// The places that keep away from `solids`: walls, furniture, open doors.
    pub(super) fn new(
        layout: &Layout<'a>,
        solids: &[Rectangle],
        plan: &Plan,
        rng: &mut RandomStream,
    ) -> Self {
        let ranges = layout.ranges;
        let keep_m = ranges.person_radius_m[1] + BESIDE_M;
        let mut places = Vec::new();
        for doorway in &layout.doorways {
            let middle = f64::from(doorway.ends[0] + doorway.ends[1]) / 2.0;
            for (side, space) in doorway.spaces.into_iter().enumerate() {
                let corridor = &layout.spaces[CORRIDOR];
                let away = match space {
                    CORRIDOR if doorway.can_have_door => f64::from(corridor.size(1)) / 2.0,
                    _ => IN_FRONT,
                };
                let from_face = if side == 0 { -away } else { f64::from(WALL) + away };
                places.push((plan.point(doorway.position(from_face, middle)), None));
            }
        }
        for (room, area) in layout.spaces.iter().enumerate().skip(1) {
            let mut found = 0;
            for _ in 0..MAX_TRIES {
                let at = [0, 1].map(|axis| rng.random_range(area.low[axis]..=area.high[axis]));
                let is_in_doorway = layout
                    .zones(room)
                    .any(|zone| (0..2).all(|axis| zone.low[axis] <= at[axis] && at[axis] <= zone.high[axis]));
                let place = plan.point(at.map(f64::from));
                if !is_in_doorway && solids.iter().all(|solid| solid.distance_m(&place) >= keep_m) {
                    places.push((place, Some(room)));
                    found += 1;
                }
                if found == PLACES {
                    break;
                }
            }
        }
        let is_leg = |a: usize, b: usize| {
            let [from, to] = [a, b].map(|place: usize| places[place].0);
            (to - from).norm() >= 0.1
                && solids.iter().all(|solid| solid.segment_distance_m(&from, &to) >= keep_m)
        };
        let legs = (0..places.len()).map(|a| (0..places.len()).filter(|b| is_leg(a, *b)).collect());
        let legs: Vec<Vec<usize>> = legs.collect();
        Self { ranges, places, legs }
    }

    /// A random place in a room; `None` if there is none.
    pub(super) fn place(&self, rng: &mut RandomStream) -> Option<Point2<f64>> {
        self.draw(rng, |_| true).map(|place| self.places[place].0)
    }

    /// The places in each room that has any, m.
    pub(super) fn places_by_room(&self) -> Vec<Vec<Point2<f64>>> {
        let in_rooms: Vec<_> = self.places.iter().filter(|(_, room)| room.is_some()).collect();
        let rooms = in_rooms.chunk_by(|(_, a), (_, b)| a == b);
        rooms.map(|places| places.iter().map(|(at, _)| *at).collect()).collect()
    }

    fn draw(&self, rng: &mut RandomStream, is_valid: impl Fn(usize) -> bool) -> Option<usize> {
        let in_room = |place: &usize| self.places[*place].1.is_some_and(&is_valid);
        let all: Vec<usize> = (0..self.places.len()).filter(in_room).collect();
        (!all.is_empty()).then(|| all[rng.random_range(0..all.len())])
    }

    /// The waypoints of a round through several rooms, from a place in a room, m. `None` if no way leads to other
    /// rooms.
    pub(super) fn round(&self, rng: &mut RandomStream) -> Option<Vec<Point2<f64>>> {
        let start = self.draw(rng, |_| true)?;
        let mut round = vec![start];
        for _ in 1..integer(self.ranges.person_rooms, rng) {
            let room = self.places[round[round.len() - 1]].1;
            let next = self.draw(rng, |other| Some(other) != room)?;
            round.extend(self.way(round[round.len() - 1], next)?);
        }
        if round[round.len() - 1] != start {
            round.extend(self.way(round[round.len() - 1], start)?);
        }
        round.pop(); // the round begins again at the start
        (round.len() > 1).then(|| round.into_iter().map(|place| self.places[place].0).collect())
    }

    /// The shortest way from a place to another (Dijkstra, 1959), without the first place; `None` if there is none.
    fn way(&self, from: usize, to: usize) -> Option<Vec<usize>> {
        let mut lengths_m = vec![f64::INFINITY; self.places.len()];
        let mut before = vec![from; self.places.len()];
        let mut open: Vec<usize> = (0..self.places.len()).collect();
        lengths_m[from] = 0.0;
        while let Some(nearest) =
            (0..open.len()).min_by(|a, b| lengths_m[open[*a]].total_cmp(&lengths_m[open[*b]]))
        {
            let place = open.swap_remove(nearest);
            for &next in &self.legs[place] {
                let length_m = lengths_m[place] + (self.places[next].0 - self.places[place].0).norm();
                if length_m < lengths_m[next] {
                    (lengths_m[next], before[next]) = (length_m, place);
                }
            }
        }
        if lengths_m[to].is_infinite() {
            return None;
        }
        let mut way = vec![to];
        while before[way[way.len() - 1]] != from {
            way.push(before[way[way.len() - 1]]);
        }
        way.reverse();
        Some(way)
    }
}
