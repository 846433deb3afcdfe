use super::ranges::{HALL_SPACING_M, LOOK_S, Ranges, SEEN_ALSO, SPEED_MPS, ranges};
use super::{Building, Kind, Room, Thing, ThingKind, Viewpoint};
use crate::calendar::{Habit, Hours, Range, log_uniform};
use interfaces::{Purpose, RandomStream};

impl Building {
    /// A building of a kind; the same seed gives the same building.
    pub fn generate(kind: Kind, seed: u64) -> Self {
        let index = Kind::ALL.iter().position(|(_, other)| *other == kind).unwrap_or(0);
        let seed = seed.wrapping_mul(Kind::ALL.len() as u64).wrapping_add(index as u64);
        let mut draw =
            Draw { rng: RandomStream::new(seed, Purpose::DayGenerator), kind, ranges: ranges(kind) };
        draw.building()
    }
}

struct Draw {
    rng: RandomStream,
    kind: Kind,
    ranges: Ranges,
}

/// A place in the building, m: along the hall, and across it (0 in the hall), by way of the door at `door_m` along it.
struct Spot {
    along_m: f64,
    across_m: f64,
    door_m: f64,
}

impl Draw {
    fn count(&mut self, [low, high]: Range) -> usize {
        self.rng.uniform(low..high).floor() as usize
    }

    fn log_uniform(&mut self, range: Range) -> f64 {
        log_uniform(range, &mut self.rng)
    }

    fn building(&mut self) -> Building {
        let hours = self.kind.draw_hours(&mut self.rng);
        let rooms = self.count(self.ranges.rooms);
        let widths: Vec<f64> = (0..rooms).map(|_| self.log_uniform(self.ranges.width_m)).collect();
        // Rooms lie in pairs on both sides of the hall.
        let length_m: f64 = widths.iter().step_by(2).sum();
        let halls = (length_m / HALL_SPACING_M).ceil().max(1.0) as usize;
        let mut building = Building {
            things: Vec::new(),
            rooms: Vec::new(),
            viewpoints: Vec::new(),
            dock: 0,
            steps: Vec::new(),
        };
        let mut spots = Vec::new();
        for hall in 0..halls {
            let along_m = (hall as f64 + 0.5) * length_m / halls as f64;
            spots.push(Spot { along_m, across_m: 0.0, door_m: along_m });
            let count = self.count(self.ranges.things_per_hall_viewpoint);
            let sees = (0..count).map(|_| self.thing(&mut building, false, &hours)).collect();
            building.viewpoints.push(Viewpoint { room: None, sees });
        }
        building.dock = self.count([0.0, halls as f64]);
        let mut begin_m = 0.0;
        for pair in widths.chunks(2) {
            for (side, width_m) in pair.iter().enumerate() {
                let width_m = width_m.min(pair[0]);
                let sign = if side == 0 { 1.0 } else { -1.0 };
                self.room(&mut building, &mut spots, &hours, [begin_m, begin_m + width_m], sign);
            }
            begin_m += pair[0];
        }
        building.steps = spots
            .iter()
            .map(|from| spots.iter().map(|to| Building::steps_of(travel_s(from, to) + LOOK_S)).collect())
            .collect();
        building
    }

    fn room(
        &mut self,
        building: &mut Building,
        spots: &mut Vec<Spot>,
        hours: &Hours,
        [begin_m, end_m]: Range,
        side: f64,
    ) {
        let door_m = self.rng.uniform(begin_m..end_m);
        let halls = building.viewpoints.iter().take_while(|viewpoint| viewpoint.room.is_none()).count();
        let distance = |hall: &usize| (spots[*hall].along_m - door_m).abs();
        let threshold = (0..halls).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        let door = self.rng.bernoulli(self.ranges.door_share).then(|| {
            let door = self.habit(ThingKind::Door, hours);
            building.things.push(Thing { kind: ThingKind::Door, habit: door });
            building.things.len() - 1
        });
        building.viewpoints[threshold].sees.extend(door);
        let room = building.rooms.len();
        building.rooms.push(Room { door, threshold });
        let depth_m = self.log_uniform(self.ranges.depth_m);
        let first = building.viewpoints.len();
        let viewpoints = self.count(self.ranges.viewpoints_per_room);
        for _ in 0..viewpoints {
            let along_m = self.rng.uniform(begin_m..end_m);
            spots.push(Spot {
                along_m,
                across_m: side * (1.0 + self.rng.uniform(0.3..1.0) * depth_m),
                door_m,
            });
            building.viewpoints.push(Viewpoint { room: Some(room), sees: door.into_iter().collect() });
        }
        for _ in 0..self.count(self.ranges.things_per_room) {
            let thing = self.thing(building, true, hours);
            let main = first + self.count([0.0, viewpoints as f64]);
            for at in first..first + viewpoints {
                if at == main || self.rng.bernoulli(SEEN_ALSO) {
                    building.viewpoints[at].sees.push(thing);
                }
            }
        }
    }

    /// Adds a thing that is not a door.
    fn thing(&mut self, building: &mut Building, is_in_room: bool, hours: &Hours) -> usize {
        let kinds = [ThingKind::Person, ThingKind::Box, ThingKind::ParkedRobot];
        let kind = kinds[self.count(if is_in_room { [0.0, 3.0] } else { [1.0, 3.0] })];
        let habit = self.habit(kind, hours);
        building.things.push(Thing { kind, habit });
        building.things.len() - 1
    }

    fn habit(&mut self, thing: ThingKind, hours: &Hours) -> Habit {
        self.kind.draw_habit(thing, hours, &mut self.rng)
    }
}

/// The time to go from one place to another, s: within a side of the hall straight, otherwise through the doors.
fn travel_s(from: &Spot, to: &Spot) -> f64 {
    let is_same_room = from.door_m == to.door_m && from.across_m * to.across_m > 0.0;
    let way_m = if is_same_room {
        (from.along_m - to.along_m).abs() + (from.across_m - to.across_m).abs()
    } else {
        let to_door = |spot: &Spot| spot.across_m.abs() + (spot.along_m - spot.door_m).abs();
        to_door(from) + (from.door_m - to.door_m).abs() + to_door(to)
    };
    way_m / SPEED_MPS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buildings_are_whole() {
        for (_, kind) in Kind::ALL {
            for seed in 0..50 {
                let building = Building::generate(kind, seed);
                assert_eq!(building, Building::generate(kind, seed));
                let things = building.things.len();
                assert!((5..128).contains(&things), "{kind:?} {seed}: {things} things");
                let is_seen =
                    |thing| building.viewpoints.iter().any(|viewpoint| viewpoint.sees.contains(&thing));
                assert!((0..things).all(is_seen));
                assert!(building.viewpoints[building.dock].room.is_none());
                for room in &building.rooms {
                    let threshold = &building.viewpoints[room.threshold];
                    assert!(
                        threshold.room.is_none()
                            && room.door.is_none_or(|door| threshold.sees.contains(&door))
                    );
                }
                // Times are symmetric, and obey the triangle inequality up to the rounding and the look at the stop.
                let all = 0..building.viewpoints.len();
                for (from, to) in all.clone().flat_map(|from| all.clone().map(move |to| (from, to))) {
                    let steps = &building.steps;
                    assert_eq!(steps[from][to], steps[to][from]);
                    assert!(all.clone().all(|by| steps[from][to] <= steps[from][by] + steps[by][to] + 1));
                }
            }
        }
    }
}
