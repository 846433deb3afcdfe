//! How right the estimators of rates are, all on the same streams of observations: block worlds, then
//! simulated two-state chains.
//!
//! ```text
//! cargo run --release -p mapper --example estimators              24 block worlds of 20,000 steps
//! cargo run --release -p mapper --example estimators -- 48 5000   more of them, shorter
//! ```

mod blocks;
mod chains;
mod information;
mod robots;
mod score;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let worlds = arguments.next().unwrap_or(Ok(24))?;
    let steps = arguments.next().unwrap_or(Ok(20_000))?;
    blocks::table(worlds, steps)?;
    chains::table(worlds as usize, steps)
}
