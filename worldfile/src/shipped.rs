//! The worlds that are part of the program, so that it runs from any folder. They are read through the link `worldfile/worlds`: a package has
//! only what is in its own folder.

use crate::{Files, WorldError, grid, physics};
use interfaces::printable;
use sim::grid::GridSpec;
use sim::physics::WorldSpec;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The name and the text of every shipped physics world; the first is the default.
pub const PHYSICS: [(&str, &str); 10] = [
    ("four_rooms", include_str!("../worlds/four_rooms.toml")),
    ("toy_on_the_floor", include_str!("../worlds/toy_on_the_floor.toml")),
    ("turned_house", include_str!("../worlds/turned_house.toml")),
    ("house", include_str!("../worlds/house.toml")),
    ("drifting_house", include_str!("../worlds/drifting_house.toml")),
    ("office", include_str!("../worlds/office.toml")),
    ("warehouse", include_str!("../worlds/warehouse.toml")),
    ("cave", include_str!("../worlds/cave.toml")),
    ("yard", include_str!("../worlds/yard.toml")),
    ("office_week", include_str!("../worlds/office_week.toml")),
];

/// The name and the text of every shipped grid world; the first is the default.
pub const GRID: [(&str, &str); 5] = [
    ("two_blocks", include_str!("../worlds/two_blocks.toml")),
    ("open_hall", include_str!("../worlds/open_hall.toml")),
    ("corridor_with_doors", include_str!("../worlds/corridor_with_doors.toml")),
    ("many_slow_blocks", include_str!("../worlds/many_slow_blocks.toml")),
    ("one_fast_block", include_str!("../worlds/one_fast_block.toml")),
];

/// The name and the text of the shipped tour.
pub const TOUR: (&str, &str) = ("four_rooms.tour.toml", include_str!("../worlds/four_rooms.tour.toml"));

/// The pictures that floor plans of shipped worlds are made from.
const PICTURES: [(&str, &[u8]); 2] = [
    ("office.png", include_bytes!("../worlds/office.png")),
    ("cave.png", include_bytes!("../worlds/cave.png")),
];

/// The text of the shipped world (of either kind) with the name `name`.
pub fn text(name: &str) -> Option<&'static str> {
    let mut shipped = PHYSICS.iter().chain(&GRID);
    shipped.find(|(shipped, _)| *shipped == name).map(|(_, text)| *text)
}

/// The files beside the shipped worlds.
pub fn pictures() -> impl Files {
    let pictures = PICTURES.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec()));
    pictures.collect::<BTreeMap<_, _>>()
}

/// The error for a name that does not lead to a world.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// Neither a shipped world nor a file.
    #[error("there is no world `{name}`: it is neither a file nor one of those that ship ({shipped})")]
    Unknown {
        /// The name as given.
        name: String,
        /// The names of the shipped worlds, and what other names there are.
        shipped: String,
    },
    /// A shipped world, but not one for this program.
    #[error("`{name}` is a {kind} world: it is for the program {program}")]
    OtherKind {
        /// The name as given.
        name: String,
        /// The kind of the world.
        kind: &'static str,
        /// The program that runs worlds of this kind.
        program: &'static str,
    },
    /// The file is not a world.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The file is a map without a world.
    #[error(
        "`{name}` is a map, without robots: a world file can have it as its walls, by `[[floor_plan]]` and \
         `map = \"{name}\"`"
    )]
    Map {
        /// The name as given.
        name: String,
    },
}

/// The physics world with the name `name`: a shipped world, or the file with this path, or a generated building
/// (`house-7`, `office-7`, `rooms-7`, `rooms-day-7`, `calendar-office-7`).
///
/// # Errors
///
/// When there is no such world or file, or when it is not a world of this kind.
pub fn load(name: &str) -> Result<WorldSpec, LoadError> {
    if GRID.iter().any(|(grid, _)| *grid == name) {
        return Err(LoadError::OtherKind { name: name.to_owned(), kind: "grid", program: "grid_world" });
    }
    if Path::new(name).extension().is_some_and(|ending| ending == "yaml" || ending == "yml") {
        return Err(LoadError::Map { name: printable(name).into_owned() });
    }
    let parse = |name: &str, text: &str| physics::parse_world_with(name, text, &pictures());
    let found = find(name, &PHYSICS, parse, |path| physics::load_world(path));
    or_generated(found, "house-7, office-7, rooms-7, rooms-day-7", || WorldSpec::generated(name))
}

/// The generated building for a name that is neither shipped nor a file; an error names `examples`.
fn or_generated<T>(
    found: Result<T, LoadError>,
    examples: &str,
    generated: impl FnOnce() -> Option<T>,
) -> Result<T, LoadError> {
    let (name, shipped) = match found {
        Err(LoadError::Unknown { name, shipped }) => (name, shipped),
        found => return found,
    };
    let shipped = format!("{shipped}; or a generated building: {examples}, calendar-office-7 and so on");
    generated().ok_or(LoadError::Unknown { name, shipped })
}

/// The grid world with the name `name`: a shipped world, or the file with this path, or a generated world (`generated-7`,
/// `grid-rooms-7`, `grid-rooms-day-7`, `calendar-office-7`).
///
/// # Errors
///
/// The errors of [`load`].
pub fn load_grid(name: &str) -> Result<GridSpec, LoadError> {
    if PHYSICS.iter().any(|(physics, _)| *physics == name) {
        return Err(LoadError::OtherKind { name: name.to_owned(), kind: "physics", program: "four_rooms" });
    }
    let found = find(name, &GRID, grid::parse, |path| grid::load(path));
    or_generated(found, "generated-7, grid-rooms-7, grid-rooms-day-7", || GridSpec::generated(name))
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
        return Err(LoadError::Unknown { name: printable(name).into_owned(), shipped: names.join(", ") });
    }
    Ok(load(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_world_is_valid() {
        for (name, _) in PHYSICS {
            load(name).unwrap_or_else(|error| panic!("{error}"));
        }
        for (name, _) in GRID {
            let world = load_grid(name).unwrap_or_else(|error| panic!("{error}"));
            assert!(world.warnings().is_empty(), "{:?}", world.warnings());
        }
        assert!(matches!(load("map.yaml"), Err(LoadError::Map { .. })));
        assert_eq!(load("office-3").unwrap(), WorldSpec::generate_office(3));
        assert!(matches!(load("office-x"), Err(LoadError::Unknown { .. })));
    }

    #[test]
    fn the_drifting_house_differs_from_the_house_only_in_what_the_robot_senses() {
        let spec = |name| load(name).unwrap_or_else(|error| panic!("{error}")).fleet().clone();
        let (house, mut drifting) = (spec("house"), spec("drifting_house"));
        let (exact, robot) = (&house.robots[0], &mut drifting.robots[0]);
        assert!(exact.odometry.is_exact() && !robot.odometry.is_exact());
        assert_eq!((robot.laser.sweep_s, robot.laser.noise_std_m), (0.1, 0.01));
        (robot.odometry, robot.laser) = (exact.odometry, exact.laser);
        (drifting.name, drifting.description) = (house.name.clone(), house.description.clone());
        assert_eq!(drifting, house);
    }

    #[test]
    fn every_world_file_ships() {
        let files = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../worlds")).unwrap();
        let files = files.map(|file| file.unwrap().path());
        for file in files.filter(|file| file.extension().is_some_and(|ending| ending == "toml")) {
            let name = file.file_stem().unwrap().to_str().unwrap().to_owned();
            assert!(text(&name).is_some() || name.ends_with(".tour"), "{name} is not in the list");
        }
    }
}
