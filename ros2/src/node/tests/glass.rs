//! Beams without a return: the node clears nothing by them before it has learned that it can.

use super::*;
use mapper::NoReturn;

/// The time after which the node can trust a scanner at the earliest, s.
const LEARNS_S: f64 = 30.0;

/// A robot that drives rounds in a hall of 24 × 6 m. The laser reaches 8 m.
fn hall(no_return: NoReturn) -> Pair {
    let world = worldfile::physics::parse_world("hall.toml", include_str!("hall.toml")).unwrap();
    // The ends of the hall are out of range at times: its odometry knows where the robot is.
    Pair::in_world(&world, &Parameters { no_return, pose: PoseMode::Exact, ..parameters(Mode::Map) }, 0, None)
}

impl Pair {
    /// Drives on the circle until this time, and returns the number of free cells.
    fn free_at(&mut self, end_s: f64) -> usize {
        while self.sim.time_s() < end_s {
            self.drive(0.4, 0.2);
            self.run(0.2);
        }
        let states = self.node.robot.mapper.states().cells();
        states.iter().filter(|state| **state == CellState::Free).count()
    }
}

#[test]
fn a_scanner_is_trusted_once_the_node_has_learned() {
    let [mut learned, mut free, mut ignored] = [NoReturn::Learn, NoReturn::Free, NoReturn::Ignore].map(hall);
    let [early, all, none] = [&mut learned, &mut free, &mut ignored].map(|pair| pair.free_at(LEARNS_S - 1.0));
    assert!(early == none && none + 1000 < all, "{early} {none} {all}");
    assert!(!learned.is_said("count as free"));
    let [late, all, none] = [&mut learned, &mut free, &mut ignored].map(|pair| pair.free_at(2.5 * LEARNS_S));
    assert!(none + 1000 < late && late * 100 > all * 98, "{late} {none} {all}");
    assert!(learned.is_said("beams without a return count as free from now on"));
}
