//! What Stage's words mean, by numbers.

use super::{fleet, good, one};
use crate::Bounds;
use nalgebra::Point2;
use sim::physics::Rectangle;
use std::f64::consts::FRAC_PI_2;

fn rectangle(min: [f64; 2], max: [f64; 2]) -> Rectangle {
    Rectangle::between(min.into(), max.into())
}

fn assert_walls(text: &str, expected: &[Rectangle]) {
    let world = good(text);
    let found: Vec<Rectangle> = world.walls.iter().flat_map(|wall| wall.rectangles.clone()).collect();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().zip(expected) {
        let (a, b) = (a.bounds(), b.bounds());
        assert!((a.0 - b.0).norm() < 1e-9 && (a.1 - b.1).norm() < 1e-9, "{a:?} is not {b:?}");
    }
}

#[test]
fn a_box_a_size_an_origin() {
    assert_walls("model( )", &[rectangle([-0.05, -0.05], [0.05, 0.05])]);
    assert_walls("model( size [2 1 1] pose [3 4 0 90] )", &[rectangle([2.5, 3.0], [3.5, 5.0])]);
    // The origin moves the body about the pose, and turns with it.
    assert_walls(
        "model( size [2 1 1] pose [3 4 0 90] origin [1 0 0 0] )",
        &[rectangle([2.5, 4.0], [3.5, 6.0])],
    );
    assert_walls(
        "unit_length \"cm\" unit_angle \"radians\" model( size [200 100 1] pose [0 0 0 1.5707963267948966] )",
        &[rectangle([-0.5, -1.0], [0.5, 1.0])],
    );
}

#[test]
fn things_on_things() {
    let text = "model( size [2 2 1] pose [10 0 0 90] model( pose [1 0 0 0] size [1 0.5 1] ) )";
    assert_walls(text, &[rectangle([9.0, -1.0], [11.0, 1.0]), rectangle([9.75, 0.5], [10.25, 1.5])]);
}

#[test]
fn blocks_fill_the_size_together() {
    // Two blocks on 4 × 2, scaled to 2 × 4 about their common middle.
    let text = "model( size [2 4 1]
        block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 2] point[3] [0 2] z [0 1] )
        block( points 4 point[0] [3 0] point[1] [4 0] point[2] [4 1] point[3] [3 1] z [0 1] ) )";
    assert_walls(text, &[rectangle([-1.0, -2.0], [-0.5, 2.0]), rectangle([0.5, -2.0], [1.0, 0.0])]);
}

#[test]
fn dark_pixels_fill_the_size_and_a_boundary_goes_around() {
    // 4 × 2 dark pixels in a larger picture, without the upper left one.
    let body = [rectangle([-2.0, -1.0], [2.0, 0.0]), rectangle([-1.0, -1.0], [2.0, 1.0])];
    assert_walls("model( size [4 2 1] bitmap \"p.png\" )", &body);
    let text = "model( size [4 2 1] bitmap \"p.png\" boundary 1 )";
    let world = good(text);
    let covers =
        |x: f64, y: f64| world.walls[0].rectangles.iter().any(|r| r.distance_m(&Point2::new(x, y)) == 0.0);
    assert!(covers(-1.995, 0.9) && covers(-1.5, 0.995) && !covers(-1.98, 0.9));
}

#[test]
fn definitions_are_written_out() {
    let text = "define slab model( size [1 1 1] origin [0.5 0 0 0] )
        define long slab( size [4 1 1] slab( pose [0 5 0 0] ) )
        long( name \"a\" pose [0 0 0 0] model( name \"on\" pose [0 -5 0 0] ) )
        define slab model( size [9 9 1] )
        define slab slab( size [8 8 1] )
        slab( name \"b\" pose [50 0 0 0] )";
    let world = good(text);
    let names: Vec<&str> = world.walls.iter().map(|wall| wall.name.as_str()).collect();
    assert_eq!(names, ["a", "model:0", "on", "b"]);
    assert_eq!(world.walls[0].rectangles[0].pose.translation.x, 0.5);
    assert_eq!(world.walls[1].rectangles[0].half_m.x, 0.5);
    // As in Stage, the first definition holds, and one of itself later on does no harm.
    assert_eq!(world.walls[3].rectangles[0].half_m.x, 0.5);
}

#[test]
fn what_a_robot_has_when_nothing_is_said() {
    let world = good("position( size [0.4 0.4 0.2] )");
    let robot = &world.robots[0];
    assert_eq!(robot.name, "position:0");
    assert_eq!(robot.velocity, Bounds { x: [-1.0, 1.0], y: [-1.0, 1.0], turn: [-FRAC_PI_2, FRAC_PI_2] });
    assert_eq!((robot.acceleration, robot.lasers.len()), (None, 0));
    assert_eq!(robot.odometry, Default::default());
}

#[test]
fn lasers_old_and_new() {
    let text = "interval_sim 20 position( size [0.4 0.4 0.2] pose [1 1 0 90]
        laser( pose [0.1 0 0 180] range_min 0.2 range_max 4 fov 270 samples 271 update_interval 40 )
        ranger( pose [0 0.1 0 0] origin [0.05 0 0 0] sensor( pose [0.01 0 0 90] samples 5 )
          sensor( samples 9 fov 360 range [0.1 2] ) ) )";
    let (world, findings) = one(text);
    let world = world.unwrap();
    let [old, first, second] = world.robots[0].lasers.as_slice() else { panic!() };
    assert_eq!((old.beams, old.range_m, old.interval_ms), (271, [0.2, 4.0], 40));
    assert!((old.mount.rotation.angle().abs() - std::f64::consts::PI).abs() < 1e-12);
    assert!((first.mount.translation.vector - nalgebra::Vector2::new(0.06, 0.1)).norm() < 1e-12);
    // Stage's own sensor: 0.1 rad, 5 m.
    assert_eq!((first.beams, first.fov_rad, first.range_m[1]), (5, 0.1, 5.0));
    // Stage's nine are 45° apart, the first and the last of them the same.
    assert_eq!((second.beams, second.fov_rad), (8, std::f64::consts::TAU));
    // A step that both 40 and 100 ms are multiples of.
    assert!((world.step_s - 0.02).abs() < 1e-12);
    assert!(findings.iter().any(|finding| finding.what == "a laser sees all around"));
}

#[test]
fn single_rays_are_sonars_and_count_for_the_step() {
    let text = "interval_sim 20 position( size [0.4 0.4 0.2]
        ranger( update_interval 40 sensor( pose [0.1 0 0 90] range [0.2 3] fov 20 noise [0.01 0 0] ) ) )";
    let world = good(text);
    let [sonar] = world.robots[0].sonars.as_slice() else { panic!() };
    assert!((sonar.fov_rad - 20.0_f64.to_radians()).abs() < 1e-12);
    assert!((sonar.mount.rotation.angle() - FRAC_PI_2).abs() < 1e-12);
    assert_eq!((sonar.range_m, sonar.interval_ms), ([0.2, 3.0], 40));
    // The laser that it is given scans every 100 ms.
    assert!((world.step_s - 0.02).abs() < 1e-12 && world.robots[0].lasers.is_empty());
}

#[test]
fn bodies_become_convex_outlines() {
    // It turns about a point 0.1 m behind its middle.
    let world = good("position( size [0.6 0.4 0.2] origin [0.1 0 0 0] laser( ) )");
    let outline: Vec<[f64; 2]> = world.robots[0].outline.iter().map(|corner| (*corner).into()).collect();
    let expected = [[-0.2, -0.2], [0.4, -0.2], [0.4, 0.2], [-0.2, 0.2]];
    assert_eq!(outline.len(), 4);
    let is_there =
        |at: &[f64; 2]| outline.iter().any(|corner| (0..2).all(|i| (at[i] - corner[i]).abs() < 1e-9));
    assert!(expected.iter().all(is_there), "{outline:?}");
    // A long robot starts beside a wall, where its disc would not have room.
    let (spec, findings) =
        fleet("model( size [4 0.1 1] pose [0 0.3 0 0] )\nposition( size [1 0.4 1] laser( ) )");
    assert_eq!((spec.robots[0].corners.len(), findings.warnings()), (4, 0), "{findings}");
    // An L of three quarters of a square; its hull has seven eighths.
    let (world, findings) = one("position( size [2 2 1] origin [0.2 0.2 0 0] laser( ) block( points 6
        point[0] [0 0] point[1] [2 0] point[2] [2 1] point[3] [1 1] point[4] [1 2] point[5] [0 2] ) )");
    assert_eq!(world.unwrap().robots[0].outline.len(), 5);
    assert!(findings.iter().any(|finding| finding.what.ends_with("not convex: here it covers 17 % more")));
}

#[test]
fn fast_small_robots_have_short_steps() {
    let text = "position( size [0.06 0.08 0.2] velocity_bounds [-2 2 0 0 0 0 -90 90] laser( ) )";
    // Its outline holds 0.03 m about its middle: at 2 m/s that is 15 ms, and a hair less.
    assert!((good(text).step_s - 0.1 / 7.0).abs() < 1e-12);
}

#[test]
fn sensors_sense_in_steps_of_stage() {
    let (world, findings) = one("position( size [0.4 0.4 0.2] laser( update_interval 33 ) )
        interval_sim 30 position( size [0.4 0.4 0.2] pose [1 0 0 0] laser( update_interval 90 ) laser( ) )");
    let intervals_ms =
        world.unwrap().robots.into_iter().flat_map(|robot| robot.lasers).map(|l| l.interval_ms);
    assert_eq!(intervals_ms.collect::<Vec<_>>(), [60, 90, 120]);
    let warnings = findings.iter().filter(|finding| finding.what.ends_with("Stage's step, which is 30 ms"));
    assert_eq!(warnings.count(), 2);
}

#[test]
fn a_world_is_moved_and_says_by_how_much() {
    let (spec, findings) = fleet("position( size [0.4 0.4 1] pose [3 -4 0 90] laser( ) )");
    let at = spec.robots[0].pose.translation.vector;
    assert!((at - nalgebra::Vector2::new(0.2, 0.2)).norm() < 1e-9, "{at}");
    insta::assert_snapshot!(findings, @"
    note: x.world: [0, 0] of the world that runs is [2.8, -4.2] of this file
      = help: it is the lower left corner of all that is there; headings are as in the file
    ");
}

#[test]
fn a_sensor_far_off_its_robot_is_moved_back() {
    let (spec, findings) =
        fleet("position( size [0.6 0.8 1] laser( pose [3 4 0 90] ) ranger( pose [-1 0 0 0] sensor( ) ) )");
    let robot = &spec.robots[0];
    assert!((robot.laser.mount.translation.vector - nalgebra::Vector2::new(0.9, 1.2)).norm() < 1e-6);
    assert!((robot.laser.mount.rotation.angle() - FRAC_PI_2).abs() < 1e-9);
    assert!((robot.sonars[0].mount.translation.vector.x + 1.0).abs() < 1e-6);
    let moved: Vec<&str> =
        findings.iter().map(|f| f.what.as_str()).filter(|what| what.contains("mounted")).collect();
    assert_eq!(moved, ["a laser of `position:0` is mounted 4.500 m off its robot"]);
}

#[test]
fn long_turned_walls_are_as_thick_as_their_shorter_side() {
    let (spec, _) = fleet("model( size [1 300 1] pose [0 0 0 30] )");
    let sides = 2.0 * spec.walls[0].half_m;
    assert!((sides - nalgebra::Vector2::new(300.0, 1.0)).norm() < 1e-6, "{sides}");
}

#[test]
fn models_that_neither_collide_nor_are_seen_are_left_out() {
    assert!(good("model( obstacle_return 0 ranger_return -1 )").walls.is_empty());
    let (world, findings) = one("model( obstacle_return 0 )");
    assert_eq!((world.unwrap().walls.len(), findings.warnings()), (1, 1));
    // What has no body is no half a ghost, as the sonars of Stage's pioneer.
    let text = "position( size [0.4 0.4 0.2] laser( obstacle_return 0 ) )";
    assert_eq!(one(text).1.to_string(), "");
}

#[test]
fn includes_lie_beside_the_world_or_beside_each_other() {
    let files: [(&str, &str); 4] = [
        ("w/a.world", "include \"inc/b.inc\"\nsome( )"),
        ("w/inc/b.inc", "include \"c.inc\" # at the end of a line\ninclude \"../w/inc/d.inc\""),
        ("w/inc/c.inc", "define some model( size [3 3 1] )"),
        ("w/inc/d.inc", "name \"four files\""),
    ];
    // c.inc is not beside the world, but beside b.inc.
    let files = super::table(&files.map(|(name, text)| (name, text.as_bytes())));
    let (world, findings) = super::read(std::path::Path::new("w/a.world"), &files);
    let world = world.unwrap_or_else(|| panic!("{findings}"));
    assert_eq!((world.name.as_str(), world.walls.len(), world.files.len()), ("four files", 1, 4));
}
