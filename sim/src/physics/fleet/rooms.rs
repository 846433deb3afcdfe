//! Rooms that are not closed while a robot is in them.

use crate::flood::flood;
use crate::physics::ground_truth::start::walls_cover;
use crate::physics::robot::SimulatedRobot;
use crate::physics::shape::Rectangle;
use crate::physics::spec::FleetSpec;
use interfaces::{Cell, GridFrame, TrueState};
use std::mem::replace;

/// What lies behind the doors that wait for robots: the cells that a closed door alone cuts off from the dock of a robot.
pub(super) struct Rooms {
    frame: GridFrame,
    /// For each obstacle: the robots that it waits for, each with the cells behind the door.
    behind: Vec<Vec<(usize, Vec<bool>)>>,
}

impl Rooms {
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let doors =
            spec.obstacles.iter().map(|obstacle| obstacle.waits_for_robots().then_some(obstacle.shape));
        let docks: Vec<(usize, Cell)> =
            spec.docks().map(|(robot, at)| (robot, spec.frame.cell_at(&at))).collect();
        let behind = doors.map(|leaf| {
            let robots = leaf.iter().flat_map(|leaf| docks.iter().map(move |dock| (leaf, dock)));
            robots.map(|(leaf, (robot, dock))| (*robot, cut_off(spec, *dock, leaf))).collect()
        });
        Self { frame: spec.frame, behind: behind.collect() }
    }

    /// Whether a robot is behind an obstacle that waits for it.
    pub(super) fn is_occupied(&self, obstacle: usize, robots: &[SimulatedRobot]) -> bool {
        self.behind[obstacle].iter().any(|(robot, behind)| {
            let cell = self.frame.index(self.frame.cell_at(&robots[*robot].at()));
            cell.is_some_and(|cell| behind[cell])
        })
    }
}

/// The cells that are connected with the dock while a door is open, and not while it is closed; all others are open.
fn cut_off(spec: &FleetSpec, dock: Cell, leaf: &Rectangle) -> Vec<bool> {
    let connected = |boxes: &[Rectangle]| {
        let states = walls_cover(&spec.frame, boxes);
        let mut reached = vec![false; spec.frame.len()];
        flood(&spec.frame, dock, |cell| {
            states[cell] == TrueState::Free && !replace(&mut reached[cell], true)
        });
        reached
    };
    let mut boxes = spec.walls.clone();
    let open = connected(&boxes);
    boxes.push(*leaf);
    let closed = connected(&boxes);
    open.iter().zip(closed).map(|(open, closed)| *open && !closed).collect()
}
