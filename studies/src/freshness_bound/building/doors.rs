use super::access::Access;
use super::cells::Cells;
use crate::calendar::Timeline;
use crate::{Building, Model};
use interfaces::{Purpose, RandomStream};

/// What all doors did in a week of a seed: a robot that knew it beforehand would be at least as good.
pub(super) struct Doors {
    /// For each door, whether it was closed at each step; empty for other things.
    pub(super) is_closed: Vec<Vec<bool>>,
}

impl Doors {
    pub(super) fn new(building: &Building, seed: u64, steps: usize) -> Self {
        let is_door = |thing: usize| building.rooms.iter().any(|room| room.door == Some(thing));
        let states = building.things.iter().enumerate().map(|(index, thing)| {
            if !is_door(index) {
                return Vec::new();
            }
            // As in `Patrol`: what things do depends on the seed alone.
            let rng = RandomStream::new(seed, Purpose::Thing(index));
            let start = *Model::of(&thing.habit).start();
            let mut timeline = Timeline::of_habit(&thing.habit, &start, 0.0, rng);
            let state = |step: usize| {
                timeline.advance(step as f64 * crate::STEP_S, |_, _| ());
                timeline.is_blocked()
            };
            (0..steps).map(state).collect()
        });
        Self { is_closed: states.collect() }
    }

    /// In which cells a thing can be seen by a robot that comes in.
    pub(super) fn access(&self, building: &Building, cells: &Cells, thing: usize) -> Access {
        Access::of(match only_door(building, thing) {
            None => vec![true; cells.count()],
            Some((room, door)) => open_cells(building, &self.is_closed[door], cells, room),
        })
    }
}

/// The room, and its door, that a thing can only be seen in.
fn only_door(building: &Building, thing: usize) -> Option<(usize, usize)> {
    let mut rooms = building
        .viewpoints
        .iter()
        .filter(|viewpoint| viewpoint.sees.contains(&thing))
        .map(|viewpoint| viewpoint.room);
    let room = rooms.next()??;
    rooms.all(|other| other == Some(room)).then_some((room, building.rooms[room].door?))
}

/// A robot can come in during a cell if the door was open at some time at which it can have departed.
fn open_cells(building: &Building, is_closed: &[bool], cells: &Cells, room: usize) -> Vec<bool> {
    let viewpoints = 0..building.viewpoints.len();
    let (inside, outside): (Vec<usize>, Vec<usize>) =
        viewpoints.partition(|viewpoint| building.viewpoints[*viewpoint].room == Some(room));
    let ways = outside.iter().flat_map(|from| inside.iter().map(|to| building.steps[*from][*to]));
    let (shortest, longest) =
        ways.fold((usize::MAX, 0), |(low, high), steps| (low.min(steps), high.max(steps)));
    let is_open = |cell: usize| {
        let [first, end] =
            [cells.begins[cell].saturating_sub(longest), cells.begins[cell + 1].saturating_sub(shortest)];
        is_closed[first.min(end)..end].iter().any(|is_closed| !is_closed)
    };
    (0..cells.count()).map(is_open).collect()
}
