//! `keys.md` agrees with the reader on every key.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

const KEYS: &str = include_str!("../../../keys.md");

/// A row of a table: the heading above it, and its cells.
struct Row<'a> {
    heading: &'a str,
    keys: Vec<&'a str>,
    default: &'a str,
    range: &'a str,
}

fn rows() -> Vec<Row<'static>> {
    let (mut rows, mut heading) = (Vec::new(), "");
    for line in KEYS.lines() {
        if let Some(text) = line.strip_prefix("## ").or(line.strip_prefix("### ")) {
            heading = text;
        }
        if line.starts_with("| `") {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            assert_eq!(cells.len(), 4, "{line}");
            let keys = cells[0].split('`').skip(1).step_by(2).collect();
            rows.push(Row { heading, keys, default: cells[2], range: cells[3] });
        }
    }
    rows
}

/// For each heading: the table of the file, and keys that make it valid.
const GOOD: &[(&str, &str, &str)] = &[
    ("The file", "", ""),
    ("`map`", "map", "size_m = [4.0, 3.0]\ncell_m = 0.05"),
    ("`physics`", "physics", "step_s = 0.05"),
    ("`wall`", "wall", "from_m = [1.0, 0.5]\nto_m = [2.0, 0.5]\nthickness_m = 0.1"),
    ("`floor_plan`", "floor_plan", "image = \"dot.pgm\"\npixel_m = 0.1\ncorner_m = [0.0, 0.0]"),
    ("`obstacle`", "obstacle", "name = \"o\"\ncenter_m = [3.0, 2.0]\nsize_m = [0.2, 0.2]"),
    ("`kind = \"fixed\"`", "obstacle", "name = \"o\"\ncenter_m = [3.0, 2.0]\nsize_m = [0.2, 0.2]"),
    (
        "`kind = \"box\"`",
        "obstacle",
        "name = \"o\"\nkind = \"box\"\ncenter_m = [3.0, 2.0]\nsize_m = [0.2, 0.2]\nmass_kg = 1.0",
    ),
    (
        "`kind = \"block\"`",
        "obstacle",
        "name = \"o\"\nkind = \"block\"\nsize_m = [0.2, 0.2]\npath_m = [[3.0, 2.0]]\nspeed_mps = 1.0",
    ),
    (
        "`kind = \"hinged_door\"` and `kind = \"sliding_door\"`",
        "obstacle",
        "name = \"o\"\nkind = \"hinged_door\"\nfrom_m = [3.0, 2.0]\nto_m = [3.8, 2.0]\nthickness_m = 0.05\n\
         opening = \"random\"\nclosed_s = 1.0\nopen_s = 1.0",
    ),
    ("`obstacle.schedule`", "obstacle.schedule", "free_s = 100.0\nblocked_s = 200.0"),
    ("`robot`", "robot", "name = \"r\"\nradius_m = 0.3\npose_m = [1.0, 2.0]"),
    (
        "`robot.drive`",
        "robot.drive",
        "max_linear_mps = 0.5\nmax_angular_degps = 90.0\nmax_linear_acceleration_mps2 = 1.0\n\
         max_angular_acceleration_degps2 = 360.0",
    ),
    ("`robot.patrol`", "robot.patrol", ""),
    ("`robot.odometry`", "robot.odometry", ""),
    (
        "`robot.odometry.jump` and `robot.odometry.carried`",
        "robot.odometry.jump",
        "every_s = 10.0\ndistance_m = 1.0\nturn_deg = 10.0",
    ),
    ("`robot.laser`", "robot.laser", "beams = 10\nrange_max_m = 5.0\nrate_hz = 10.0"),
    ("`robot.behavior`", "robot.behavior", "kind = \"driven\""),
    ("`robot.bumper`", "robot.bumper", "sectors = 4"),
    ("`robot.sonar`", "robot.sonar", "cone_deg = 30.0\nrange_max_m = 5.0\nrate_hz = 10.0"),
];

/// The additional keys that a key needs, if the valid ones do not include them.
fn fit(heading: &str, key: &str, good: &str) -> String {
    let kind = |kind: &str| format!("kind = \"{kind}\"\nspeed_mps = 0.3");
    match (heading, key) {
        ("`robot.behavior`", "clearance_m") => kind("wander"),
        ("`robot.behavior`", "turn_radius_m" | "direction") => kind("circle") + "\nturn_radius_m = 1.0",
        ("`robot.behavior`", "repeat") => kind("waypoints") + "\npoints_m = [[2.0, 2.0]]",
        (_, "max_left_mps" | "max_left_acceleration_mps2") => format!("kind = \"omni\"\n{good}"),
        (_, "wheelbase_m" | "max_steer_deg") => format!("kind = \"car\"\nwheelbase_m = 1.0\n{good}"),
        (_, "slide_m") => good.replace("hinged", "sliding"),
        (_, "switches_s") => good.replace("random", "scripted").replace("closed_s = 1.0\nopen_s = 1.0", ""),
        (_, "place") => {
            let thing = format!("{good}\nschedule = {{ free_s = 9.0, blocked_s = 9.0 }}\n");
            format!("{thing}[[obstacle]]\n{}\npart_of = \"o\"", good.replace("\"o\"", "\"part\""))
        }
        (_, "times_s") => good.replace("speed_mps = 1.0", ""),
        _ => good.to_owned(),
    }
}

/// A world in which the table of a heading has other keys.
fn world(heading: &str, changed: &str) -> String {
    let mut text = "name = \"w\"\n".to_owned();
    let table_of = |heading: &str| GOOD.iter().find(|(known, _, _)| *known == heading).unwrap().1;
    for (known, table, good) in GOOD {
        // These exist only where they are asked for.
        let is_optional = table.starts_with("obstacle")
            || ["floor_plan", "robot.patrol", "robot.odometry.jump", "robot.bumper", "robot.sonar"]
                .contains(table);
        let holds_it = *known == "`obstacle`" && heading == "`obstacle.schedule`";
        if (is_optional || table_of(heading) == *table) && *known != heading && !holds_it {
            continue;
        }
        let keys = if *known == heading { changed } else { good };
        match *table {
            "" => text += &format!("{keys}\n"),
            "wall" | "floor_plan" | "obstacle" | "robot" | "robot.sonar" => {
                text += &format!("[[{table}]]\n{keys}\n")
            }
            _ => text += &format!("[{table}]\n{keys}\n"),
        }
    }
    text
}

fn parse(text: &str) -> Result<String, String> {
    let dot = (PathBuf::from("dot.pgm"), b"P2 1 1 255 0".to_vec());
    let spec = worldfile::physics::parse_fleet_with("w.toml", text, &BTreeMap::from([dot]));
    spec.map(|spec| format!("{spec:?}")).map_err(|error| error.to_string())
}

#[test]
fn the_keys_are_those_of_the_schema() {
    for (_, table, _) in GOOD {
        let headings: Vec<&str> =
            GOOD.iter().filter(|(_, other, _)| other == table).map(|(heading, _, _)| *heading).collect();
        let rows = rows().into_iter().filter(|row| headings.contains(&row.heading));
        let documented: BTreeSet<&str> = rows.flat_map(|row| row.keys).collect();
        let error = parse(&world(headings[0], "no_such_key = 1")).unwrap_err();
        let (_, known) = error.split_once("the keys here are: ").unwrap_or_else(|| panic!("{error}"));
        let known: BTreeSet<&str> = known.trim().split(", ").collect();
        assert_eq!(documented, known, "the table `{table}`");
    }
    assert!(rows().iter().all(|row| GOOD.iter().any(|(heading, _, _)| *heading == row.heading)));
}

#[test]
fn the_ranges_are_those_that_are_checked() {
    let mut checked = 0;
    for row in rows() {
        let Some((low, rest)) = row.range.split_once(" to ") else { continue };
        let high = rest.split([' ', ';']).next().unwrap_or_default();
        let (Ok(least), Ok(most)) = (low.parse::<f64>(), high.parse::<f64>()) else { continue };
        let (_, _, good) = GOOD.iter().find(|(heading, _, _)| *heading == row.heading).unwrap();
        for key in row.keys.iter().filter(|key| !matches!(**key, "path_m" | "points_m" | "center_m")) {
            let keys = fit(row.heading, key, good);
            let others: Vec<&str> =
                keys.lines().filter(|line| !line.starts_with(&format!("{key} ="))).collect();
            for beyond in [least - 0.5 * least.abs() - 1e-5, most * 1.5] {
                let value = match *key {
                    "beams" | "sectors" | "place" => format!("{}", beyond.max(0.0) as u32),
                    "size_m" => format!("[{beyond:?}, {beyond:?}]"),
                    "times_s" | "switches_s" => format!("[{beyond:?}]"),
                    _ => format!("{beyond:?}"),
                };
                let text = world(row.heading, &format!("{}\n{key} = {value}", others.join("\n")));
                let error = parse(&text).expect_err(&text);
                assert!(error.contains(&format!("from {low} to {high}")), "{key} = {value}: {error}");
                checked += 1;
            }
        }
    }
    assert!(checked > 80, "only {checked}");
}

#[test]
fn the_defaults_are_those_that_are_taken() {
    let mut checked = 0;
    for row in rows().iter().filter(|row| row.heading != "The file") {
        let Some(default) = row.default.strip_prefix('`').and_then(|text| text.strip_suffix('`')) else {
            let known = "required, its length, never, none, stands from the start, its start, those of active hours, \
                         1 kg per m² of its circle";
            assert!(known.split(", ").any(|known| known == row.default), "{:?}: {}", row.keys, row.default);
            continue;
        };
        // The value of another key does not count.
        if default == "{}" || default == "[]" || default.starts_with("max_") {
            continue;
        }
        let (_, _, good) = GOOD.iter().find(|(heading, _, _)| *heading == row.heading).unwrap();
        let keys = fit(row.heading, row.keys[0], good);
        let start = format!("{} =", row.keys[0]);
        let without: Vec<&str> = keys.lines().filter(|line| !line.starts_with(&start)).collect();
        let without = without.join("\n");
        let with = format!("{without}\n{} = {default}", row.keys[0]);
        let parsed = |keys: &str| parse(&world(row.heading, keys)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(parsed(&with), parsed(&without), "{:?} = {default}", row.keys);
        checked += 1;
    }
    assert!(checked > 20, "only {checked}");
}
