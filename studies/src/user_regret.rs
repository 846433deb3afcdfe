//! What a wrong map costs a user: the time lost on routes between places through doors that were believed open.

use crate::{Building, STEP_S};
use std::collections::BTreeSet;

/// A door is believed open if it is closed with a smaller probability than this.
const OPEN: f64 = 0.5;

/// A way from a place to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// The other place.
    pub to: usize,
    /// The time that it takes, s.
    pub time_s: f64,
    /// The door that must be open.
    pub door: Option<usize>,
}

/// Places, and the ways from each of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Routes {
    /// The ways from each place.
    pub ways: Vec<Vec<Way>>,
    /// The places between which users want to go.
    pub ends: Vec<usize>,
}

/// The quickest routes from a place.
struct Tree {
    times_s: Vec<f64>,
    /// The last place before each place, and the way from there.
    last: Vec<Option<(usize, Way)>>,
}

impl Routes {
    /// The viewpoints of a building, between all of which users want to go. A way into a room with a door leads past the place
    /// in front of the door; people let a user out of a room. Times are those of the robot, which looks where it arrives.
    pub fn of_building(building: &Building) -> Self {
        let places = 0..building.viewpoints.len();
        let way = |from: usize, to: usize| {
            let door = building.door_between(from, to);
            let threshold = building.viewpoints[to].room.map(|room| building.rooms[room].threshold);
            let is_way = from != to && (door.is_none() || threshold == Some(from));
            is_way.then(|| Way { to, time_s: building.steps[from][to] as f64 * STEP_S, door })
        };
        let ways = places.clone().map(|from| places.clone().filter_map(|to| way(from, to)).collect());
        Self { ways: ways.collect(), ends: places.collect() }
    }

    /// The quickest routes through doors that are open.
    fn tree(&self, from: usize, is_open: impl Fn(usize) -> bool) -> Tree {
        let count = self.ways.len();
        let mut tree = Tree { times_s: vec![f64::INFINITY; count], last: vec![None; count] };
        tree.times_s[from] = 0.0;
        let mut open: Vec<usize> = (0..count).collect();
        // Graphs of places are small and dense: no heap.
        while let Some(at) = (0..open.len()).min_by(|a, b| {
            let time_s = |index: &usize| tree.times_s[open[*index]];
            time_s(a).total_cmp(&time_s(b))
        }) {
            let place = open.swap_remove(at);
            let time_s = tree.times_s[place];
            if time_s.is_infinite() {
                break;
            }
            for way in self.ways[place].iter().filter(|way| way.door.is_none_or(&is_open)) {
                if time_s + way.time_s < tree.times_s[way.to] {
                    tree.times_s[way.to] = time_s + way.time_s;
                    tree.last[way.to] = Some((place, *way));
                }
            }
        }
        tree
    }
}

impl Tree {
    /// The ways to a place that is reached, each with the place where it begins.
    fn route(&self, to: usize) -> Vec<(usize, Way)> {
        let mut route: Vec<(usize, Way)> =
            std::iter::successors(self.last[to], |(from, _)| self.last[*from]).collect();
        route.reverse();
        route
    }
}

/// What users lose. At each of some times, a user wants to go from every end to every other one, knows the predicted map of that
/// time, and plans the quickest route through doors that are closed with a probability below 0.5. Doors stay as they are during a
/// trip. In front of a door that is closed, the user plans again without it; if no route is left, the user goes back. A user who
/// knows no route does not go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UserRegret {
    trips: usize,
    possible: usize,
    lost_s: f64,
    not_made: usize,
}

impl UserRegret {
    /// All trips at a time. `predicted` and `is_blocked` are the probability that each thing is blocked, and whether it is.
    pub fn add(&mut self, routes: &Routes, predicted: &[f64], is_blocked: &[bool]) {
        for &from in &routes.ends {
            let truth = routes.tree(from, |door| !is_blocked[door]);
            let believed = routes.tree(from, |door| predicted[door] < OPEN);
            for &to in routes.ends.iter().filter(|to| **to != from) {
                self.trips += 1;
                self.possible += usize::from(truth.times_s[to].is_finite());
                let (spent_s, at) = trip(routes, &believed, [from, to], predicted, is_blocked);
                if at == to {
                    self.lost_s += spent_s - truth.times_s[to];
                } else {
                    // The way back takes as long as the way there.
                    self.lost_s += spent_s + truth.times_s[at];
                    self.not_made += usize::from(truth.times_s[to].is_finite());
                }
            }
        }
    }

    /// The mean time lost per trip against a user who knows all doors, s; NaN without a trip.
    pub fn lost_s(&self) -> f64 {
        self.lost_s / self.trips as f64
    }

    /// The share of the possible trips that were not made or were broken off, since no route was believed open; NaN without one.
    pub fn not_made(&self) -> f64 {
        self.not_made as f64 / self.possible as f64
    }
}

/// The time that a user spends on a trip, s, and where the user ends. `believed` are the routes from the beginning.
fn trip(
    routes: &Routes,
    believed: &Tree,
    [from, to]: [usize; 2],
    predicted: &[f64],
    is_blocked: &[bool],
) -> (f64, usize) {
    let (mut at, mut spent_s, mut closed) = (from, 0.0, BTreeSet::new());
    let mut route = believed.times_s[to].is_finite().then(|| believed.route(to));
    while let Some(ways) = route {
        for (_, way) in ways {
            if let Some(door) = way.door.filter(|door| is_blocked[*door]) {
                closed.insert(door);
                break;
            }
            (at, spent_s) = (way.to, spent_s + way.time_s);
        }
        if at == to {
            break;
        }
        let tree = routes.tree(at, |door| predicted[door] < OPEN && !closed.contains(&door));
        route = tree.times_s[to].is_finite().then(|| tree.route(to));
    }
    (spent_s, at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;
    use interfaces::{Purpose, RandomStream};
    use rand::RngExt;

    /// Two rooms, 0 and 3, with a corridor of two places between them: a short way through the doors 0 and 1, and from 0 a long
    /// way around.
    fn two_rooms() -> Routes {
        let mut ways = vec![Vec::new(); 4];
        for (a, b, time_s, door) in
            [(0, 1, 5.0, Some(0)), (1, 2, 10.0, None), (2, 3, 5.0, Some(1)), (0, 2, 40.0, None)]
        {
            ways[a].push(Way { to: b, time_s, door });
            ways[b].push(Way { to: a, time_s, door });
        }
        Routes { ways, ends: vec![0, 3] }
    }

    #[test]
    fn losses_by_hand() {
        let loss = |predicted: [f64; 2], is_blocked: [bool; 2]| {
            let mut regret = UserRegret::default();
            regret.add(&two_rooms(), &predicted, &is_blocked);
            (2.0 * regret.lost_s(), 2.0 * regret.not_made())
        };
        assert_eq!(loss([0.1, 0.1], [false, false]), (0.0, 0.0));
        // Door 0 is closed: from 0 at once the long way, 45 s; from 3 to it and back, 5 + 10 + 10 + 40 in place of 45 s.
        assert_eq!(loss([0.1, 0.1], [true, false]), (20.0, 0.0));
        assert_eq!(loss([0.9, 0.1], [true, false]), (0.0, 0.0));
        // Door 0 is open, and believed closed: 45 in place of 20 s, in both directions.
        assert_eq!(loss([0.9, 0.1], [false, false]), (50.0, 0.0));
        // Door 1 is closed: from 0 to it and back, 15 + 15 s; from 3 nothing. No trip is possible.
        let (lost_s, not_made) = loss([0.1, 0.1], [false, true]);
        assert!(lost_s == 30.0 && not_made.is_nan());
        // Door 1 is open, and believed closed: neither trip is made.
        assert_eq!(loss([0.1, 0.9], [false, false]), (0.0, 2.0));
    }

    /// In a building every door leads to a room of its own: the loss of a trip follows without a search.
    #[test]
    fn losses_in_buildings_follow_from_single_doors() {
        let mut rng = RandomStream::new(3, Purpose::Patrol);
        let (mut losses, mut missed) = (0.0, 0.0);
        for (seed, kind) in [(100_000, Kind::Home), (100_001, Kind::Office), (100_002, Kind::Clinic)] {
            let building = Building::generate(kind, seed);
            let things = building.things.len();
            let predicted: Vec<f64> = (0..things).map(|_| rng.random()).collect();
            let is_blocked: Vec<bool> = (0..things).map(|_| rng.random()).collect();
            let (mut lost, mut trips, mut possible, mut not_made) = (0.0, 0.0, 0.0, 0.0);
            for from in 0..building.viewpoints.len() {
                for to in (0..building.viewpoints.len()).filter(|to| *to != from) {
                    trips += 1.0;
                    let door = building.door_between(from, to);
                    let is_closed = door.is_some_and(|door| is_blocked[door]);
                    let is_believed_closed = door.is_some_and(|door| predicted[door] >= 0.5);
                    possible += f64::from(u8::from(!is_closed));
                    not_made += f64::from(u8::from(!is_closed && is_believed_closed));
                    if is_closed && !is_believed_closed {
                        let threshold = building.rooms[building.viewpoints[to].room.unwrap()].threshold;
                        let steps = if from == threshold { 0 } else { building.steps[from][threshold] };
                        lost += 2.0 * STEP_S * steps as f64;
                    }
                }
            }
            let mut regret = UserRegret::default();
            regret.add(&Routes::of_building(&building), &predicted, &is_blocked);
            losses += lost;
            missed += not_made;
            assert!((regret.lost_s() - lost / trips).abs() < 1e-9, "{kind:?}");
            assert!((regret.not_made() - not_made / possible).abs() < 1e-12);
        }
        assert!(losses > 0.0 && missed > 0.0, "{losses} {missed}");
    }
}
