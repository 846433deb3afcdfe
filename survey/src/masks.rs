//! Masks for the costmap filters of Nav2, values from 0 to 100.

use crate::permanent::share_blocked;
use interfaces::{Cell, Grid};
use mapper::Mapper;

/// The value where a cell changes all the time. The speed filter takes the mask value v as a limit of 100 − v percent
/// of the full speed, and a limit of 0 % as no limit: the value stays below 100.
const SLOWEST: f64 = 80.0;
/// The time in which a change matters to a robot on its route, s: maps of changes show the probability of a change
/// [within](Mapper::change_probability_within) this time. It is 0.63 where a cycle takes this long on average.
pub const CHANGE_HORIZON_S: f64 = 600.0;
/// The robot slows down at this distance from what changes, m.
const DISTANCE_M: f64 = 0.5;
/// A cell that changes is kept out of if it is blocked for at least this share of the time.
const USUALLY: f64 = 0.5;
/// The value of a cell that must not be entered.
const KEEP_OUT: u8 = 100;

/// The speed mask: 80 · (1 − e^(−rate · 600 s)), the largest value within 0.5 m; 0 where nothing changes.
pub fn speed_mask(mapper: &Mapper) -> Grid<u8> {
    let frame = *mapper.frame();
    let mut mask = Grid::filled(frame, 0);
    let reach = (DISTANCE_M / frame.resolution_m()).round() as i32;
    for index in mapper.changed() {
        let value = (SLOWEST * mapper.change_probability_within(index, CHANGE_HORIZON_S)).round() as u8;
        let center = frame.cell(index);
        for y in -reach..=reach {
            for x in (-reach..=reach).filter(|x| x * x + y * y <= reach * reach) {
                if let Some(near) = mask.get_mut(Cell { x: center.x + x, y: center.y + y }) {
                    *near = value.max(*near);
                }
            }
        }
    }
    mask
}

/// The keepout mask: 100 for a cell that changes and is usually blocked, otherwise 0. Cells that never change are in the
/// static map.
pub fn keepout_mask(mapper: &Mapper) -> Grid<u8> {
    let mut mask = Grid::filled(*mapper.frame(), 0);
    for index in mapper.changed().filter(|index| share_blocked(mapper, *index) >= USUALLY) {
        mask.cells_mut()[index] = KEEP_OUT;
    }
    mask
}
