//! The messages for invalid files.

use super::*;

/// The message for the good world with one part replaced.
fn error(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    match crate::grid::parse("yard.toml", &GOOD.replacen(from, to, 1)) {
        Ok(_) => "no error".to_owned(),
        Err(error) => error.to_string(),
    }
}

/// Compares the messages, each under the name of its case, with the reviewed ones in `snapshots/`.
fn compare(group: &str, cases: &[(&str, &str, &str)]) {
    let messages = cases.iter().map(|(case, from, to)| format!("# {case}\n\n{}\n\n", error(from, to)));
    let messages: String = messages.collect();
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(group, messages) });
}

#[test]
fn keys_and_types() {
    compare(
        "keys_and_types",
        &[
            ("unknown key", "sensor_radius = 4", "sensor_range = 4"),
            ("unknown key of a block", "dwell = 7", "dwel = 7"),
            ("unknown key of the transitions", "block_chance = 0.5", "chance = 0.5"),
            ("unknown table", "[[block]]", "[[wall]]"),
            ("missing key", "sensor_radius = 4\n", ""),
            ("missing map", &GOOD[GOOD.find("map").unwrap()..GOOD.find("[trans").unwrap()], ""),
            ("missing key of a block", "dwell = 7\n", ""),
            ("a radius in words", "sensor_radius = 4", "sensor_radius = \"four\""),
            ("a fraction of a step", "dwell = 7", "dwell = 7.5"),
            ("a chance in words", "block_chance = 0.5", "block_chance = \"half\""),
            ("a path of one number", "[[1, 5], [6, 5], [6, 4]]", "5"),
            ("way points of one number", "[[1, 5], [6, 5], [6, 4]]", "[1, 5]"),
            ("a way point of three numbers", "[6, 5]", "[6, 5, 4]"),
            ("a way point of one number", "[6, 5]", "[6]"),
            ("fractions of a cell", "[6, 5]", "[6.5, 5]"),
            ("table instead of list", &GOOD[GOOD.find("[[block]]").unwrap()..], "[block]\nname = \"one\""),
            ("no toml", "dwell = 7", "dwell = "),
            ("a key twice", "dwell = 7", "dwell = 7\ndwell = 8"),
            ("empty name", "name = \"yard\"", "name = \"\""),
            ("empty name of a block", "name = \"low\"", "name = \" \""),
            ("blocks of one name", "name = \"low\"", "name = \"high\""),
            ("unknown course", "course = \"loop\"", "course = \"ring\""),
        ],
    );
}

#[test]
fn numbers() {
    compare(
        "numbers",
        &[
            ("blind", "sensor_radius = 4", "sensor_radius = 0"),
            ("sees too far", "sensor_radius = 4", "sensor_radius = 101"),
            ("negative radius", "sensor_radius = 4", "sensor_radius = -4"),
            ("huge radius", "sensor_radius = 4", "sensor_radius = 4000000000000"),
            ("dwell of zero", "dwell = 7", "dwell = 0"),
            ("negative dwell", "dwell = 7", "dwell = -7"),
            ("absurd dwell", "dwell = 7", "dwell = 1000001"),
            ("stood for longer than it stands", "stood = 2", "stood = 7"),
            ("chance of zero", "block_chance = 0.5", "block_chance = 0.0"),
            ("chance above one", "robot_chance = 1.0", "robot_chance = 1.01"),
            ("negative chance", "block_chance = 0.5", "block_chance = -0.5"),
            ("infinite chance", "block_chance = 0.5", "block_chance = inf"),
            ("no number", "block_chance = 0.5", "block_chance = nan"),
            ("way point far away", "[6, 5]", "[6, 9223372036854775807]"),
            ("way point beyond all numbers", "[6, 5]", "[6, 99999999999999999999]"),
        ],
    );
}

#[test]
fn maps() {
    let key = &GOOD[GOOD.find("map").unwrap()..GOOD.find("\n[trans").unwrap()];
    let map = &GOOD[GOOD.find("#########").unwrap()..GOOD.find("\"\"\"\n\n").unwrap()];
    compare(
        "maps",
        &[
            ("ragged", "#..###..#", "#..###..##"),
            ("ragged by a blank line", "#..###..#", "#..###..#\n"),
            ("indented", "#..###..#", "  #..###..#"),
            ("unknown character", "#..###..#", "#..#X#..#"),
            ("indented as a whole", "map = \"\"\"\n#########", "map = \"\"\"\n  #######"),
            ("unknown character of more bytes", "#..###..#", "#..#█#..#"),
            ("a tab", "#..###..#", "#..#\t#..#"),
            ("two starts", "#.......#", "#.R.....#"),
            ("start in a wall", "#...R...#", "#.......#"),
            ("no free cell", map, "####\n####\n####\n"),
            ("too narrow", map, "##\n#.\n##\n"),
            ("too low", map, "#.##\n####\n"),
            ("empty", map, ""),
            ("on one line", key, "map = \"###\"\n"),
            ("escaped", key, "map = \"###\\n#x#\\n###\"\n"),
        ],
    );
}

#[test]
fn paths() {
    compare(
        "paths",
        &[
            ("a jump", "[6, 5]", "[6, 3]"),
            ("standing still", "[6, 5]", "[1, 5], [6, 5]"),
            ("through a wall", "[[1, 5], [6, 5], [6, 4]]", "[[1, 3], [7, 3]]"),
            ("from a wall", "[[1, 5]", "[[0, 5]"),
            ("out of the map", "[6, 5]", "[9, 5]"),
            ("below the map", "[6, 5]", "[1, -1]"),
            ("an open loop", ", [3, 2], [1, 2]]", ", [3, 2]]"),
            ("one cell", "[[1, 5], [6, 5], [6, 4]]", "[[1, 5]]"),
            ("one cell, in a loop", "[[1, 1], [3, 1], [3, 2], [1, 2]]", "[[1, 1]]"),
            ("no cell", "[[1, 5], [6, 5], [6, 4]]", "[]"),
            ("from the robot's cell", "[[1, 5], [6, 5], [6, 4]]", "[[4, 2], [4, 1]]"),
            ("from another block's cell", "[[1, 5], [6, 5], [6, 4]]", "[[1, 1], [1, 2]]"),
        ],
    );
}

#[test]
fn a_map_may_be_too_large() {
    let of_width = |width: usize| {
        let map = format!("{}\n", ".".repeat(width)).repeat(2000);
        crate::grid::parse("yard.toml", &format!("name = 'n'\nsensor_radius = 4\nmap = '''\n{map}'''"))
    };
    insta::assert_snapshot!(of_width(2001).unwrap_err(), @r"
    the map is too large
     --> yard.toml:3:7
      |
    3 | map = '''
      |       ^^^ 2001 × 2000 cells
      |
      = help: 3 × 3 cells are the least, 4 million the most; one row of text is one row of cells
    ");
    assert_eq!(of_width(2000).unwrap().start, Cell::new(1000, 1000));
}

#[test]
fn a_path_may_be_too_long() {
    let there_and_back = "[1, 5], [6, 5], ".repeat(100_001);
    let text = GOOD.replace("[[1, 5], [6, 5], [6, 4]]", &format!("[{there_and_back}]"));
    let error = crate::grid::parse("yard.toml", &text).unwrap_err().to_string();
    assert!(error.starts_with("the path of the block `high` is too long\n"), "{error}");
}

#[test]
fn all_paths_together_may_be_too_long() {
    let map = format!("{}\n", ".".repeat(1000)).repeat(3);
    let path = "[0, 0], [999, 0], ".repeat(500);
    let block = |i: usize| {
        format!("[[block]]\nname = 'b{i}'\ndwell = 1\ncourse = 'back-and-forth'\npath = [{path}]\n")
    };
    let blocks: String = (0..12).map(block).collect();
    let text = format!("name = 'many'\nsensor_radius = 1\nmap = '''\n{map}'''\n{blocks}");
    let error = crate::grid::parse("many.toml", &text).unwrap_err();
    assert!(error.to_string().contains("the paths of the blocks have more than 10000000 cells"), "{error}");
}

#[test]
fn a_world_of_the_other_kind_is_called_what_it_is() {
    let physics = include_str!("../../../../worlds/four_rooms.toml");
    insta::assert_snapshot!(crate::grid::parse("four_rooms.toml", physics).unwrap_err(), @r"
    this is a physics world, not a grid world
     --> four_rooms.toml:7:2
      |
    7 | [map]
      |  ^^^ sizes, not a drawing
      |
      = help: a grid world draws its `map` as text: `#` wall, `.` free, one row of text per row of cells
    ");
    insta::assert_snapshot!(crate::physics::parse_world("yard.toml", GOOD).unwrap_err(), @r#"
    this is a grid world, not a physics world
     --> yard.toml:4:1
      |
    4 | map = """
      | ^^^ a drawing, not sizes
      |
      = help: a physics world has a table `[map]` with `size_m` and `cell_m`
    "#);
}
