//! The world to run: a shipped world, a world file, or a Stage file.

use anyhow::{anyhow, bail};
use cli::program::list;
use interfaces::printable;
use results::file_name;
use sim::grid::GridSpec;
use sim::physics::WorldSpec;
use std::path::Path;
use worldfile::{Disk, Severity};

pub use worldfile::shipped::{GRID as SHIPPED_GRID, LoadError, PHYSICS as SHIPPED, TOUR};

/// A world to run.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The world.
    pub spec: WorldSpec,
    /// Differences between the world and its file, one message each.
    pub warnings: Vec<String>,
}

/// The world with the name `name`: a shipped world, or otherwise the file with this path, either a world file or a
/// Stage file (`.world`).
///
/// # Errors
///
/// When there is no such world or file, or when it is not a world of this kind.
pub fn load(name: &str) -> anyhow::Result<Loaded> {
    let path = Path::new(name);
    if is_of_stage(path) && path.exists() {
        return load_stage(name);
    }
    Ok(Loaded { spec: worldfile::shipped::load(name)?, warnings: Vec::new() })
}

/// Whether a file is read as a Stage file, by the end of its name.
pub fn is_of_stage(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "world" || ending == "inc")
}

/// The grid world with the name `name`: a shipped world, or otherwise the file with this path.
///
/// # Errors
///
/// When there is no such world or file, when it is not a world of this kind, or when the name of the world cannot be
/// part of the name of a file.
pub fn load_grid(name: &str) -> anyhow::Result<GridSpec> {
    let spec = worldfile::shipped::load_grid(name)?;
    if let Err(why) = file_name::check(&spec.name) {
        let [name, world] = [name, &spec.name].map(printable);
        bail!(
            "the world `{world}` in `{name}` needs another name, since files of results contain it: {why}; `{}` would be valid",
            file_name::of(&spec.name)
        );
    }
    Ok(spec)
}

/// Prints the shipped physics worlds.
///
/// # Errors
///
/// When the standard output cannot be written.
pub fn list_physics_worlds() -> anyhow::Result<()> {
    list(&SHIPPED, 18, |name| load(name).map(|world| world.spec.description.clone()))
}

fn load_stage(name: &str) -> anyhow::Result<Loaded> {
    let (fleet, findings) = stage::load(Path::new(name), &Disk);
    let fleet = fleet.ok_or_else(|| anyhow!(findings.error_text()))?;
    let mut warnings =
        [Severity::Warning, Severity::Note].map(|severity| findings.messages(severity)).concat();
    let driven: Vec<usize> = fleet.driven_robots().collect();
    let explorer = driven.first().copied().unwrap_or(0);
    let none =
        || anyhow!("`{}` has no robot that could explore: it takes a `position` model", printable(name));
    let spec = WorldSpec::driving(fleet, explorer).ok_or_else(none)?;
    if driven.len() != 1 {
        warnings.push(format!(
            "warning: of the robots in `{0}`, `{1}` explores{2}\n  = help: for another one, make a world file with \
             `check_world --toml {0}`, and change the behaviors there",
            printable(name),
            spec.driven().name,
            if driven.is_empty() { "" } else { ", and the others that obey commands stand still" },
        ));
    }
    Ok(Loaded { spec, warnings })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim::physics::BehaviorSpec;

    #[test]
    fn of_a_stage_world_one_robot_explores() {
        let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/stage/lab.world");
        assert_eq!(load(lab).unwrap().spec.driven().name, "r1");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.world");
        let text = "define r position ( size [0.4 0.4 0.3] ranger ( sensor ( range [0 5] fov 180 samples 181 ) ) )\n";
        let path = path.to_str().unwrap();
        std::fs::write(path, format!("{text}r ( name \"a\" )\nr ( pose [2 0 0 0] name \"b\" )\n")).unwrap();
        let Loaded { spec, warnings } = load(path).unwrap();
        assert_eq!((spec.driven().name.as_str(), &spec.robots[1].behavior), ("a", &BehaviorSpec::Standing));
        assert!(warnings.last().unwrap().contains("`a` explores, and the others"), "{warnings:?}");
        std::fs::write(path, "model ( size [1 1 1] )\n").unwrap();
        assert!(load(path).unwrap_err().to_string().contains("has no robot that could explore"));
        std::fs::write(path, "model ( size [1 1 1 )\n").unwrap();
        assert!(load(path).unwrap_err().to_string().contains("two.world:1"));
    }
}
