use crate::Cell;

/// What is known of how long obstacles stay where they are.
pub trait Obstacles: std::fmt::Debug {
    /// The blocked cells of obstacles that come and go.
    fn cells(&self) -> Vec<Cell>;

    /// How long to wait for the obstacle in one of these cells to go before the robot takes the way round, which takes this much longer,
    /// s (steps in a grid world); infinite if waiting is better at any time.
    fn patience(&self, cell: Cell, detour: f64) -> f64;
}
