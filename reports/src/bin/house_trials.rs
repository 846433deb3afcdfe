//! Trials in houses and other physics worlds.

use reports::trials::{Houses, main as trials};
use std::process::ExitCode;

fn main() -> ExitCode {
    trials::<Houses>()
}
