//! Trials in grid worlds.

use reports::trials::{GridWorlds, main as trials};
use std::process::ExitCode;

fn main() -> ExitCode {
    trials::<GridWorlds>()
}
