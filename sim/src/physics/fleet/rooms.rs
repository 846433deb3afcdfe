//! Rooms that are not closed while a robot must get out of them, or into them.

use crate::flood::flood;
use crate::physics::ground_truth::cover::box_cells;
use crate::physics::ground_truth::start::walls_cover;
use crate::physics::robot::SimulatedRobot;
use crate::physics::shape::Rectangle;
use crate::physics::spec::FleetSpec;
use interfaces::{GridFrame, TrueState};
use nalgebra::Point2;

/// How far beside a closed leaf a free cell is looked for, m.
const BESIDE_M: f64 = 0.5;

/// The rooms between the doors that wait for robots, and the doors on the way from each room to the dock of each robot.
pub(super) struct Rooms {
    frame: GridFrame,
    /// The room of each cell while all of these doors are closed; a doorway belongs to the room farther from the docks.
    rooms: Vec<Option<usize>>,
    /// For each robot with a dock: the doors on the way with the fewest doors, by room.
    ways: Vec<(usize, Vec<Vec<usize>>)>,
}

/// A door between two rooms.
struct Passage {
    obstacle: usize,
    rooms: [usize; 2],
}

impl Rooms {
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let frame = spec.frame;
        let waiting = spec.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.waits_for_robots());
        let leaves: Vec<(usize, Rectangle)> = waiting.map(|(index, door)| (index, door.shape)).collect();
        if leaves.is_empty() {
            return Self { frame, rooms: Vec::new(), ways: Vec::new() };
        }
        let (mut rooms, count) = separate(spec, &leaves);
        let room_at = |rooms: &[Option<usize>], at: &Point2<f64>| {
            frame.index(frame.cell_at(at)).and_then(|cell| rooms[cell])
        };
        let passages = leaves.iter().filter_map(|(obstacle, leaf)| {
            let beside = |side: f64| {
                let steps = (0..).map(|step| leaf.half_m.y + f64::from(step) * frame.resolution_m());
                let mut near = steps.take_while(|from_m| *from_m <= leaf.half_m.y + BESIDE_M);
                near.find_map(|from_m| room_at(&rooms, &(leaf.pose * Point2::new(0.0, side * from_m))))
            };
            Some(Passage { obstacle: *obstacle, rooms: [beside(-1.0)?, beside(1.0)?] })
        });
        let passages: Vec<Passage> = passages.collect();
        let ways = spec
            .docks()
            .filter_map(|(robot, dock)| Some((robot, ways_to(room_at(&rooms, &dock)?, count, &passages))));
        let ways: Vec<(usize, Vec<Vec<usize>>)> = ways.collect();
        for passage in &passages {
            let doors = |room: &usize| ways.iter().map(|(_, ways)| ways[*room].len()).sum::<usize>();
            let far = passage.rooms.into_iter().max_by_key(doors);
            box_cells(&frame, &spec.obstacles[passage.obstacle].shape, |cell, _| {
                rooms[cell] = rooms[cell].or(far);
            });
        }
        Self { frame, rooms, ways }
    }

    /// Whether a robot is where it needs this door to get to its dock.
    pub(super) fn is_needed(&self, obstacle: usize, robots: &[SimulatedRobot]) -> bool {
        self.ways.iter().any(|(robot, ways)| {
            let cell = self.frame.index(self.frame.cell_at(&robots[*robot].at()));
            let room = cell.and_then(|cell| self.rooms[cell]);
            room.is_some_and(|room| ways[room].contains(&obstacle))
        })
    }
}

/// The room of each free cell, and the number of rooms: what is connected while all leaves are closed, and all other obstacles away.
fn separate(spec: &FleetSpec, leaves: &[(usize, Rectangle)]) -> (Vec<Option<usize>>, usize) {
    let boxes: Vec<Rectangle> = spec.walls.iter().chain(leaves.iter().map(|leaf| &leaf.1)).copied().collect();
    let states = walls_cover(&spec.frame, &boxes);
    let (mut rooms, mut count) = (vec![None; spec.frame.len()], 0);
    for start in 0..spec.frame.len() {
        let entered = flood(&spec.frame, spec.frame.cell(start), |cell| {
            let is_new = states[cell] == TrueState::Free && rooms[cell].is_none();
            if is_new {
                rooms[cell] = Some(count);
            }
            is_new
        });
        count += usize::from(entered > 0);
    }
    (rooms, count)
}

/// For each room, the doors on the way to a room with the fewest doors.
fn ways_to(dock: usize, count: usize, passages: &[Passage]) -> Vec<Vec<usize>> {
    let mut ways: Vec<Option<Vec<usize>>> = vec![None; count];
    ways[dock] = Some(Vec::new());
    let mut reached = vec![dock];
    let mut next = 0;
    while let Some(room) = reached.get(next).copied() {
        next += 1;
        for Passage { obstacle, rooms: [one, other] } in passages {
            for (from, to) in [(*one, *other), (*other, *one)] {
                if from == room && ways[to].is_none() {
                    let mut way = ways[room].clone().unwrap_or_default();
                    way.push(*obstacle);
                    ways[to] = Some(way);
                    reached.push(to);
                }
            }
        }
    }
    ways.into_iter().map(Option::unwrap_or_default).collect()
}
