//! The content of a world file of any format, as text and as a scene.

mod grid;
mod physics;
#[cfg(test)]
mod tests;

use curious::reachability;
use curious::worlds::is_of_stage;
use draw::scene::Scene;
use interfaces::printable;
use sim::grid::GridSpec;
use sim::physics::WorldSpec;
use std::path::Path;
use worldfile::floor_plan::FloorPlan;
use worldfile::physics::to_toml;
use worldfile::{Disk, Files, Findings, MAX_TEXT_BYTES, Severity, ros_map, shipped};

/// The result for one file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inspection {
    /// The name of the file, printable.
    pub(crate) file: String,
    /// The world, unless there are errors.
    pub(crate) content: Option<Content>,
    /// Differences between the world and its file, then notes; one message each.
    pub(crate) warnings: Vec<String>,
    /// The errors, one message each; the last message can be about several.
    pub(crate) errors: Vec<String>,
    /// The number of errors.
    pub(crate) error_count: usize,
}

/// The content of a world.
#[derive(Clone, Debug)]
pub(crate) struct Content {
    /// The kind of the world.
    pub(crate) kind: &'static str,
    /// The description in the file; can be empty.
    pub(crate) description: String,
    /// One line per part of the world: the name of the part, and its description.
    pub(crate) lines: Vec<(&'static str, String)>,
    /// The world from above; its title is the name of the world.
    pub(crate) scene: Scene,
}

/// Reads a shipped world or a generated building by its name, or a file by its format: a world file (physics or grid), a Stage file, or
/// a ROS map.
pub(crate) fn inspect(name: &str) -> Inspection {
    let text = shipped::text(name).map(str::to_owned).or_else(|| generated(name));
    let path = Path::new(name);
    let mut inspection = match (text, path.extension().and_then(|ending| ending.to_str())) {
        (Some(text), _) => world_file(&format!("{name}.toml"), &text, &shipped::pictures()),
        (None, _) if is_of_stage(path) => stage_file(path),
        (None, Some("yaml" | "yml")) => ros_file(path),
        (None, _) => match Disk.read(path, MAX_TEXT_BYTES) {
            Ok(bytes) => match String::from_utf8(bytes) {
                Ok(text) => world_file(name, &text, &Disk),
                Err(_) => invalid(format!("error: cannot read `{}`: it is not a text file", printable(name))),
            },
            Err(why) => invalid(format!(
                "error: cannot read `{}`: {why}, and there is no shipped world of this name",
                printable(name)
            )),
        },
    };
    inspection.file = printable(name).into_owned();
    inspection
}

/// A valid Stage world or a generated building as a world file; `None` for others.
pub(crate) fn as_world_file(name: &str) -> Option<String> {
    let path = Path::new(name);
    if !is_of_stage(path) {
        return generated(name);
    }
    stage::read(path, &Disk).0.map(|world| world.to_toml())
}

/// The file of a generated building.
fn generated(name: &str) -> Option<String> {
    let grid = || GridSpec::generated(name).map(|world| worldfile::grid::to_toml(&world));
    WorldSpec::generated(name).and_then(|world| to_toml(world.fleet())).or_else(grid)
}

fn invalid(error: String) -> Inspection {
    Inspection { errors: vec![error], error_count: 1, ..Inspection::default() }
}

/// A TOML world file: a grid world if `map` is a drawing.
fn world_file(name: &str, text: &str, files: &dyn Files) -> Inspection {
    let outcome = if worldfile::grid::is_grid_world(text) {
        worldfile::grid::parse(name, text).map(|world| {
            (
                grid::content(&world),
                world.warnings().iter().map(|warning| format!("warning: {warning}")).collect(),
            )
        })
    } else {
        worldfile::physics::parse_fleet_with(name, text, files)
            .map(|world| (physics::content("physics world", &world), reachability::warnings(&world)))
    };
    match outcome {
        Ok((content, warnings)) => Inspection { content: Some(content), warnings, ..Inspection::default() },
        Err(error) => found(None, error.findings()),
    }
}

fn stage_file(path: &Path) -> Inspection {
    let (world, findings) = stage::load(path, &Disk);
    let warnings = world.as_ref().map(reachability::warnings).unwrap_or_default();
    let mut inspection = found(world.map(|world| physics::content("Stage world", &world)), &findings);
    inspection.warnings.extend(warnings);
    inspection
}

fn ros_file(path: &Path) -> Inspection {
    let mut findings = Findings::default();
    let plan: Option<FloorPlan> = ros_map::read_floor_plan(path, &Disk, &mut findings);
    found(plan.and_then(|plan| physics::floor_plan(path, &plan)), &findings)
}

fn found(content: Option<Content>, findings: &Findings) -> Inspection {
    let of = |severity| findings.messages(severity);
    Inspection {
        content,
        warnings: [of(Severity::Warning), of(Severity::Note)].concat(),
        errors: of(Severity::Error),
        error_count: findings.errors(),
        ..Inspection::default()
    }
}
