use crate::situation::Situation;
use interfaces::CellState;
use std::collections::VecDeque;

/// The additional time to pass a cell that was blocked when last seen, and may still be blocked.
const MAY_BE_CLOSED: f64 = 10.0;

/// The travel time from the robot to each cell, also past obstacles that may have moved away; ∞ where no path is known.
///
/// The planner knows no path past an obstacle that stood in a door when it was last seen, and a robot that never
/// goes there never sees the door open. Paths therefore also lead through cells that changed, are blocked in the
/// map and are out of view; from there on they go from cell to cell, at one meter per unit of time.
pub(crate) fn travel_past_obstacles(situation: &Situation) -> Vec<f64> {
    let (mapper, frame) = (situation.mapper, situation.mapper.frame());
    let states = mapper.states().cells();
    let mut times: Vec<f64> = (0..frame.len()).map(|cell| situation.travel_to(cell)).collect();
    let mut is_passable: Vec<bool> = states.iter().map(|state| *state == CellState::Free).collect();
    let mut open = VecDeque::new();
    let may_be_gone = |&cell: &usize| states[cell] == CellState::Blocked && !mapper.is_in_view(cell);
    for cell in mapper.changed().filter(may_be_gone) {
        is_passable[cell] = true;
        if times[cell] == f64::INFINITY {
            open.extend(frame.beside(cell).filter(|&near| times[near] < f64::INFINITY));
        }
    }
    while let Some(cell) = open.pop_front() {
        for near in frame.beside(cell) {
            if is_passable[near] && times[near] == f64::INFINITY {
                let closed = if states[near] == CellState::Blocked { MAY_BE_CLOSED } else { 0.0 };
                times[near] = times[cell] + frame.resolution_m() + closed;
                open.push_back(near);
            }
        }
    }
    times
}
