//! What is in a world file, in words and as a plan, whoever wrote it and for whatever simulator.

mod grid;
mod physics;
#[cfg(test)]
mod tests;

use curious::pictures::Plan;
use std::path::Path;
use worldfile::floor_plan::FloorPlan;
use worldfile::{Disk, Files, Findings, Severity, ros_map, shipped};

/// What was found in one file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inspection {
    /// What the file was called by whoever asked.
    pub(crate) file: String,
    /// The world, unless there are errors.
    pub(crate) content: Option<Content>,
    /// What the world will do otherwise than the file asks, then what is good to know, one message each.
    pub(crate) warnings: Vec<String>,
    /// What is wrong with the file, one message each; the last one can be about several.
    pub(crate) errors: Vec<String>,
    /// How many things are wrong with it.
    pub(crate) error_count: usize,
}

/// What is in a world.
#[derive(Clone, Debug)]
pub(crate) struct Content {
    /// What kind of world it is.
    pub(crate) kind: &'static str,
    /// What it is called.
    pub(crate) name: String,
    /// What it shows, in its author's words; can be empty.
    pub(crate) description: String,
    /// Lines of a name and what there is of it.
    pub(crate) lines: Vec<(&'static str, String)>,
    /// What it looks like.
    pub(crate) plan: Plan,
}

/// Reads a file as what it is: a shipped world by its name, a world file (physics or grid), a `.world` file of
/// Stage, or a `map.yaml` of ROS.
pub(crate) fn inspect(name: &str) -> Inspection {
    let shipped = shipped::text(name);
    let path = Path::new(name);
    let mut inspection = match (shipped, path.extension().and_then(|ending| ending.to_str())) {
        (Some(text), _) => world_file(&format!("{name}.toml"), text, &shipped::pictures()),
        (None, _) if is_of_stage(path) => stage_file(path),
        (None, Some("yaml" | "yml")) => ros_file(path),
        (None, _) => match std::fs::read(path) {
            Ok(bytes) => match String::from_utf8(bytes) {
                Ok(text) => world_file(name, &text, &Disk),
                Err(_) => wrong(format!("error: cannot read `{name}`: it is no text, so no world file")),
            },
            Err(why) => wrong(format!("error: cannot read `{name}`: {why}, and no world of this name ships")),
        },
    };
    inspection.file = name.to_owned();
    inspection
}

/// The same world as a world file of ours, of a `.world` file of Stage that is right.
pub(crate) fn as_world_file(name: &str) -> Option<String> {
    let path = Path::new(name);
    let (world, _) = is_of_stage(path).then(|| stage::read(path, &Disk))?;
    world.map(|world| world.to_toml())
}

fn is_of_stage(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "world" || ending == "inc")
}

fn wrong(error: String) -> Inspection {
    Inspection { errors: vec![error], error_count: 1, ..Inspection::default() }
}

/// A world file of ours: with a drawing for a `map` it is a grid world.
fn world_file(name: &str, text: &str, files: &dyn Files) -> Inspection {
    let is_grid =
        text.parse::<toml::Table>().is_ok_and(|file| file.get("map").is_some_and(toml::Value::is_str));
    let outcome = if is_grid {
        worldfile::grid::parse(name, text).map(|world| (grid::content(&world), world.warnings()))
    } else {
        worldfile::physics::parse_fleet_with(name, text, files)
            .map(|world| (physics::content("physics world", &world), Vec::new()))
    };
    match outcome {
        Ok((content, warnings)) => {
            let warnings = warnings.iter().map(|warning| format!("warning: {warning}")).collect();
            Inspection { content: Some(content), warnings, ..Inspection::default() }
        }
        Err(error) => {
            let errors = error.messages().iter().map(|message| format!("error: {message}")).collect();
            Inspection { errors, error_count: error.count(), ..Inspection::default() }
        }
    }
}

fn stage_file(path: &Path) -> Inspection {
    let (world, findings) = stage::load(path, &Disk);
    found(world.map(|world| physics::content("Stage world", &world)), &findings)
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
