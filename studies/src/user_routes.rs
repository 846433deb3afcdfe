//! The ways of users through a building, for [`UserRegret`](evaluation::metrics::UserRegret).

use crate::{Building, STEP_S};
use evaluation::metrics::{Routes, Way};

/// The viewpoints of a building, between all of which users want to go. A way into a room with a door leads past the place
/// in front of the door; people let a user out of a room. Times are those of the robot, which looks where it arrives.
pub fn routes(building: &Building) -> Routes {
    let places = 0..building.viewpoints.len();
    let way = |from: usize, to: usize| {
        let door = building.door_between(from, to);
        let threshold = building.viewpoints[to].room.map(|room| building.rooms[room].threshold);
        let is_way = from != to && (door.is_none() || threshold == Some(from));
        is_way.then(|| Way { to, time_s: building.steps[from][to] as f64 * STEP_S, door })
    };
    let ways = places.clone().map(|from| places.clone().filter_map(|to| way(from, to)).collect());
    Routes { ways: ways.collect(), ends: places.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;
    use evaluation::metrics::UserRegret;
    use interfaces::{Purpose, RandomStream};
    use rand::RngExt;

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
            regret.add(&routes(&building), &predicted, &is_blocked);
            losses += lost;
            missed += not_made;
            assert!((regret.lost_s() - lost / trips).abs() < 1e-9, "{kind:?}");
            assert!((regret.not_made() - not_made / possible).abs() < 1e-12);
        }
        assert!(losses > 0.0 && missed > 0.0, "{losses} {missed}");
    }
}
