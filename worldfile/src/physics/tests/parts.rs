//! The parts of robots, and things that move.

use super::*;

#[test]
fn things_that_move() {
    let toy = "name = \"toy\"\nmin_m = [3.0, 2.0]\nmax_m = [3.4, 2.4]\nappears_s = 10.0\ndisappears_s = 20.0";
    let block =
        "name = \"block\"\nkind = \"block\"\nsize_m = [0.4, 0.4]\npath_m = [[3.0, 2.0], [3.5, 2.0]]\n";
    let door = "name = \"door\"\nkind = \"hinged_door\"\nfrom_m = [3.0, 2.0]\nto_m = [3.8, 2.0]\nthickness_m = 0.04\n";
    let crate_ = "name = \"crate\"\nkind = \"box\"\nmin_m = [3.0, 2.0]\nmax_m = [3.4, 2.4]\n";
    let cases = [
        ("part of nothing", toy.replace("appears_s = 10.0\ndisappears_s = 20.0", "part_of = \"car\"")),
        ("part with times of its own", format!("{toy}\npart_of = \"car\"")),
        ("place of no thing", toy.replace("appears_s = 10.0\ndisappears_s = 20.0", "place = 2")),
        ("unknown kind", "name = \"toy\"\nkind = \"ball\"".to_owned()),
        ("key of another kind", format!("{toy}\nfriction = 0.5")),
        ("box without a mass", crate_.to_owned()),
        ("box without weight", format!("{crate_}mass_kg = 0.0")),
        ("thin box", format!("{crate_}mass_kg = 1.0").replace("[3.4, 2.4]", "[3.01, 2.4]")),
        (
            "box in a robot",
            format!("{crate_}mass_kg = 1.0")
                .replace("[3.0, 2.0]", "[2.6, 0.4]")
                .replace("[3.4, 2.4]", "[2.9, 0.7]"),
        ),
        (
            "boxes in each other",
            format!("{crate_}mass_kg = 1.0\n[[obstacle]]\n{}mass_kg = 1.0", crate_.replace("crate", "other")),
        ),
        ("block without a path", "name = \"block\"\nkind = \"block\"\nsize_m = [0.4, 0.4]".to_owned()),
        ("block without times", block.to_owned()),
        ("block through a wall", format!("{block}speed_mps = 1.0").replace("[3.5, 2.0]", "[1.0, 2.0]")),
        ("block out of the map", format!("{block}speed_mps = 1.0").replace("[3.5, 2.0]", "[3.9, 2.0]")),
        ("block too fast", format!("{block}speed_mps = 4.0")),
        ("block with too few times", format!("{block}times_s = [0.0]")),
        ("block that is late", format!("{block}times_s = [1.0, 2.0]")),
        ("block back in time", format!("{block}times_s = [0.0, 0.0]")),
        ("block in a hurry", format!("{block}times_s = [0.0, 0.1]\nrepeat = \"once\"")),
        ("block that is not back", format!("{block}times_s = [0.0, 1.0]")),
        ("door without an opening", door.to_owned()),
        ("door that opens oddly", format!("{door}opening = \"often\"")),
        ("random door with a script", format!("{door}opening = \"random\"\nswitches_s = [1.0]")),
        ("script back in time", format!("{door}opening = \"scripted\"\nswitches_s = [2.0, 1.0]")),
        ("door that slams", format!("{door}opening = \"scripted\"\nswitches_s = [2.0]\nmove_s = 0.1")),
        (
            "door without a leaf",
            format!("{door}opening = \"random\"\nclosed_s = 1.0\nopen_s = 1.0").replace("3.8", "3.0"),
        ),
    ];
    let cases: Vec<_> = cases.iter().map(|(case, to)| (*case, toy, to.as_str())).collect();
    compare("things_that_move", &cases);
}

#[test]
fn odometry() {
    let with = |keys: &str| format!("[robot.odometry]\n{keys}\n\n[robot.drive]");
    let cases = [
        ("wheels that slip backwards", with("slip = -0.5")),
        ("wheels that slip more than they turn", with("slip = 1.5")),
        ("slip that is no number", with("slip = nan")),
        ("jumps without a time", with("jump = { distance_m = 1.0 }")),
        ("jumps of nothing", with("jump = { every_s = 20.0 }")),
        ("jumps back", with("jump = { every_s = 20.0, distance_m = -1.0 }")),
        ("carried all the time", with("carried = { every_s = 0.0, distance_m = 1.0 }")),
        ("carried at no time", with("carried = { every_s = nan, distance_m = 1.0 }")),
        ("turned too far", with("carried = { every_s = 20.0, turn_deg = 270.0 }")),
        ("unknown key of a jump", with("jump = { every_s = 20.0, distance = 1.0 }")),
        ("not a table", with("jump = 3")),
    ];
    let cases: Vec<_> = cases.iter().map(|(case, to)| (*case, "[robot.drive]", to.as_str())).collect();
    compare("odometry", &cases);
}

#[test]
fn drives_and_lasers() {
    let drive = "max_linear_mps = 0.5";
    let with = |keys: &str| format!("{drive}\n{keys}");
    let laser = "[robot.laser]\nbeams = 360\nrange_max_m = 10.0\nrate_hz = 10.0";
    let drive_table = &GOOD[GOOD.find("[robot.drive]").unwrap()..GOOD.find("[robot.laser]").unwrap()];
    let both = format!("{drive_table}{laser}");
    let several = |keys: &str| laser.replace("[robot.laser]", "[[robot.laser]]") + keys;
    let cases = [
        ("unknown drive", drive, with("kind = \"hover\"")),
        ("diff drive that goes sideways", drive, with("max_left_mps = 0.5")),
        ("omni drive with a wheelbase", drive, with("kind = \"omni\"\nwheelbase_m = 0.5")),
        ("omni drive too fast at once", drive, with("kind = \"omni\"\nmax_left_mps = 3.99")),
        ("car without a wheelbase", drive, with("kind = \"car\"")),
        ("no laser", &both, format!("laser = []\n\n{drive_table}")),
        ("wrong key of the second laser", laser, several("\n[[robot.laser]]\nbeans = 3")),
        (
            "wrong number of the second laser",
            laser,
            several("\n[[robot.laser]]\nbeams = 1\nrange_max_m = 1.0\nrate_hz = 10.0"),
        ),
        ("no table of a laser", &both, format!("laser = 3\n\n{drive_table}")),
        ("dropout of more than all", "rate_hz = 10.0", "rate_hz = 10.0\ndropout = 1.5".to_owned()),
        ("sweep back in time", "rate_hz = 10.0", "rate_hz = 10.0\nsweep_s = -0.1".to_owned()),
        ("sweep that is no number", "rate_hz = 10.0", "rate_hz = 10.0\nsweep_s = nan".to_owned()),
        ("sweep longer than a scan", "rate_hz = 10.0", "rate_hz = 10.0\nsweep_s = 0.11".to_owned()),
    ];
    let cases: Vec<_> = cases.iter().map(|(case, from, to)| (*case, *from, to.as_str())).collect();
    compare("drives_and_lasers", &cases);
    let car = GOOD.replacen("max_linear_mps", "kind = \"car\"\nwheelbase_m = 0.3\nmax_linear_mps", 1);
    let wander = |kind: &str| car.replacen("kind = \"driven\"", kind, 1);
    let error =
        |text: String| crate::physics::parse_fleet("closet.toml", &text).map(|_| ()).unwrap_err().to_string();
    assert!(error(wander("kind = \"wander\"\nspeed_mps = 0.3")).contains("a car cannot be `wander`"));
    let tight = "kind = \"circle\"\nspeed_mps = 0.3\nturn_radius_m = 0.4";
    assert!(
        error(wander(tight)).contains("a circle has a radius of 0.520 m or more"),
        "{}",
        error(wander(tight))
    );
    assert!(crate::physics::parse_fleet("closet.toml", &car).is_ok());
}

#[test]
fn footprints() {
    let radius = "radius_m = 0.2";
    let corners = |corners: &str| format!("footprint_m = [{corners}]");
    let square = "[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]";
    let at = "radius_m = 0.2\npose_m = [1.0, 1.0]";
    let put = |pose: &str| format!("footprint_m = [{square}]\npose_m = {pose}");
    let cases = [
        ("no outline", radius, String::new()),
        ("two outlines", radius, format!("{radius}\n{}", corners(square))),
        ("two corners", radius, corners("[0.0, 0.0], [1.0, 1.0]")),
        ("not convex", radius, corners("[-0.2, -0.2], [0.2, -0.2], [-0.1, -0.1], [-0.2, 0.2]")),
        ("a star", radius, corners("[0.3, 0.0], [-0.24, 0.18], [0.09, -0.29], [0.09, 0.29], [-0.24, -0.18]")),
        ("beside itself", radius, corners("[0.1, -0.2], [0.5, -0.2], [0.5, 0.2], [0.1, 0.2]")),
        ("far corners", radius, corners("[-20.0, -0.2], [0.2, -0.2], [0.2, 0.2]")),
        ("footprint in a wall", at, put("[1.81, 1.0]")),
        ("footprint outside", at, put("[0.19, 1.0]")),
        ("footprint in a robot", at, put("[2.31, 0.5]")),
        ("footprint beside a wall", at, put("[1.8, 1.0]")),
    ];
    let cases: Vec<_> = cases.iter().map(|(case, from, to)| (*case, *from, to.as_str())).collect();
    compare("footprints", &cases);
}

#[test]
fn senses() {
    let at = "[robot.behavior]\nkind = \"driven\"";
    let with = |keys: &str| format!("{keys}\n\n{at}");
    let sonar = "[[robot.sonar]]\ncone_deg = 30.0\nrange_max_m = 3.0\nrate_hz = 10.0";
    let cases = [
        ("no bumpers", with("[robot.bumper]\nsectors = 0")),
        ("sonar that hears nothing", with(&format!("{sonar}\nrange_min_m = 3.0"))),
        ("sonar off the robot", with(&format!("{sonar}\nmount_m = [1.3, 0.0]"))),
        ("sonar between steps", with(&sonar.replace("10.0", "15.0"))),
        ("sonar as a table", with(&sonar.replace("[[robot.sonar]]", "[robot.sonar]"))),
    ];
    let cases: Vec<_> = cases.iter().map(|(case, to)| (*case, at, to.as_str())).collect();
    compare("senses", &cases);
}
