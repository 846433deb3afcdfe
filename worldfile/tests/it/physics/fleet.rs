//! Many robots, each with its own behavior.

use super::specs::crowd;
use super::*;
use nalgebra::Isometry2;

const ROBOT: &str = "radius_m = 0.2\n[robot.drive]\nmax_linear_mps = 0.5\nmax_angular_degps = 120.0\n\
    max_linear_acceleration_mps2 = 1.0\nmax_angular_acceleration_degps2 = 360.0\n\
    [robot.laser]\nbeams = 90\nrange_max_m = 10.0\nrate_hz = 10.0\nnoise_std_m = 0.005\n";

pub(super) const DRIVEN: &str = "kind = \"driven\"";
pub(super) const STANDING: &str = "kind = \"standing\"";

/// A robot of the file.
pub(super) fn robot(name: &str, pose_m: [f64; 2], heading_deg: f64, behavior: &str) -> String {
    let place = format!("pose_m = {pose_m:?}\nheading_deg = {heading_deg:?}\n");
    format!("[[robot]]\nname = \"{name}\"\n{place}{ROBOT}[robot.behavior]\n{behavior}\n")
}

/// The house of the four rooms with these robots and no others.
pub(super) fn house(robots: &[String], more: &str) -> FleetSpec {
    let rooms = &FOUR_ROOMS[..FOUR_ROOMS.find("[[robot]]").unwrap()];
    parse_fleet(&format!("{rooms}\n{}\n{more}", robots.concat()))
}

/// No robot executes commands.
pub(super) fn nobody(robot: &RobotView<'_>, _: &LaserReading) -> Twist {
    panic!("robot {} is not driven", robot.name)
}

pub(super) fn pose(fleet: &Fleet, robot: usize) -> Isometry2<f64> {
    fleet.robot(robot).unwrap().pose
}

pub(super) fn at(fleet: &Fleet, robot: usize) -> Point2<f64> {
    pose(fleet, robot).translation.vector.into()
}

/// A hash of every bit of the poses and the readings of the robots.
pub(super) fn hash(fleet: &Fleet) -> u64 {
    let bits = |robot: RobotView<'_>| {
        let at = robot.pose.translation.vector;
        let pose = [at.x, at.y, robot.pose.rotation.im].map(f64::to_bits);
        let ranges_m = robot.reading().map(|reading| reading.scan.ranges_m.clone()).unwrap_or_default();
        pose.into_iter().chain(ranges_m.into_iter().map(|range_m| range_m.to_bits().into()))
    };
    crate::fnv(fleet.robots().flat_map(bits))
}

/// Half a minute of many robots, bit by bit. If this number changes, the robots, the rays or the physics have
/// changed: this must be intended.
#[test]
fn golden_hash_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut fleet = Fleet::new(&crowd(), 3);
        fleet.set_parallel_lasers(threads > 1);
        pool.install(|| fleet.run_until(30.0, &mut nobody));
        hash(&fleet)
    };
    assert_eq!([run(1), run(2), run(3)], [10_964_635_771_821_610_856; 3]);
}

#[test]
fn several_driven_robots_ask_the_controller_at_every_scan() {
    let robots = [robot("one", [2.0, 2.0], 0.0, DRIVEN), robot("two", [2.0, 4.0], 0.0, DRIVEN)];
    let mut fleet = Fleet::new(&house(&robots, ""), 0);
    let mut asked = Vec::new();
    fleet.run_until(1.0, &mut |robot: &RobotView<'_>, reading: &LaserReading| {
        asked.push((robot.index, (reading.time_s * 10.0).round() as i32));
        Twist { linear_mps: if robot.index == 0 { 0.5 } else { -0.2 }, angular_radps: 0.0 }
    });
    let expected: Vec<_> = (0..10).flat_map(|time| [(0, time), (1, time)]).collect();
    assert_eq!(asked, expected);
    assert!(at(&fleet, 0).x > 2.3 && at(&fleet, 1).x < 1.9);
}

#[test]
fn one_driven_robot_lives_alike_in_a_fleet_and_in_a_world() {
    let spec = four_rooms();
    let (mut world, mut fleet) = (PhysicsWorld::new(&spec, 1), Fleet::new(spec.fleet(), 1));
    let wanted = |time_s: f64| Twist { linear_mps: 0.4, angular_radps: libm::sin(time_s) };
    for _ in 0..300 {
        let reading = world.sense();
        let mut heard = None;
        fleet.run_until(fleet.time_s() + 0.1, &mut |_: &RobotView<'_>, reading: &LaserReading| {
            heard = Some(reading.clone());
            wanted(reading.time_s)
        });
        assert_eq!(heard.as_ref(), Some(&reading));
        world.act(&wanted(reading.time_s));
    }
    for (one, other) in world.fleet().robots().zip(fleet.robots()) {
        assert_eq!((one.pose, one.twist, one.name), (other.pose, other.twist, other.name));
    }
}

#[test]
fn a_robot_against_a_wall_is_stalled_and_one_that_stands_is_not() {
    let robots = [robot("one", [0.5, 2.0], 180.0, DRIVEN), robot("two", [3.0, 3.0], 0.0, STANDING)];
    let mut fleet = Fleet::new(&house(&robots, ""), 0);
    let mut contacts = Vec::new();
    while fleet.time_s() < 3.0 {
        fleet.step(&mut always(0.5, 0.0));
        contacts.extend_from_slice(fleet.contacts());
    }
    let stalled: Vec<bool> = fleet.robots().map(|robot| robot.is_stalled).collect();
    assert_eq!(stalled, [true, false]);
    // The mass is π·0.04 kg, and the robot was at full speed.
    let impulse_ns = contacts[0].impulse_ns;
    assert!((impulse_ns - 0.5 * 0.04 * std::f64::consts::PI).abs() < 1e-3, "{impulse_ns}");
    assert_eq!((contacts.len(), contacts[0].robot), (1, 0));
    assert_eq!((contacts[0].with, contacts[0].moving), (Body::Wall(2), true));
}

#[test]
fn a_heavy_robot_pushes_a_light_one_away() {
    // Both robots drive toward each other.
    let mass = |robot: String, mass_kg: f64| {
        robot.replace("radius_m = 0.2", &format!("radius_m = 0.2\nmass_kg = {mass_kg:?}"))
    };
    for (masses_kg, pushed) in [([100.0, 1.0], 1.0), ([1.0, 100.0], -1.0)] {
        let robots = [robot("one", [2.0, 2.0], 0.0, DRIVEN), robot("two", [3.0, 2.0], 180.0, DRIVEN)];
        let robots: Vec<_> = robots.into_iter().zip(masses_kg).map(|(robot, kg)| mass(robot, kg)).collect();
        let mut fleet = Fleet::new(&house(&robots, ""), 0);
        fleet.run_until(3.0, &mut always(0.3, 0.0));
        let middle_m = (at(&fleet, 0).x + at(&fleet, 1).x) / 2.0 - 2.5;
        assert!(middle_m * pushed > 0.1, "{middle_m}");
    }
}

#[test]
fn a_robot_is_set_down_where_there_is_room() {
    let robots = [robot("one", [2.0, 2.0], 0.0, DRIVEN), robot("two", [4.0, 4.0], 0.0, STANDING)];
    let mut fleet = Fleet::new(&house(&robots, ""), 0);
    fleet.run_until(1.0, &mut always(0.5, 0.0));
    let before = fleet.snapshot();
    for (robot, x, y) in
        [(0, 4.0, 3.7), (0, 6.0, 1.0), (0, 0.1, 2.0), (0, -3.0, 2.0), (0, f64::NAN, 2.0), (2, 3.0, 3.0)]
    {
        assert!(fleet.teleport(robot, &interfaces::pose(x, y, 0.0)).is_err(), "{robot} to {x}, {y}");
    }
    assert_eq!(
        fleet.teleport(0, &interfaces::pose(3.0, 3.0, f64::NAN)),
        Err(TeleportError::Outside { x_m: 3.0, y_m: 3.0 })
    );
    assert_eq!(fleet.snapshot(), before);
    assert_eq!(fleet.teleport(0, &interfaces::pose(9.0, 9.0, 1.0)), Ok(()));
    fleet.run_until(1.05, &mut ());
    let pose = pose(&fleet, 0);
    let reading = fleet.robot(0).unwrap().reading().unwrap();
    assert!((pose.translation.vector - nalgebra::Vector2::new(9.0, 9.0)).norm() < 1e-6);
    assert!((interfaces::heading_rad(&pose) - 1.0).abs() < 1e-6);
    assert!((reading.pose.translation.x - 9.0).abs() < 1e-6);
    assert_eq!(fleet.contacts(), []);
}

#[test]
fn contacts_are_those_since_the_run_began_and_commands_are_heard_at_any_step() {
    let robots = [robot("one", [5.0, 2.0], 0.0, DRIVEN), robot("two", [2.0, 4.0], 0.0, STANDING)];
    let mut fleet = Fleet::new(&house(&robots, ""), 0);
    fleet.step(&mut ());
    // Between two scans.
    assert!(fleet.command(0, Twist { linear_mps: 0.5, angular_radps: 0.0 }));
    fleet.step(&mut ());
    assert!(fleet.robots().next().unwrap().twist.linear_mps > 0.01);
    assert!(!fleet.command(1, Twist::STOP) && !fleet.command(2, Twist::STOP));
    fleet.run_until(5.0, &mut ());
    assert_eq!(fleet.contacts().len(), 1);
    assert!(fleet.contacts()[0].time_s < 3.0);
    fleet.run_until(6.0, &mut ());
    assert_eq!(fleet.contacts(), []);
}
