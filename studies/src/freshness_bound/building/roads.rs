use super::plan::Prices;
use crate::Building;

/// A way from a viewpoint, and what is seen by it.
pub(super) struct Road {
    pub(super) to: usize,
    pub(super) steps: usize,
    /// A door that must be open. Whether the robot gets through shows its state at the departure: that counts as a look.
    pub(super) door: Option<usize>,
    /// Whether the robot finds it closed.
    pub(super) is_closed: bool,
    /// Whether the robot stays in a room.
    pub(super) is_inside: bool,
    /// Whether this door is seen from the viewpoint of the departure.
    pub(super) door_is_seen_before: bool,
    /// Whether this door is seen at the arrival.
    pub(super) door_is_seen_after: bool,
    /// What else is seen at the arrival: what is not seen from the viewpoint of the departure, and what is.
    pub(super) new: Vec<usize>,
    pub(super) shared: Vec<usize>,
}

/// All ways of a building; from the dock also those of a robot that has rested.
pub(super) struct Roads {
    pub(super) dock: usize,
    pub(super) from: Vec<Vec<Road>>,
}

/// The prices along a road, in quiet and in active hours.
#[derive(Clone, Copy)]
pub(super) struct Toll {
    pub(super) to: usize,
    pub(super) steps: usize,
    pub(super) door_thing: Option<usize>,
    pub(super) is_closed: bool,
    pub(super) is_inside: bool,
    pub(super) departure: Prices,
    /// 1: the door is looked at anew. 0: it was, at the arrival before.
    pub(super) is_door_new: bool,
    pub(super) door: Prices,
    pub(super) new: Prices,
    pub(super) shared: Prices,
}

impl Roads {
    pub(super) fn new(building: &Building) -> Self {
        let viewpoints = 0..building.viewpoints.len();
        let from = viewpoints.clone().map(|from| {
            let mut roads: Vec<Road> = viewpoints
                .clone()
                .map(|to| road(building, from, to, building.door_between(from, to), false))
                .collect();
            for room in &building.rooms {
                let leads_there = |to: &usize| {
                    building.viewpoints[*to].room.is_some_and(|other| building.rooms[other] == *room)
                        && building.door_between(from, *to).is_some()
                };
                // The door is closed.
                if viewpoints.clone().any(|to| leads_there(&to)) {
                    roads.push(road(building, from, room.threshold, room.door, true));
                }
            }
            roads
        });
        Self { dock: building.dock, from: from.collect() }
    }

    /// The prices along all ways from each viewpoint.
    pub(super) fn tolls(&self, prices: &[Prices]) -> Vec<Vec<Toll>> {
        self.from.iter().map(|roads| roads.iter().map(|road| road.toll(prices)).collect()).collect()
    }
}

fn road(building: &Building, from: usize, to: usize, door: Option<usize>, is_closed: bool) -> Road {
    let [before, after] = [from, to].map(|viewpoint| sees(building, viewpoint));
    let others = after.iter().copied().filter(|thing| Some(*thing) != door);
    let (shared, new) = others.partition(|thing| before.contains(thing));
    let room = building.viewpoints[to].room;
    Road {
        to,
        steps: building.steps[from][to],
        door,
        is_closed,
        is_inside: room.is_some() && building.viewpoints[from].room == room,
        door_is_seen_before: door.is_some_and(|door| before.contains(&door)),
        door_is_seen_after: door.is_some_and(|door| after.contains(&door)),
        new,
        shared,
    }
}

/// The things that the bound lets a robot see from a viewpoint: in a room, those of all its viewpoints.
fn sees(building: &Building, viewpoint: usize) -> Vec<usize> {
    let room = building.viewpoints[viewpoint].room;
    let has_door = room.is_some_and(|room| building.rooms[room].door.is_some());
    let same = |other: &usize| *other == viewpoint || (has_door && building.viewpoints[*other].room == room);
    let viewpoints = (0..building.viewpoints.len()).filter(same);
    let mut things: Vec<usize> =
        viewpoints.flat_map(|other| building.viewpoints[other].sees.clone()).collect();
    things.sort_unstable();
    things.dedup();
    things
}

impl Road {
    fn toll(&self, prices: &[Prices]) -> Toll {
        let sum =
            |things: &[usize]| [0, 1].map(|class| things.iter().map(|thing| prices[*thing][class]).sum());
        let door = self.door.map_or([0.0; 2], |door| prices[door]);
        Toll {
            to: self.to,
            steps: self.steps,
            door_thing: self.door,
            is_closed: self.is_closed,
            is_inside: self.is_inside,
            departure: door,
            is_door_new: !self.door_is_seen_before,
            door: if self.door_is_seen_after { door } else { [0.0; 2] },
            new: sum(&self.new),
            shared: sum(&self.shared),
        }
    }
}
