//! Trials in grid worlds.

use curious::trials::{GridWorlds, main as trials};
use std::process::ExitCode;

fn main() -> ExitCode {
    trials::<GridWorlds>()
}
