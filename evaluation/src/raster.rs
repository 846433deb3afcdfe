//! `layers.npy`: all that was learned about the cells, as one array of numbers for `numpy.load`.

use crate::output::{OutputError, write_file};
use interfaces::CellState;
use mapper::Mapper;
use npyz::WriterBuilder;
use std::path::Path;

/// The probability with which the credible interval contains the rate.
const CREDIBLE_MASS: f64 = 0.9;

/// The layers, in the order of the array.
pub const LAYERS: [Layer; 8] = [
    layer("blocked", |of, index| {
        f64::from(u8::from(of.mapper.states().cells()[index] == CellState::Blocked))
    }),
    layer("rate_hz", |of, index| of.mapper.rate(index)),
    layer("rate_low_hz", |of, index| (of.interval)(index).0),
    layer("rate_high_hz", |of, index| (of.interval)(index).1),
    layer("blocked_probability", |of, index| of.mapper.blocked_probability(index)),
    layer("change_probability", |of, index| of.mapper.change_probability(index)),
    layer("recency_s", |of, index| of.mapper.recency(index)),
    layer("observed_s", |of, index| of.mapper.statistics(index).observed()),
];

/// One value per cell.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// The name, with the unit.
    pub name: &'static str,
    value: Value,
}

type Value = fn(&Learned, usize) -> f64;

/// What the values of the cells follow from.
struct Learned<'a> {
    mapper: &'a Mapper,
    /// The credible interval of the rate of a cell.
    interval: &'a dyn Fn(usize) -> (f64, f64),
}

const fn layer(name: &'static str, value: Value) -> Layer {
    Layer { name, value }
}

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
    let learned = Learned { mapper, interval: &mapper.credible_intervals(CREDIBLE_MASS) };
    write_file(path, |file| {
        let mut array =
            npyz::WriteOptions::<f32>::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
        for layer in LAYERS {
            for index in 0..frame.len() {
                let value =
                    if mapper.was_ever_seen(index) { (layer.value)(&learned, index) } else { f64::NAN };
                array.push(&(value as f32))?;
            }
        }
        array.finish()
    })
}
