mod parts;

use crate::reader::tests::mutations;

/// A small world in which every line can be made wrong.
const GOOD: &str = r#"name = "closet"

[map]
size_m = [4.0, 3.0]
cell_m = 0.05

[[wall]]
min_m = [2.0, 0.0]
max_m = [2.1, 3.0]

[[obstacle]]
name = "toy"
min_m = [3.0, 2.0]
max_m = [3.4, 2.4]
appears_s = 10.0
disappears_s = 20.0

[[robot]]
name = "curious"
radius_m = 0.2
pose_m = [1.0, 1.0]

[robot.drive]
max_linear_mps = 0.5
max_angular_degps = 90.0
max_linear_acceleration_mps2 = 1.0
max_angular_acceleration_degps2 = 360.0

[robot.laser]
beams = 360
range_max_m = 10.0
rate_hz = 10.0

[robot.behavior]
kind = "driven"

[[robot]]
name = "dummy"
radius_m = 0.2
pose_m = [2.5, 0.5]

[robot.drive]
max_linear_mps = 0.5
max_angular_degps = 90.0
max_linear_acceleration_mps2 = 1.0
max_angular_acceleration_degps2 = 360.0

[robot.laser]
beams = 180
range_max_m = 5.0
rate_hz = 10.0

[robot.behavior]
kind = "wall_patrol"
from_m = [2.5, 0.5]
to_m = [2.5, 2.5]
speed_mps = 0.3
wall_side = "left"
"#;

/// The message for the good world with one part replaced.
fn error(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    match crate::physics::parse_world("closet.toml", &GOOD.replacen(from, to, 1)) {
        Ok(_) => "no error".to_owned(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn the_good_world_is_good() {
    let spec = crate::physics::parse_world("closet.toml", GOOD).unwrap();
    assert_eq!((spec.frame.width(), spec.frame.height()), (80, 60));
    assert_eq!(spec.driven().name, "curious");
    assert_eq!(spec.driven().laser.period_steps, 2);
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
            ("unknown key", "radius_m = 0.2", "raduis_m = 0.2"),
            ("unknown key far from any", "rate_hz = 10.0", "rate_hz = 10.0\ncolour = \"red\""),
            ("unknown table", "[map]", "[maps]"),
            ("missing key", "cell_m = 0.05\n", ""),
            ("missing key of a robot", "radius_m = 0.2\n", ""),
            ("wrong type", "cell_m = 0.05", "cell_m = \"small\""),
            ("a list of texts", "size_m = [4.0, 3.0]", "size_m = [4.0, \"three\"]"),
            ("wrong type of a pair", "size_m = [4.0, 3.0]", "size_m = 4.0"),
            ("too many numbers", "size_m = [4.0, 3.0]", "size_m = [4.0, 3.0, 2.0]"),
            ("a fraction of a beam", "beams = 360", "beams = 360.5"),
            ("table instead of list", "[[wall]]", "[wall]"),
            ("no toml", "[map]", "[map"),
            ("a key twice", "cell_m = 0.05", "cell_m = 0.05\ncell_m = 0.1"),
            ("empty name", "name = \"closet\"", "name = \"\""),
        ],
    );
}

#[test]
fn numbers() {
    compare(
        "numbers",
        &[
            ("negative beams", "beams = 360", "beams = -360"),
            ("too many beams", "beams = 360", "beams = 4000000000"),
            ("zero", "cell_m = 0.05", "cell_m = 0.0"),
            ("negative", "radius_m = 0.2", "radius_m = -0.2"),
            ("infinite", "range_max_m = 10.0", "range_max_m = inf"),
            ("not a number", "max_linear_mps = 0.5", "max_linear_mps = nan"),
            ("absurd", "size_m = [4.0, 3.0]", "size_m = [1e300, 3.0]"),
            ("too many cells", "size_m = [4.0, 3.0]", "size_m = [1000.0, 1000.0]"),
            ("infinite turn", "cell_m = 0.05", "cell_m = 0.05\nturn_deg = inf"),
            ("rate between steps", "rate_hz = 10.0", "rate_hz = 15.0"),
            ("rate above steps", "rate_hz = 10.0", "rate_hz = 50.0"),
        ],
    );
}

#[test]
fn walls_and_obstacles() {
    compare(
        "walls_and_obstacles",
        &[
            ("wall without shape", "max_m = [2.1, 3.0]", "to_m = [2.1, 3.0]"),
            ("wall upside down", "max_m = [2.1, 3.0]", "max_m = [1.9, 3.0]"),
            (
                "wall without length",
                "min_m = [2.0, 0.0]\nmax_m = [2.1, 3.0]",
                "from_m = [2.0, 1.0]\nto_m = [2.0, 1.0]\nthickness_m = 0.1",
            ),
            ("wall outside", "max_m = [2.1, 3.0]", "max_m = [2.1, 3.5]"),
            (
                "wall reaching out",
                "min_m = [2.0, 0.0]\nmax_m = [2.1, 3.0]",
                "from_m = [0.0, 3.0]\nto_m = [2.0, 3.0]\nthickness_m = 0.1",
            ),
            (
                "obstacles of one name",
                "[[obstacle]]",
                "[[obstacle]]\nname = \"toy\"\nmin_m = [0.0, 0.0]\nmax_m = [0.4, 0.4]\n\n[[obstacle]]",
            ),
            ("obstacle gone before it comes", "disappears_s = 20.0", "disappears_s = 5.0"),
            ("obstacle at no time", "appears_s = 10.0", "appears_s = -1.0"),
            ("obstacle in a wall", "min_m = [3.0, 2.0]", "min_m = [2.05, 2.0]"),
            (
                "obstacle outside",
                "min_m = [3.0, 2.0]\nmax_m = [3.4, 2.4]",
                "center_m = [3.9, 2.0]\nsize_m = [0.4, 0.4]\nheading_deg = 45.0",
            ),
            ("obstacle without shape", "min_m = [3.0, 2.0]\nmax_m", "min_m = [3.0, 2.0]\nsize_m"),
        ],
    );
}

#[test]
fn robots() {
    let all_robots = &GOOD[GOOD.find("[[robot]]").unwrap()..];
    compare(
        "robots",
        &[
            ("laser sees nothing", "range_max_m = 10.0", "range_min_m = 11.0\nrange_max_m = 10.0"),
            ("laser off the robot", "range_max_m = 10.0", "range_max_m = 10.0\nmount_m = [1.3, 0.0]"),
            ("robot in a wall", "pose_m = [1.0, 1.0]", "pose_m = [1.9, 1.0]"),
            (
                "robot in an obstacle",
                "appears_s = 10.0\ndisappears_s = 20.0",
                "\n[[obstacle]]\nname = \"box\"\nmin_m = [0.9, 0.9]\nmax_m = [1.1, 1.1]",
            ),
            ("robot outside", "pose_m = [1.0, 1.0]", "pose_m = [5.0, 1.0]"),
            ("robot reaching out", "pose_m = [1.0, 1.0]", "pose_m = [0.1, 1.0]"),
            ("robots overlap", "pose_m = [1.0, 1.0]", "pose_m = [2.6, 0.8]"),
            ("robots of one name", "name = \"dummy\"", "name = \"curious\""),
            (
                "no driven robot",
                "kind = \"driven\"",
                "kind = \"wall_patrol\"\nfrom_m = [1.0, 1.0]\nto_m = [1.0, 2.0]\nspeed_mps = 0.1\nwall_side = \"right\"",
            ),
            (
                "two driven robots",
                "kind = \"wall_patrol\"\nfrom_m = [2.5, 0.5]\nto_m = [2.5, 2.5]\nspeed_mps = 0.3\nwall_side = \"left\"",
                "kind = \"driven\"",
            ),
            ("driven robot with a patrol", "kind = \"driven\"", "kind = \"driven\"\nspeed_mps = 0.3"),
            ("unknown behavior", "kind = \"driven\"", "kind = \"dance\""),
            ("no robots", all_robots, ""),
        ],
    );
}

#[test]
fn patrols() {
    compare(
        "patrols",
        &[
            ("patrol incomplete", "to_m = [2.5, 2.5]\n", ""),
            ("patrol through a wall", "to_m = [2.5, 2.5]", "to_m = [1.0, 2.5]"),
            ("patrol without length", "to_m = [2.5, 2.5]", "to_m = [2.5, 0.5]"),
            ("patrol started elsewhere", "pose_m = [2.5, 0.5]", "pose_m = [3.5, 0.5]"),
            ("patrol without a wall", "wall_side = \"left\"", "wall_side = \"right\""),
            ("patrol aslant", "to_m = [2.5, 2.5]", "to_m = [2.8, 2.5]"),
            ("patrol on no side", "wall_side = \"left\"", "wall_side = \"top\""),
            ("patrol too fast", "speed_mps = 0.3", "speed_mps = 0.6"),
            ("patrol too near to its wall", "max_m = [2.1, 3.0]", "max_m = [2.27, 3.0]"),
        ],
    );
}

#[test]
fn behaviors() {
    let kind = "kind = \"driven\"";
    let drives = |keys: &str| format!("kind = {keys}");
    let waypoints = |keys: &str| format!("kind = \"waypoints\"\nspeed_mps = 0.3\n{keys}");
    let cases = [
        ("wander without a speed", drives("\"wander\"")),
        ("wander with a wall", drives("\"wander\"\nspeed_mps = 0.3\nwall_side = \"left\"")),
        ("wander too fast", drives("\"wander\"\nspeed_mps = 3.0")),
        ("circle too tight", drives("\"circle\"\nspeed_mps = 0.5\nturn_radius_m = 0.1")),
        ("circle to nowhere", drives("\"circle\"\nspeed_mps = 0.5\nturn_radius_m = 1.0\ndirection = \"up\"")),
        ("standing with a speed", drives("\"standing\"\nspeed_mps = 0.5")),
        ("waypoints without points", waypoints("points_m = []")),
        ("waypoints of three numbers", waypoints("points_m = [[1.0, 2.0, 3.0]]")),
        ("waypoints outside", waypoints("points_m = [[1.0, 2.0], [9.0, 2.0]]")),
        ("waypoints that coincide", waypoints("points_m = [[1.0, 2.0], [1.0, 2.0]]")),
        ("waypoints through a wall", waypoints("points_m = [[1.0, 2.0], [3.5, 1.5]]")),
        ("waypoints repeated oddly", waypoints("points_m = [[1.0, 2.0]]\nrepeat = \"often\"")),
    ];
    let cases: Vec<_> = cases.iter().map(|(case, to)| (*case, kind, to.as_str())).collect();
    compare("behaviors", &cases);
}

#[test]
fn a_fleet_may_have_any_number_of_driven_robots() {
    let standing = GOOD.replace("kind = \"driven\"", "kind = \"standing\"");
    assert!(crate::physics::parse_world("closet.toml", &standing).is_err());
    for text in [GOOD, &standing, &GOOD[..GOOD.find("[[robot]]").unwrap()]] {
        assert_eq!(crate::physics::parse_fleet("closet.toml", text).map(|_| ()), Ok(()));
    }
}

#[test]
fn missing_file() {
    let error = crate::physics::load_world("no/such/place.toml").unwrap_err();
    insta::assert_snapshot!(error, @"cannot read the world file `no/such/place.toml`: No such file or directory (os error 2)");
}

#[test]
fn a_file_is_called_by_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("closet.toml");
    std::fs::write(&path, GOOD.replace("0.05", "-1.0")).unwrap();
    let error = crate::physics::load_world(&path).unwrap_err().to_string();
    assert!(error.contains(&format!("{}:5:10", path.display())), "{error}");
    std::fs::write(&path, [0xff, 0xfe, 0x00]).unwrap();
    let error = crate::physics::load_world(&path).unwrap_err().to_string();
    assert!(error.contains("UTF-8"), "{error}");
}

proptest::proptest! {
    /// Whatever the text, there is an error with a place or a world, and never a panic.
    #[test]
    fn no_text_makes_it_panic(changed in mutations::changed(GOOD)) {
        if let Err(error) = crate::physics::parse_world("closet.toml", &changed) {
            proptest::prop_assert!(error.to_string().contains("closet.toml:"), "{error}");
        }
    }

    /// The same with numbers of every size in every place.
    #[test]
    fn no_number_makes_it_panic(changed in mutations::renumbered(GOOD, "-?1e(-?[0-2]?[0-9]?[0-9]|-?30[0-9]|-31[0-9])")) {
        if let Ok(spec) = crate::physics::parse_world("closet.toml", &changed) {
            let mut world = sim::physics::PhysicsWorld::new(&spec, 0);
            interfaces::World::act(&mut world, &interfaces::Twist { linear_mps: 1.0, angular_radps: 1.0 });
        }
    }
}
