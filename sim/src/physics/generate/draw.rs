//! Random values of the ranges of a house.

use interfaces::RandomStream;
use rand::RngExt;

/// The number of cells in a meter.
pub(super) const CELLS_PER_M: f64 = 20.0;

/// A length in cells.
pub(super) fn cells(length_m: f64) -> i32 {
    (length_m * CELLS_PER_M).round() as i32
}

/// A random length in cells.
pub(super) fn between([low_m, high_m]: [f64; 2], rng: &mut RandomStream) -> i32 {
    rng.random_range(cells(low_m)..=cells(high_m))
}

/// A random whole number.
pub(super) fn integer([low, high]: [i32; 2], rng: &mut RandomStream) -> i32 {
    rng.random_range(low..=high)
}

/// A random value in steps of a hundredth, so that a world file has short numbers.
pub(super) fn value([low, high]: [f64; 2], rng: &mut RandomStream) -> f64 {
    (rng.uniform(low..high) * 100.0).round() / 100.0
}

/// A random time in steps of a tenth of a second; all orders of magnitude are equally likely.
pub(super) fn time_s([low_s, high_s]: [f64; 2], rng: &mut RandomStream) -> f64 {
    let log = rng.uniform(libm::log(low_s)..libm::log(high_s));
    (libm::exp(log) * 10.0).round() / 10.0
}
