//! The worlds that ship with the program, so that it runs from any folder.

use sim::grid::GridSpec;
use sim::physics::{Behaviour, WorldSpec};
use sim::{Disk, Severity, WorldError, stage};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The name and the text of every shipped physics world; the first is the default.
pub const SHIPPED: [(&str, &str); 8] = [
    ("four_rooms", include_str!("../worlds/four_rooms.toml")),
    ("toy_on_the_floor", include_str!("../worlds/toy_on_the_floor.toml")),
    ("turned_house", include_str!("../worlds/turned_house.toml")),
    ("house", include_str!("../sim/worlds/house.toml")),
    ("office", include_str!("../sim/worlds/office.toml")),
    ("warehouse", include_str!("../sim/worlds/warehouse.toml")),
    ("cave", include_str!("../sim/worlds/cave.toml")),
    ("yard", include_str!("../sim/worlds/yard.toml")),
];

/// The pictures that floor plans of shipped worlds are made from.
const PICTURES: [(&str, &[u8]); 2] = [
    ("office.png", include_bytes!("../sim/worlds/office.png")),
    ("cave.png", include_bytes!("../sim/worlds/cave.png")),
];

/// The name and the text of every shipped grid world; the first is the default.
pub const SHIPPED_GRID: [(&str, &str); 5] = [
    ("two_blocks", include_str!("../worlds/two_blocks.toml")),
    ("open_hall", include_str!("../worlds/open_hall.toml")),
    ("corridor_with_doors", include_str!("../worlds/corridor_with_doors.toml")),
    ("many_slow_blocks", include_str!("../worlds/many_slow_blocks.toml")),
    ("one_fast_block", include_str!("../worlds/one_fast_block.toml")),
];

/// The name and the text of the shipped tour.
pub const TOUR: (&str, &str) = ("four_rooms.tour.toml", include_str!("../worlds/four_rooms.tour.toml"));

/// The text of the shipped world of either kind that is called `name`.
pub fn text(name: &str) -> Option<&'static str> {
    let mut shipped = SHIPPED.iter().chain(&SHIPPED_GRID);
    shipped.find(|(shipped, _)| *shipped == name).map(|(_, text)| *text)
}

/// Why there is no world.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// Neither a shipped world nor a file.
    #[error("there is no world `{name}`: it is neither a file nor one of those that ship ({shipped})")]
    Unknown {
        /// As given.
        name: String,
        /// The names of the shipped worlds.
        shipped: String,
    },
    /// A shipped world, but not one for this program.
    #[error("`{name}` is a {kind} world: it is for the program {program}")]
    OtherKind {
        /// As given.
        name: String,
        /// What kind of world it is.
        kind: &'static str,
        /// The program that runs it.
        program: &'static str,
    },
    /// The file is not a world.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The file of Stage is not a world: all that is wrong with it, as in a [`WorldError`].
    #[error("{0}")]
    Stage(String),
    /// A world of Stage in which nobody could explore.
    #[error("`{name}` has no robot that could explore: it takes a `position` model")]
    NoRobot {
        /// As given.
        name: String,
    },
    /// A map alone.
    #[error(
        "`{name}` is a map, without robots: a world file can have it as its walls, by `[[floor_plan]]` and \
         `map = \"{name}\"`"
    )]
    Map {
        /// As given.
        name: String,
    },
}

/// A world to run.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The world.
    pub spec: WorldSpec,
    /// What it will do otherwise than its file asks, one message each.
    pub warnings: Vec<String>,
}

/// The world that `name` stands for: a shipped one by its name, else a file by its path, one of ours or of Stage's
/// (`.world`).
///
/// # Errors
///
/// When there is no such file either, or it is not a world of this kind.
pub fn load(name: &str) -> Result<Loaded, LoadError> {
    if SHIPPED_GRID.iter().any(|(grid, _)| *grid == name) {
        return Err(LoadError::OtherKind { name: name.to_owned(), kind: "grid", program: "grid_world" });
    }
    match Path::new(name).extension().and_then(|ending| ending.to_str()) {
        Some("world") if Path::new(name).exists() => return load_stage(name),
        Some("yaml" | "yml") => return Err(LoadError::Map { name: name.to_owned() }),
        _ => {}
    }
    let parse = |name: &str, text: &str| WorldSpec::parse_with(name, text, &pictures());
    let spec = find(name, &SHIPPED, parse, |path| WorldSpec::load(path))?;
    Ok(Loaded { spec, warnings: Vec::new() })
}

fn load_stage(name: &str) -> Result<Loaded, LoadError> {
    let (fleet, findings) = stage::load(Path::new(name), &Disk);
    let Some(fleet) = fleet else {
        let errors = findings.messages(Severity::Error).join("\n\n");
        return Err(LoadError::Stage(errors.trim_start_matches("error: ").to_owned()));
    };
    let mut warnings =
        [Severity::Warning, Severity::Note].map(|severity| findings.messages(severity)).concat();
    let driven: Vec<usize> =
        (0..fleet.robots().len()).filter(|&i| fleet.robots()[i].behaviour == Behaviour::Driven).collect();
    let explorer = driven.first().copied().unwrap_or(0);
    let spec =
        WorldSpec::driving(fleet, explorer).ok_or_else(|| LoadError::NoRobot { name: name.to_owned() })?;
    if driven.len() != 1 {
        warnings.push(format!(
            "warning: of the robots in `{name}`, `{}` explores{}\n  = help: for another one, make a world file with \
             `check_world --toml {name}`, and change the behaviours there",
            spec.driven().name,
            if driven.is_empty() { "" } else { ", and the others that obey commands stand still" },
        ));
    }
    Ok(Loaded { spec, warnings })
}

/// The grid world that `name` stands for, as [`load`].
///
/// # Errors
///
/// As [`load`].
pub fn load_grid(name: &str) -> Result<GridSpec, LoadError> {
    if SHIPPED.iter().any(|(physics, _)| *physics == name) {
        return Err(LoadError::OtherKind { name: name.to_owned(), kind: "physics", program: "four_rooms" });
    }
    find(name, &SHIPPED_GRID, GridSpec::parse, |path| GridSpec::load(path))
}

/// The files beside the shipped worlds.
pub fn pictures() -> BTreeMap<PathBuf, Vec<u8>> {
    PICTURES.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())).collect()
}

fn find<T>(
    name: &str,
    shipped: &[(&str, &str)],
    parse: impl Fn(&str, &str) -> Result<T, WorldError>,
    load: impl Fn(&Path) -> Result<T, WorldError>,
) -> Result<T, LoadError> {
    if let Some((name, text)) = shipped.iter().find(|(shipped, _)| *shipped == name) {
        return Ok(parse(&format!("{name}.toml"), text)?);
    }
    let path = Path::new(name);
    if !path.exists() {
        let names: Vec<&str> = shipped.iter().map(|(name, _)| *name).collect();
        return Err(LoadError::Unknown { name: name.to_owned(), shipped: names.join(", ") });
    }
    Ok(load(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_world_is_right() {
        for (name, _) in SHIPPED {
            load(name).unwrap_or_else(|error| panic!("{error}"));
        }
        for (name, _) in SHIPPED_GRID {
            let world = load_grid(name).unwrap_or_else(|error| panic!("{error}"));
            assert!(world.warnings().is_empty(), "{:?}", world.warnings());
        }
    }

    #[test]
    fn of_a_stage_world_one_robot_explores() {
        let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/sim/worlds/stage/lab.world");
        assert_eq!(load(lab).unwrap().spec.driven().name, "r1");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.world");
        let text = "define r position ( size [0.4 0.4 0.3] ranger ( sensor ( range [0 5] fov 180 samples 181 ) ) )\n";
        let path = path.to_str().unwrap();
        std::fs::write(path, format!("{text}r ( name \"a\" )\nr ( pose [2 0 0 0] name \"b\" )\n")).unwrap();
        let Loaded { spec, warnings } = load(path).unwrap();
        assert_eq!(
            (spec.driven().name.as_str(), spec.robots()[1].behaviour.clone()),
            ("a", Behaviour::Standing)
        );
        assert!(warnings.last().unwrap().contains("`a` explores, and the others"), "{warnings:?}");
        std::fs::write(path, "model ( size [1 1 1] )\n").unwrap();
        assert!(matches!(load(path), Err(LoadError::NoRobot { .. })));
        std::fs::write(path, "model ( size [1 1 1 )\n").unwrap();
        assert!(load(path).unwrap_err().to_string().contains("two.world:1"));
        assert!(matches!(load("map.yaml"), Err(LoadError::Map { .. })));
    }

    #[test]
    fn every_world_file_ships() {
        let folders =
            ["/worlds", "/sim/worlds"].map(|folder| format!("{}{folder}", env!("CARGO_MANIFEST_DIR")));
        let files = folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
        let files = files.map(|file| file.unwrap().path());
        for file in files.filter(|file| file.extension().is_some_and(|ending| ending == "toml")) {
            let name = file.file_stem().unwrap().to_str().unwrap().to_owned();
            let is_shipped = SHIPPED.iter().chain(&SHIPPED_GRID).any(|(shipped, _)| *shipped == name);
            assert!(is_shipped || name.ends_with(".tour"), "{name} is not in the list");
        }
    }
}
