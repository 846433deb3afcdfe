//! The shipped example, from the file to robots that drive.

use super::{lab_files, read};
use crate::{Drive, load};
use interfaces::Twist;
use sim::physics::{BehaviorSpec, Fleet, Rectangle};
use std::path::Path;

#[test]
fn the_example_says_what_is_in_it() {
    let (world, findings) = read(Path::new("lab.world"), &lab_files());
    let world = world.unwrap_or_else(|| panic!("{findings}"));
    assert_eq!((world.name.as_str(), world.step_s, world.quit_time_s), ("lab", 0.05, Some(600.0)));
    assert_eq!(world.files, ["lab.world", "rover.inc", "scanner.inc"]);
    let [plan, table] = world.walls.as_slice() else { panic!("{:?}", world.walls) };
    assert_eq!(
        (plan.name.as_str(), table.name.as_str(), table.place.as_str()),
        ("lab", "table", "lab.world:35")
    );
    // 160 × 120 pixels on 8 × 6 m, from the middle.
    let corners = || plan.rectangles.iter().flat_map(Rectangle::corners);
    let low = corners().fold([f64::MAX; 2], |low, corner| [low[0].min(corner.x), low[1].min(corner.y)]);
    let high = corners().fold([f64::MIN; 2], |high, corner| [high[0].max(corner.x), high[1].max(corner.y)]);
    let is_off = |(side_m, half_m): (f64, f64)| (side_m.abs() - half_m).abs() > 1e-12;
    assert!(
        ![(low[0], 4.0), (low[1], 3.0), (high[0], 4.0), (high[1], 3.0)].into_iter().any(is_off),
        "{low:?} {high:?}"
    );
    assert_eq!(table.rectangles.len(), 8);

    let [r0, r1] = world.robots.as_slice() else { panic!() };
    assert_eq!((r0.name.as_str(), r1.name.as_str()), ("r0", "r1"));
    assert_eq!((r0.drive, r0.mass_kg), (Drive::Differential, Some(12.0)));
    assert_eq!((r0.velocity.x, r0.acceleration.unwrap().x), ([-0.6, 0.6], [-1.0, 1.0]));
    // 0.25 m ahead of the point that it turns about, 0.15 m to the side.
    assert!((r0.radius_m() - 0.25_f64.hypot(0.15)).abs() < 1e-12);
    assert_eq!(r1.odometry.distance_gain, 0.02);
    assert_eq!((r0.outline.len(), r0.sonars.len()), (4, 3));
    let [laser] = r0.lasers.as_slice() else { panic!() };
    assert_eq!((laser.beams, laser.interval_ms, laser.range_m[1]), (361, 100, 6.0));
    assert!((laser.mount.translation.vector.x - 0.1).abs() < 1e-12);
    assert!((laser.noise_std_m - 0.01 / 3.0_f64.sqrt()).abs() < 1e-12);
    insta::assert_snapshot!(findings);
}

#[test]
fn the_example_runs() {
    let (spec, findings) = load(Path::new("lab.world"), &lab_files());
    let spec = spec.unwrap_or_else(|| panic!("{findings}"));
    assert!(matches!(spec.robots[0].behavior, BehaviorSpec::Wander(_)));
    assert_eq!(spec.robots[1].behavior, BehaviorSpec::Driven);
    // The border of 1 cm lies in the walls of the plan: nothing reaches out.
    assert_eq!((spec.frame.width(), spec.frame.height()), (160, 120));
    let mut fleet = Fleet::new(&spec, 1);
    let start = fleet.robots().next().unwrap().pose;
    let twist = Twist { linear_mps: 0.3, angular_radps: 0.0 };
    fleet.run_until(5.0, &mut |_: &sim::physics::RobotView<'_>, _: &interfaces::LaserReading| twist);
    let moved = fleet.robots().next().unwrap().pose.translation.vector - start.translation.vector;
    assert!(moved.norm() > 0.2, "{moved}");
}

/// The made file is a world file of its own.
#[test]
fn the_example_as_toml() {
    let (world, _) = read(Path::new("lab.world"), &lab_files());
    let toml = world.unwrap().to_toml();
    let robots = &toml[toml.find("[[robot]]").unwrap()..];
    let head = &toml[..toml.find("[[wall]]").unwrap()];
    insta::assert_snapshot!(format!("{head}…\n\n{robots}"));
}

#[test]
fn the_example_runs_from_disk() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../worlds/stage/lab.world");
    let (spec, findings) = load(std::path::Path::new(path), &worldfile::Disk);
    assert_eq!(spec.unwrap_or_else(|| panic!("{findings}")).robots.len(), 2);
}
