//! The shipped example, from the file to robots that drive.

use super::{lab_files, read};
use crate::{Drive, load};
use sim::physics::{BehaviorSpec, Fleet, Form, Rectangle};
use std::path::Path;

#[test]
fn the_example_says_what_is_in_it() {
    let (world, findings) = read(Path::new("lab.world"), &lab_files());
    let world = world.unwrap_or_else(|| panic!("{findings}"));
    assert_eq!((world.name.as_str(), world.step_s), ("lab", 0.05));
    assert_eq!(world.files, ["lab.world", "rover.inc", "scanner.inc"]);
    let [plan, table] = world.walls.as_slice() else { panic!("{:?}", world.walls) };
    assert_eq!([&plan.name, &table.name, &table.place], ["lab", "table", "lab.world:35"]);
    // 160 × 120 pixels on 8 × 6 m, from the middle.
    let corners = plan.rectangles.iter().flat_map(Rectangle::corners).collect();
    let (low, high) = Form::Convex(corners).bounds();
    let half_m = nalgebra::Vector2::new(4.0, 3.0);
    assert!((low.coords + half_m).norm() < 1e-12 && (high.coords - half_m).norm() < 1e-12, "{low} {high}");
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
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../worlds/stage/lab.world");
    let (spec, findings) = load(Path::new(path), &worldfile::Disk);
    let spec = spec.unwrap_or_else(|| panic!("{findings}"));
    assert!(matches!(spec.robots[0].behavior, BehaviorSpec::Wander(_)));
    assert_eq!(spec.robots[1].behavior, BehaviorSpec::Driven);
    // The border of 1 cm lies in the walls of the plan: nothing reaches out.
    assert_eq!((spec.frame.width(), spec.frame.height()), (160, 120));
    let mut fleet = Fleet::new(&spec, 1);
    let start = fleet.robots().next().unwrap().pose;
    fleet.run_until(5.0, &mut ());
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
