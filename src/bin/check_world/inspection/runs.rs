//! Which program runs a file, or why none does. The programs' own code decides.

use agent::Policy;
use curious::worlds::{self, LoadError};
use evaluation::physics_trial;
use interfaces::printable;

/// The command that runs a physics world or a Stage world.
pub(super) fn in_four_rooms(name: &str) -> String {
    command("four_rooms", name, explores(name))
}

/// The command that runs a grid world.
pub(super) fn in_grid_world(name: &str) -> String {
    command("grid_world", name, worlds::load_grid(name).map(drop))
}

/// Whether a robot can explore the world.
fn explores(name: &str) -> anyhow::Result<()> {
    let settings = physics_trial::settings(&worlds::load(name)?.spec)?;
    settings.pilot(settings.agent(&Policy::default(), 0)?, 0)?;
    Ok(())
}

fn command(program: &str, name: &str, result: anyhow::Result<()>) -> String {
    match result {
        Ok(()) => format!("{program} --world {}", printable(name)),
        Err(error) => format!("not in {program}: {}", reason(&error)),
    }
}

/// The error in one line.
fn reason(error: &anyhow::Error) -> String {
    match error.downcast_ref() {
        Some(LoadError::World(error)) => error
            .findings()
            .iter()
            .next()
            .map_or(String::new(), |first| format!("{} ({})", first.what, first.help)),
        _ => error.to_string().lines().next().unwrap_or_default().to_owned(),
    }
}
