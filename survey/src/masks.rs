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
/// A cell that changes is kept out of if it is blocked with at least this probability.
const PROBABLY: f64 = 0.5;
/// The names of the masks, in the order of [`masks`] and of [`Forecast::masks`](crate::Forecast::masks).
pub const MASKS: [&str; 2] = ["speed_mask", "keepout_mask"];
/// The value of a cell that must not be entered.
const KEEP_OUT: u8 = 100;

/// The speed mask: 80 · (1 − e^(−pace · rate · 600 s)), the largest value within 0.5 m; 0 where nothing changes. The pace of a cell
/// is its rate at a time of the week, divided by its mean rate.
pub(crate) fn speed_mask(mapper: &Mapper, pace: impl Fn(usize) -> f64) -> Grid<u8> {
    let frame = *mapper.frame();
    let mut mask = Grid::filled(frame, 0);
    let reach = (DISTANCE_M / frame.resolution_m()).round() as i32;
    for index in mapper.changed() {
        let change = mapper.change_probability_within(index, CHANGE_HORIZON_S * pace(index));
        let value = (SLOWEST * change).round() as u8;
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

/// The keepout mask: 100 for a cell that changes and is probably blocked, by its index, otherwise 0. Cells that never change are
/// in the static map.
pub(crate) fn keepout_mask(mapper: &Mapper, blocked: impl Fn(usize) -> f64) -> Grid<u8> {
    let mut mask = Grid::filled(*mapper.frame(), 0);
    for index in mapper.changed().filter(|index| blocked(*index) >= PROBABLY) {
        mask.cells_mut()[index] = KEEP_OUT;
    }
    mask
}

/// The speed mask and the keepout mask for any time: with mean rates, and the share of the time that a cell is blocked.
pub fn masks(mapper: &Mapper) -> [Grid<u8>; 2] {
    [speed_mask(mapper, |_| 1.0), keepout_mask(mapper, |index| share_blocked(mapper, index))]
}
