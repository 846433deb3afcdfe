//! x
mod costmap;
#[cfg(test)]
mod drawing;
mod wavefront;
pub use costmap::{CLOSED, Costmap, DIAGONAL, MAX_PRICE, Moves, OPEN, STRAIGHT};
pub use wavefront::Wavefront;
