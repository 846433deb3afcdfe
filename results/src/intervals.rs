//! How certain the rates of the cells are.

use mapper::Mapper;

/// The probability with which an interval contains the rate.
const CREDIBLE_MASS: f64 = 0.9;

/// The 90 % credible interval of the rate of every cell that was seen, in cycles per second. To compute them takes most of the time
/// of the files that have them.
#[derive(Clone, Debug)]
pub struct Intervals(Vec<(f64, f64)>);

impl Intervals {
    /// The intervals of a map.
    pub fn of(mapper: &Mapper) -> Self {
        Self(mapper.seen().map(|index| mapper.credible_interval(index, CREDIBLE_MASS)).collect())
    }

    /// The cells that were seen, by ascending index, with their intervals. The map is that of [`Intervals::of`].
    pub(crate) fn of_cells(&self, mapper: &Mapper) -> impl Iterator<Item = (usize, (f64, f64))> {
        mapper.seen().zip(self.0.iter().copied())
    }

    /// The number of cells that were seen.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }
}
