//! Walls from pictures, and worlds with such walls.

use super::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A room of 2 m × 1.5 m: walls of one pixel of 0.25 m, and a pillar.
const ROOM: &[u8] = b"P2 8 6 1
0 0 0 0 0 0 0 0
0 1 1 1 1 1 1 0
0 1 1 1 1 1 1 0
0 1 1 1 1 0 1 0
0 1 1 1 1 1 1 0
0 0 0 0 0 0 0 0 ";

const WORLD: &str = r#"name = "room"

[map]
size_m = [3.0, 3.0]
cell_m = 0.25

[[floor_plan]]
image = "room.pgm"
pixel_m = 0.25
corner_m = [0.5, 1.0]

[[robot]]
name = "curious"
radius_m = 0.1
pose_m = [1.125, 1.625]

[robot.drive]
max_linear_mps = 0.5
max_angular_degps = 90.0
max_linear_acceleration_mps2 = 1.0
max_angular_acceleration_degps2 = 360.0

[robot.laser]
beams = 4
range_max_m = 10.0
rate_hz = 10.0

[robot.behavior]
kind = "driven"
"#;

fn files() -> BTreeMap<PathBuf, Vec<u8>> {
    let yaml = "image: room.pgm\nresolution: 0.25\norigin: [-7.0, 3.0, 0.0]\nnegate: 0\noccupied_thresh: 0.6\n\
                free_thresh: 0.2\n";
    let misspelt = yaml.replace("negate: 0", "negat: 1");
    let all = [
        ("w/room.pgm", ROOM),
        ("w/room.yaml", yaml.as_bytes()),
        ("w/odd.yaml", &yaml.as_bytes()[..40]),
        ("w/misspelt.yaml", misspelt.as_bytes()),
    ];
    all.map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())).into()
}

fn parse(from: &str, to: &str) -> Result<FleetSpec, worldfile::WorldError> {
    assert!(WORLD.contains(from), "{from}");
    worldfile::physics::parse_fleet_with("w/room.toml", &WORLD.replacen(from, to, 1), &files())
}

#[test]
fn lasers_see_the_pixels() {
    for world in ["image = \"room.pgm\"\npixel_m = 0.25\ncorner_m", "map = \"room.yaml\"\ncorner_m"] {
        let spec =
            parse("image = \"room.pgm\"\npixel_m = 0.25\ncorner_m", world).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(spec.walls.len(), 5);
        let mut fleet = Fleet::new(&spec, 0);
        fleet.step(&mut ());
        let seen = &fleet.robot(0).unwrap().reading().unwrap().scan.ranges_m;
        // Back, right, ahead (the pillar), left: meters from [1.125, 1.625].
        let expected = [0.375, 0.375, 0.625, 0.625];
        assert!(seen.iter().zip(expected).all(|(range, right)| (range - right).abs() < 1e-5), "{seen:?}");
    }
}

#[test]
fn a_turned_plan_lies_about_its_corner() {
    let spec = parse("corner_m = [0.5, 1.0]", "corner_m = [2.875, 0.5]\nheading_deg = 90.0");
    let spec = spec.unwrap_or_else(|e| panic!("{e}"));
    let covers = |x: f64, y: f64| spec.walls.iter().any(|wall| wall.distance_m(&Point2::new(x, y)) == 0.0);
    // The pillar, sixth from the left and third from below: up, and to the left.
    assert!(covers(2.875 - 0.625, 0.5 + 1.375) && !covers(2.875 - 0.625, 0.5 + 1.1));
}

#[test]
fn bad_plans_have_their_place() {
    let cases = [
        ("no picture", "room.pgm", "hall.pgm"),
        ("no map", "image = \"room.pgm\"\npixel_m = 0.25", "map = \"hall.yaml\""),
        ("half a map", "image = \"room.pgm\"\npixel_m = 0.25", "map = \"odd.yaml\""),
        ("a misspelt key", "image = \"room.pgm\"\npixel_m = 0.25", "map = \"misspelt.yaml\""),
        ("not a picture", "room.pgm", "room.yaml"),
        ("a picture and a map", "pixel_m = 0.25", "pixel_m = 0.25\nmap = \"room.yaml\""),
        ("no size", "pixel_m = 0.25\n", ""),
        ("a large pixel", "pixel_m = 0.25", "pixel_m = 0.5"),
        ("a strange pixel", "pixel_m = 0.25", "pixel_m = inf"),
        ("a robot in a wall", "pose_m = [1.125, 1.625]", "pose_m = [1.8, 1.8]"),
    ];
    let said = |from, to| parse(from, to).map_or_else(|error| error.to_string(), |_| "no error".to_owned());
    let messages: String =
        cases.iter().map(|(case, from, to)| format!("# {case}\n\n{}\n\n", said(from, to))).collect();
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(messages) });
    assert!(
        worldfile::physics::parse_fleet("w/room.toml", WORLD)
            .unwrap_err()
            .to_string()
            .contains("no such file")
    );
}

/// Isolated pixels: each is a piece of wall.
#[test]
fn all_plans_together_may_be_too_ragged() {
    let row = |y: u32| if y.is_multiple_of(2) { [0xaa; 25] } else { [0; 25] };
    let picture: Vec<u8> = b"P4 200 200\n".iter().copied().chain((0..200).flat_map(row)).collect();
    let plan = "[[floor_plan]]\nimage = \"dots.pbm\"\npixel_m = 0.004\n";
    let plans = |count: usize| {
        let text = WORLD.replacen("[[floor_plan]]", &format!("{}[[floor_plan]]", plan.repeat(count)), 1);
        let mut files = files();
        files.insert(PathBuf::from("w/dots.pbm"), picture.clone());
        worldfile::physics::parse_fleet_with("w/room.toml", &text, &files)
    };
    assert!(plans(1).is_ok());
    let error = plans(4).unwrap_err().to_string();
    assert!(error.starts_with("the floor plans make 30000 pieces of wall together\n"), "{error}");
}
