//! How right the estimators of rates are, all on the same streams of observations: in block worlds, and on
//! simulated two-state chains. Prints the tables of `docs/estimators.md` and draws `docs/estimators.svg`.
//!
//! ```text
//! cargo run --release -p mapper --example estimators              60 block worlds of 20,000 steps
//! cargo run --release -p mapper --example estimators -- 24 5000   fewer of them, shorter
//! ```

mod blocks;
mod chains;
mod curves;
mod information;
mod patterns;
mod robots;
mod score;

use mapper::{Estimator, Mapper, MapperSettings, SettingsError};

/// One mapper per estimator, in the order of [`Estimator::ALL`].
fn mappers(frame: geometry::GridFrame) -> Result<Vec<Mapper>, SettingsError> {
    let mapper = |estimator| Mapper::new(&MapperSettings { estimator, ..MapperSettings::default() }, frame);
    Estimator::ALL.map(mapper).into_iter().collect()
}

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let worlds = arguments.next().unwrap_or(Ok(60))?;
    let steps = arguments.next().unwrap_or(Ok(20_000))?;
    blocks::table(worlds, steps)?;
    if std::env::var("NC").is_ok() { return Ok(()); }
    let outcomes = chains::all(steps)?;
    chains::tables(&outcomes);
    chains::unlike_neighbours(steps)?;
    curves::draw(&outcomes, concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/estimators.svg"))
}
