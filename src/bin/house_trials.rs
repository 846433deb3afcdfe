//! Trials in houses and other physics worlds.

use curious::trials::{Houses, main as trials};
use std::process::ExitCode;

fn main() -> ExitCode {
    trials::<Houses>()
}
