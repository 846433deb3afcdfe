//! One model of change: a thing is there or away, as a two-state chain in continuous time whose rates are unknown.
//!
//! [`Evidence`] is what the looks at a thing say, in view and over gaps; the [`Population`] is what the other things of the map
//! and shipped knowledge say; both give a [`Posterior`] over a fixed grid of chains: mean stay away × mean stay there. From it follows
//! how long a state still lasts, and whether waiting for its end is worth it: [`Waiting`].

mod evidence;
mod kernel;
mod population;
mod posterior;
#[cfg(test)]
mod tests;
mod waiting;

pub use evidence::Evidence;
pub use population::Population;
pub(crate) use posterior::Fading;
pub use posterior::Posterior;
pub use waiting::Waiting;

/// The number of mean stays along both axes of the grid, the shortest one, s, and the ratio of one to the next: 3 s to 3 weeks.
/// A ratio above 1.5 would show in the error of rates.
const STAYS: usize = 34;
const SHORTEST_S: f64 = 3.0;
const RATIO: f64 = 1.5;

/// A number for each chain of the grid, by the mean stay away, then by the mean stay there.
type Chains = Vec<f64>;

/// The rates at which chains leave a state, per second: the reciprocal mean stays.
fn leaving_rates() -> [f64; STAYS] {
    std::array::from_fn(|stay| libm::pow(RATIO, -(stay as f64)) / SHORTEST_S)
}

/// All chains of the grid, in order: the rate of coming, and the rate of going.
fn chains() -> impl Iterator<Item = [f64; 2]> {
    let rates = leaving_rates();
    rates.into_iter().flat_map(move |come| rates.into_iter().map(move |go| [come, go]))
}
