//! Everything that is invalid in a file is reported, and nothing else.

pub(crate) mod mutations;

use crate::Severity;
use std::ops::Add;

const HOUSE: &str = include_str!("../../../worlds/house.toml");
const YARD: &str = include_str!("../../../worlds/yard.toml");
const FOUR_ROOMS: &str = include_str!("../../../worlds/four_rooms.toml");
const TWO_BLOCKS: &str = include_str!("../../../worlds/two_blocks.toml");

/// A robot of 0.2 m in a room of 4 m × 3 m.
fn robot(name: &str, keys: &str) -> String {
    format!(
        "[[robot]]\nname = \"{name}\"\nradius_m = 0.2\n{keys}\n\
         [robot.drive]\nmax_linear_mps = 0.5\nmax_angular_degps = 90.0\n\
         max_linear_acceleration_mps2 = 1.0\nmax_angular_acceleration_degps2 = 360.0\n\
         [robot.laser]\nbeams = 360\nrange_max_m = 10.0\nrate_hz = 10.0\n\
         [robot.behavior]\nkind = \"standing\"\n"
    )
}

fn room(parts: &str) -> String {
    format!(
        "name = \"room\"\n[map]\nsize_m = [4.0, 3.0]\ncell_m = 0.05\n\
         [[wall]]\nmin_m = [2.0, 0.0]\nmax_m = [2.1, 3.0]\n{parts}"
    )
}

fn messages(text: &str) -> Vec<String> {
    let error = match is_grid(text) {
        true => crate::grid::parse("world.toml", text).err(),
        false => crate::physics::parse_fleet("world.toml", text).err(),
    };
    let messages = error.map(|error| error.findings().messages(Severity::Error)).unwrap_or_default();
    messages.iter().map(|message| message.trim_start_matches("error: ").to_owned()).collect()
}

fn is_grid(text: &str) -> bool {
    text.contains("sensor_radius")
}

/// The errors, without their places.
fn firsts(text: &str) -> Vec<String> {
    messages(text).iter().map(|message| message.lines().next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn keys_types_and_meaning_are_reported_in_the_order_of_the_file() {
    let text = [
        robot("a", "pose_m = [1.0, 1.0]\ncolour = \"red\""),
        robot("b", "pose_m = [2.0, 1.0]"),
        robot("c", "pose_m = [1.0, 2.0]").replace("rate_hz = 10.0\n", ""),
        robot("d", "pose_m = [3.0, 2.0]").replace("beams = 360", "beams = \"many\"\nbeens = 3"),
        robot("e", "pose_m = [3.0, 1.0]").replace("kind = \"standing\"", "kind = \"standing\"\nmood = 1"),
    ];
    insta::assert_snapshot!(messages(&room(&text.concat())).join("\n\n"));
}

#[test]
fn every_missing_key_is_reported_once() {
    assert_eq!(
        firsts("[map]\n"),
        ["name", "size_m", "cell_m"].map(|key| format!("the key `{key}` is missing"))
    );
    assert_eq!(firsts("nmae = \"room\""), ["unknown key `nmae`", "the key `map` is missing"]);
    let grid = crate::grid::parse("world.toml", "").unwrap_err();
    let keys = ["name", "sensor_radius", "map"].map(|key| format!("the key `{key}` is missing"));
    let found: Vec<&str> = grid.findings().iter().map(|finding| finding.what.as_str()).collect();
    assert_eq!(found, keys);
}

#[test]
fn an_invalid_key_or_type_causes_no_other_error() {
    let one = |text: &str, first: &str| assert_eq!(firsts(text), [first], "{text}");
    let good = robot("a", "pose_m = [1.0, 1.0]");
    let wall = |keys: &str| room(&format!("[[wall]]\n{keys}\n{good}"));
    assert_eq!(firsts(&room(&good)), [] as [&str; 0]);
    // Without the key the wall would have no shape, the robot no outline.
    one(&wall("min_m = [2.0, 0.0]\nmax_m = 2.1"), "`wall.max_m` has the wrong type");
    one(&wall("min_m = [2.0, 0.0]\nmaxi_m = [2.1, 3.0]"), "unknown key `maxi_m`");
    one(&room(&good.replace("radius_m = 0.2", "radius_m = \"0.2\"")), "`robot.radius_m` has the wrong type");
    // The patrol has no wall only because the wall is misread.
    let along = "kind = \"wall_patrol\"\nfrom_m = [1.0, 1.0]\nto_m = [1.0, 2.0]\nspeed_mps = 0.3\nwall_side = \"right\"";
    let patrol = room(&good.replace("kind = \"standing\"", along));
    assert_eq!(firsts(&patrol), [] as [&str; 0]);
    one(&patrol.replace("[[wall]]", "[[walls]]"), "unknown key `walls`");
    one(&patrol.replace("[2.1, 3.0]", "true"), "`wall.max_m` has the wrong type");
    // Nothing in the laser is missing if there is none to look into.
    let laser = "[robot.laser]\nbeams = 360\nrange_max_m = 10.0\nrate_hz = 10.0\n";
    let good = room(&good);
    one(&good.replace(laser, ""), "the key `laser` is missing");
    let number = good.replace(laser, "").replace("radius_m = 0.2", "radius_m = 0.2\nlaser = 1");
    one(&number, "`robot.laser` has the wrong type");
    one(&TWO_BLOCKS.replacen("dwell =", "dwel =", 1), "unknown key `dwel`");
    one(&TWO_BLOCKS.replacen("name = \"", "name = 5 #", 1), "`name` has the wrong type");
}

#[test]
fn of_many_errors_the_first_are_shown_and_the_rest_are_counted() {
    let keys: String = (0..100_000).map(|i| format!("k{i:05} = 1\n")).collect();
    let walls = "[[wall]]\nmin_m = 5\n".repeat(50_000);
    for (text, more) in [(keys.as_str(), 99_982), (&room(&walls), 49_980)] {
        let messages = messages(text);
        assert_eq!(messages.len(), 21);
        assert_eq!(messages[20], format!("… and {more} more errors"));
    }
}

#[test]
fn a_name_that_is_not_printable_is_refused() {
    let robot = robot("a\\u001b[2Jb\\nc", "pose_m = [1.0, 1.0]");
    assert_eq!(firsts(&room(&robot)), ["`robot.name` has a character that is not printable"]);
    let map = room("").replace("\"room\"", "\"a\\tb\"");
    assert_eq!(firsts(&map), ["`name` has a character that is not printable"]);
}

#[test]
fn a_text_that_is_not_toml_is_refused_with_the_words_of_the_parser() {
    let cases = [
        "name = ",
        "name",
        "name = \"a\nb = 1",
        "name = \"\\ud8\"",
        "a = [1, 2",
        "a = {b}",
        "a = 1 b = 2",
        "[map",
        "a = 1\na.b = 2",
        "a = 1__0",
        "a = 1 # \u{1}",
        "a = 1\r",
        "\0",
        &"a = ".to_owned().add(&"[".repeat(100_000)),
        &"a = ".to_owned().add(&"{a = ".repeat(100_000)),
        &"a.".repeat(100_000).add("a = 1"),
        &format!("[{}a]", "a.".repeat(100_000)),
    ];
    for text in cases {
        let first = &firsts(text)[0];
        assert!(first.starts_with("this is not valid TOML: "), "{:?}: {first}", &text[..text.len().min(30)]);
    }
}

/// In keys, values, comments and names of files.
#[test]
fn no_message_has_a_character_that_is_not_printable() {
    let texts = [
        "\"a\\u001b[2J\\nerror: forged\" = 1 # \u{9b}2J\u{85}",
        "name = \"a\\u001b\\u009b\"\n[map]\nsize_m = \"\\n\\u001b]0;x\\u0007\" # \u{9b}2J",
        "physics = { step_s = 'a' } # \u{202e}\u{2028}",
        "wall = 1\r\n\u{1b}[2J",
        "[[floor_plan]]\nimage = \"\\u001b[2J\\n\"\npixel_m = 1.0",
    ];
    for text in texts {
        let error = crate::physics::parse_fleet("a\u{1b}[2J\nerror: b.toml", text).unwrap_err();
        for message in error.findings().messages(Severity::Error) {
            let is_safe = |line: &str| line.chars().all(interfaces::is_printable);
            assert!(message.lines().all(is_safe), "{message:?}");
            assert!(message.lines().skip(1).all(|line| !line.starts_with("error: ")), "{message}");
        }
    }
    let long = format!("name = 1\nphysics = {{ {} = 1 }}", "k".repeat(1_000_000));
    assert!(crate::physics::parse_fleet("w.toml", &long).unwrap_err().to_string().len() < 20_000);
}

#[test]
fn a_file_with_too_many_things_is_refused_before_they_are_compared() {
    let boxes = "[[obstacle]]\nname = \"b\"\nkind = \"box\"\n".repeat(10_001);
    assert_eq!(firsts(&room(&boxes)), ["there are 10001 tables `[[obstacle]]`"]);
}

/// Has every error that a value can have.
const ALL_WRONG: &str = r#"name = ""
wall = [{ from_m = [0.0, 0.0], to_m = [20.0, 0.0], thickness_m = -1.0 }]
map = { size_m = [10.0, -4.0], cell_m = 100.0 }
physics = { step_s = 7.0 }
[[obstacle]]
name = "o"
kind = "box"
min_m = [1.0, 1.0]
max_m = [0.0, 0.0]
mass_kg = -3
friction = 100
[[obstacle]]
name = "o"
kind = "boxx"
[[robot]]
name = "a"
radius_m = 100.0
pose_m = [1.0, 1.0]
heading_deg = 1000.0
behavior = { kind = "wander", speed_mps = 100.0 }
drive = { max_linear_mps = -0.5, max_angular_degps = 90.0, max_linear_acceleration_mps2 = -1.0, max_angular_acceleration_degps2 = 360.0 }
laser = { beams = 0, range_max_m = -5.0, rate_hz = 0.0 }
bumper = { sectors = 0 }
"#;

#[test]
fn every_invalid_value_is_reported() {
    insta::assert_snapshot!(messages(ALL_WRONG).join("\n\n"));
}

#[test]
fn an_invalid_value_causes_no_other_error() {
    let one = |text: &str, first: &str| assert_eq!(firsts(text), [first], "{text}");
    let along = "kind = \"wall_patrol\"\nfrom_m = [1.0, 1.0]\nto_m = [1.0, 2.0]\nspeed_mps = 0.3\nwall_side = \"right\"";
    let patrol = room(&robot("a", "pose_m = [1.0, 1.0]").replace("kind = \"standing\"", along));
    assert_eq!(firsts(&patrol), [] as [&str; 0]);
    let but = |from: &str, to: &str, first: &str| one(&patrol.replace(from, to), first);
    // A way without a wall, a robot beside its way, things out of the map or too fast for it.
    but("max_m = [2.1, 3.0]", "max_m = [2.1, 9.0]", "`wall.max_m` is [2.1, 9], which is outside of the map");
    but("pose_m = [1.0", "pose_m = [9.0", "`robot.pose_m` is [9, 1], which is outside of the map");
    but("size_m = [4.0", "size_m = [-4.0", "`map.size_m` is [-4, 3], which is out of range");
    but("cell_m = 0.05", "cell_m = 0", "`map.cell_m` is 0, which is out of range");
    but("radius_m = 0.2", "radius_m = -0.2", "`robot.radius_m` is -0.2, which is out of range");
    but(
        "max_linear_mps = 0.5",
        "max_linear_mps = 0",
        "`robot.drive.max_linear_mps` is 0, which is out of range",
    );
    let step = format!("{patrol}[physics]\nstep_s = 0.3\n");
    one(&step, "`physics.step_s` is 0.3, which is out of range");
    // A course, a standing time and a path that are right without the rest.
    let grid = TWO_BLOCKS.replacen("dwell = 7", "dwell = 0\nstood = 3", 1).replacen(
        "map = \"\"\"",
        "map = \"\"\"\n?",
        1,
    );
    let expected = ["the rows of the map are not equally long", "`block.dwell` is 0, which is out of range"];
    assert_eq!(firsts(&grid), expected);
}

#[test]
fn many_invalid_values_are_counted() {
    let walls = "[[wall]]\nmin_m = [1.0, 1.0]\nmax_m = [0.0, 0.0]\n".repeat(20_000);
    let messages = messages(&room(&format!("{walls}[[robot]]\ncolour = 1\n")));
    assert_eq!(messages.len(), 21);
    // The robot has one key too many and lacks five.
    assert_eq!(messages[20], format!("… and {} more errors", 20_000 + 6 - 20));
}
