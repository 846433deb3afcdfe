//! `layers.npy`: all that was learned about the cells, as one array of numbers for `numpy.load`.

use crate::output::{OutputError, write_file};
use mapper::Mapper;
use npyz::WriterBuilder;
use std::path::Path;

/// The probability with which the credible interval contains the rate.
const CREDIBLE_MASS: f64 = 0.9;

/// The names of the layers, in the order of the array.
pub const LAYERS: [&str; 8] = [
    "blocked",
    "rate_hz",
    "rate_low_hz",
    "rate_high_hz",
    "blocked_probability",
    "change_probability",
    "recency_s",
    "observed_s",
];

/// Writes an array of 32-bit numbers with the shape (layers, rows, columns); row 0 has the lowest y. The layers are
/// [`LAYERS`]: the map (0 free, 1 blocked), the rate and its 90 % credible interval in cycles per second, the probability
/// of being blocked now, the probability of a change since last seen, the time since last seen and the time in view, s.
/// Cells that were never seen are NaN in all layers.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, mapper: &Mapper) -> Result<(), OutputError> {
    let frame = mapper.frame();
    let shape = [LAYERS.len(), frame.height(), frame.width()].map(|length| length as u64);
    let interval = mapper.credible_intervals(CREDIBLE_MASS);
    let blocked =
        |index: usize| f64::from(u8::from(mapper.states().cells()[index] == interfaces::CellState::Blocked));
    let layer = |layer: usize, index: usize| match layer {
        0 => blocked(index),
        1 => mapper.rate(index),
        2 => interval(index).0,
        3 => interval(index).1,
        4 => mapper.blocked_probability(index),
        5 => mapper.change_probability(index),
        6 => mapper.recency(index),
        _ => mapper.statistics(index).observed(),
    };
    write_file(path, |file| {
        let mut array =
            npyz::WriteOptions::<f32>::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
        for number in 0..LAYERS.len() {
            for index in 0..frame.len() {
                let value = if mapper.was_ever_seen(index) { layer(number, index) } else { f64::NAN };
                array.push(&(value as f32))?;
            }
        }
        array.finish()
    })
}
