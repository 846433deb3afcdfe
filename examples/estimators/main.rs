//! The accuracy of the rate estimators, all on the same streams of observations: in block worlds, and on simulated
//! two-state chains. Writes `docs/estimators/tables.md` and
//! `docs/estimators/chains.svg`; remove those of git first, which no run has written.
//!
//! ```text
//! cargo run --release --example estimators              60 block worlds of 20,000 steps
//! cargo run --release --example estimators -- 24 5000   fewer of them, shorter
//! ```

mod blocks;
mod chains;
mod curves;
mod information;
mod patterns;
mod robots;
mod room;
mod score;
mod tables;

use files::write_file;
use interfaces::SettingsError;
use mapper::{EstimatorChoice, Mapper, MapperSettings};

const TABLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/estimators/tables.md");
const CURVES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/estimators/chains.svg");

/// One mapper per estimator, in the order of [`EstimatorChoice::all`].
fn mappers(frame: interfaces::GridFrame) -> Result<Vec<Mapper>, SettingsError> {
    let mapper = |estimator| Mapper::new(&MapperSettings { estimator, ..MapperSettings::default() }, frame);
    EstimatorChoice::all().into_iter().map(mapper).collect()
}

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let worlds = arguments.next().unwrap_or(Ok(60))?;
    let steps = arguments.next().unwrap_or(Ok(20_000))?;
    let mut text = format!(
        "# Estimators: the tables\n\nMade by `cargo run --release --example estimators -- {worlds} \
         {steps}`; what they mean is in [`estimators.md`](../estimators.md).\n"
    );
    for set in blocks::Set::ALL {
        text += &tables::blocks(set, &blocks::judge(set, worlds, steps)?);
    }
    text += &tables::room(&room::judge()?);
    let outcomes = chains::all(steps)?;
    text += &tables::chains(&outcomes);
    text += &tables::unlike_neighbours(&chains::unlike_neighbours(steps)?);
    write_file(TABLES.as_ref(), |file| file.write_all(text.as_bytes()))?;
    let curves = curves::draw(&outcomes)?;
    write_file(CURVES.as_ref(), |file| file.write_all(curves.as_bytes()))?;
    Ok(())
}
