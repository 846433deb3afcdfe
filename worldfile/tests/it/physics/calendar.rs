//! Worlds with a calendar: time passes in large steps, with the results of small ones.

use super::fleet::{DRIVEN, robot};
use super::*;
use proptest::prelude::*;

const HOUR_S: f64 = 3600.0;
const OFFICE: &str = include_str!("../../../../worlds/office_week.toml");

fn office() -> WorldSpec {
    parse(OFFICE)
}

/// Whether the door of the workshop is closed.
fn is_closed(world: &PhysicsWorld) -> bool {
    state_at(world, 1.95, 3.15) != TrueState::Free
}

/// The office, with a robot that starts in the workshop; its dock is in the corridor. People let it out, or not.
fn office_with_robot_in_room(is_let_out: bool) -> WorldSpec {
    let inside = OFFICE.replace("pose_m = [0.6, 4.2]", "pose_m = [2.0, 1.8]");
    let inside = inside.replace("battery_s = 300.0", "dock_m = [0.6, 4.2]\nbattery_s = 300.0");
    assert_ne!(inside, OFFICE);
    if is_let_out { parse(&inside) } else { parse(&inside.replace("waits_for_robots = true", "")) }
}

/// Lets the robot drive for some steps, so that it is elsewhere and has a velocity.
fn drive(world: &mut PhysicsWorld, seed: u64) {
    let angular_radps = (seed % 7) as f64 / 3.0 - 1.0;
    (0..40).for_each(|_| world.act(&Twist { linear_mps: 0.4, angular_radps }));
}

/// Lets time pass in steps of the laser, a scan at each.
fn small_steps(world: &mut PhysicsWorld, until_s: f64) {
    while world.time_s() < until_s - 1e-6 {
        world.act(&Twist::STOP);
    }
}

fn block_events(world: &PhysicsWorld) -> u64 {
    (0..world.spec().frame.len()).map(|index| u64::from(world.truth().block_events(index))).sum()
}

/// The state after a step, so that the changes of both are those of this step.
fn state(mut world: PhysicsWorld) -> Vec<u8> {
    world.act(&Twist::STOP);
    world.snapshot().into_bytes()
}

#[test]
fn a_dock_is_where_a_robot_can_be() {
    let with = |dock: &str| OFFICE.replace("[robot.patrol]\n", &format!("[robot.patrol]\ndock_m = {dock}\n"));
    let parse = |dock: &str| worldfile::physics::parse_world("office.toml", &with(dock));
    assert!(parse("[2.0, 2.0]").is_ok());
    let error = parse("[0.05, 2.0]").unwrap_err().to_string();
    assert!(error.contains("is in a wall or an obstacle") && error.contains("within 0.5 m"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn a_large_step_is_many_small_ones(
        seed in any::<u64>(),
        // Nights are long; in the hours of work, doors move.
        start_h in prop_oneof![Just(0.0), 7.0_f64..18.0],
        lengths_s in prop::collection::vec(0.1_f64..2500.0, 1..5),
        is_in_room in any::<bool>(),
    ) {
        let spec = if is_in_room { office_with_robot_in_room(true) } else { office() };
        let mut large = PhysicsWorld::new(&spec, seed);
        large.rest(start_h * HOUR_S);
        drive(&mut large, seed);
        let mut small = large.clone();
        for length_s in lengths_s {
            let until_s = large.time_s() + (length_s * 10.0).round() / 10.0;
            large.rest(until_s);
            small_steps(&mut small, until_s);
            prop_assert_eq!(large.time_s(), small.time_s());
            prop_assert_eq!(block_events(&large), block_events(&small));
            // What the robot sees then.
            prop_assert_eq!(large.clone().sense().scan, small.clone().sense().scan);
        }
        prop_assert!(state(large) == state(small));
    }
}

/// The door of the workshop is open at noon and closed at night, but for a robot that is still in the room.
#[test]
fn people_let_a_robot_out_before_they_close() {
    let at_night = |spec: &WorldSpec| {
        let closed = (0..8).filter(|seed| {
            let mut world = PhysicsWorld::new(spec, *seed);
            world.rest(23.0 * HOUR_S);
            is_closed(&world)
        });
        closed.count()
    };
    assert_eq!(at_night(&office_with_robot_in_room(true)), 0);
    assert_eq!(at_night(&office_with_robot_in_room(false)), 8);
    // A robot in the corridor keeps no door open; one that leaves the room does not either.
    assert_eq!(at_night(&office()), 8);
    let mut world = PhysicsWorld::new(&office_with_robot_in_room(true), 0);
    world.rest(22.0 * HOUR_S);
    assert!(!is_closed(&world));
    (0..19).for_each(|_| world.act(&Twist { linear_mps: 0.0, angular_radps: 0.8 }));
    (0..60).for_each(|_| world.act(&Twist { linear_mps: 0.4, angular_radps: 0.0 }));
    assert!(world.true_pose().translation.y > 3.4, "{}", world.true_pose());
    world.rest(23.0 * HOUR_S);
    assert!(is_closed(&world));
}

/// A place with an outer wall and others, and doors that close after ten minutes; after a quarter of an hour with a robot that
/// starts `at`, which doors are open.
fn open_doors(
    size: [f64; 2],
    walls: &[[f64; 4]],
    doors: &[[f64; 4]],
    at: [f64; 2],
    dock: [f64; 2],
) -> Vec<bool> {
    let [right, top] = size;
    let outer = [
        [0.0, 0.0, right, 0.1],
        [0.0, top - 0.1, right, top],
        [0.0, 0.1, 0.1, top - 0.1],
        [right - 0.1, 0.1, right, top - 0.1],
    ];
    let wall = |[left, bottom, right, top]: &[f64; 4]| wall([*left, *bottom], [*right, *top]);
    let walls: String = outer.iter().chain(walls).map(wall).collect();
    let door = |(index, [x, y, to_x, to_y]): (usize, &[f64; 4])| {
        format!(
            "[[obstacle]]\nname = \"{index}\"\nkind = \"hinged_door\"\nfrom_m = [{x:?}, {y:?}]\nto_m = [{to_x:?}, {to_y:?}]\n\
             thickness_m = 0.05\nwaits_for_robots = true\n[obstacle.schedule]\nhours = [\"Mon 8:00-24:00\"]\nfree_s = 1.0\n\
             blocked_s = 1e9\nquiet_free_s = 1e9\nquiet_blocked_s = 1.0\nstarts_blocked = false\n"
        )
    };
    let leaves: String = doors.iter().enumerate().map(door).collect();
    let text = format!(
        "name = \"doors\"\nstarts = \"Mon 7:50\"\n[map]\nsize_m = {size:?}\ncell_m = 0.05\n{walls}{leaves}{}\
         [robot.patrol]\nshare = 0.05\nbattery_s = 300.0\ndock_m = {dock:?}\n",
        robot("curious", at, 0.0, DRIVEN)
    );
    let mut world = PhysicsWorld::new(&parse(&text), 0);
    world.rest(900.0);
    let middle_is_free = |[x, y, to_x, to_y]: &[f64; 4]| {
        state_at(&world, (x + to_x) / 2.0, (y + to_y) / 2.0) == TrueState::Free
    };
    doors.iter().map(middle_is_free).collect()
}

/// A robot beside a room with its dock, from which two doors lead to it: the one on the way with fewer doors stays open, and only this one.
/// The second door may close, since the robot does not need it.
#[test]
fn a_dock_in_a_room_with_two_doors_is_reached_through_one_of_them() {
    // The dock is in the lower room, 0 to 8 m; above it are two rooms, with a door to the dock's each, and one between them.
    let walls = [
        [0.1, 3.0, 1.5, 3.1],
        [2.4, 3.0, 5.5, 3.1],
        [6.4, 3.0, 7.9, 3.1],
        [4.0, 3.1, 4.1, 4.0],
        [4.0, 4.9, 4.1, 5.9],
    ];
    // Left, right, between.
    let doors = [[1.5, 3.05, 2.4, 3.05], [5.5, 3.05, 6.4, 3.05], [4.05, 4.0, 4.05, 4.9]];
    let world = |at: [f64; 2]| open_doors([8.0, 6.0], &walls, &doors, at, [4.0, 1.5]);
    assert_eq!(world([4.0, 1.5]), [false; 3], "at the dock");
    assert_eq!(world([2.0, 4.5]), [true, false, false], "in the left room");
    assert_eq!(world([6.0, 4.5]), [false, true, false], "in the right room");
}

/// A closed leaf that leaves a gap too narrow for the robot closes the room.
#[test]
fn people_let_a_robot_out_although_the_leaf_leaves_a_gap() {
    let is_open = |gap_m: f64, is_inside: bool| {
        let walls = [[4.0, 0.1, 4.1, 1.5], [4.0, 2.5 + gap_m, 4.1, 3.9]];
        let at = if is_inside { [1.0, 1.0] } else { [6.0, 2.0] };
        open_doors([8.0, 4.0], &walls, &[[4.05, 1.5, 4.05, 2.5]], at, [6.0, 2.0])[0]
    };
    for gap_m in [0.0, 0.03, 0.05, 0.1, 0.2, 0.3] {
        assert!(is_open(gap_m, true), "a gap of {gap_m} m");
        assert!(!is_open(gap_m, false), "a gap of {gap_m} m, the robot at its dock");
    }
    // The robot needs no door.
    assert!(!is_open(0.6, true));
}

#[test]
fn a_week_goes_on_from_a_snapshot() {
    let spec = office();
    let mut world = PhysicsWorld::new(&spec, 3);
    world.rest(33.0 * HOUR_S);
    let bytes = world.snapshot().into_bytes();
    let mut restored = PhysicsWorld::new(&spec, 3);
    restored.restore(&bytes).unwrap();
    for world in [&mut world, &mut restored] {
        world.rest(90.0 * HOUR_S);
    }
    assert!(block_events(&world) > 1000);
    assert!(state(world) == state(restored));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// Steps of which no number is exactly the time of the end: `while world.time_s() < end_s { world.rest(end_s) }` ends.
    #[test]
    fn a_rest_gets_to_its_end(step_ms in 10_u32..100, hours in 1_u32..24) {
        let step_s = f64::from(step_ms) / 1000.0;
        let of_step = OFFICE.replace("rate_hz = 10.0", &format!("rate_hz = {:?}", 0.25 / step_s));
        let of_step = format!("{of_step}\n[physics]\nstep_s = {step_s:?}\n");
        let mut world = PhysicsWorld::new(&parse(&of_step), 0);
        let end_s = f64::from(hours) * HOUR_S / 2.0;
        world.rest(end_s);
        world.rest(end_s);
        prop_assert!(world.time_s() >= end_s && world.time_s() < end_s + 2.0 * step_s, "{} s", world.time_s());
    }
}
