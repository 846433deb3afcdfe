//! The controller in a closed loop: it reaches every goal, touches nothing, and always finishes.

mod grid;
mod house;

use controller::{ControlInput, Controller, DiffDrive, Driver, Outcome, Status};
use house::{House, Mover, controller};
use interfaces::{CellState, Purpose, RandomStream};
use nalgebra::Point2;
use rand::RngExt;

/// Four rooms of 3 m, joined by doors 1 m wide.
const ROOMS: [&str; 26] = [
    "##########################",
    "#...........##...........#",
    "#...........##...........#",
    "#...........##...........#",
    "#........................#",
    "#........................#",
    "#........................#",
    "#........................#",
    "#...........##...........#",
    "#...........##...........#",
    "#...........##...........#",
    "#...........##...........#",
    "####....##########....####",
    "####....##########....####",
    "#...........##...........#",
    "#...........##...........#",
    "#...........##...........#",
    "#...........##...........#",
    "#........................#",
    "#........................#",
    "#........................#",
    "#........................#",
    "#...........##...........#",
    "#...R.......##...........#",
    "#...........##...........#",
    "##########################",
];

/// Two rooms joined by a door 1 m wide, 2 m from the lower wall.
const DOOR: [&str; 14] = [
    "############################",
    "#............#.............#",
    "#............#.............#",
    "#............#.............#",
    "#..........................#",
    "#..........................#",
    "#..R.......................#",
    "#..........................#",
    "#............#.............#",
    "#............#.............#",
    "#............#.............#",
    "#............#.............#",
    "#............#.............#",
    "############################",
];

fn assert_untouched(house: &House) {
    assert_eq!(house.contacts, 0, "came within {} m", house.nearest_m);
}

#[test]
fn it_gets_everywhere_and_touches_nothing() {
    let (mut house, mut controller) = (House::new(&ROOMS), controller());
    let mut rng = RandomStream::new(1, Purpose::Controller);
    for _ in 0..60 {
        let goal = Point2::new(rng.random_range(0.3..6.2), rng.random_range(0.3..6.2));
        controller.set_goal(goal, Some(0.0));
        match house.run(&mut controller, 60.0) {
            Outcome::Reached => assert!((house.position() - goal).norm() <= 0.1),
            // No point in this house is farther from the center of a room or a door.
            Outcome::Nearest => assert!((house.position() - goal).norm() <= 0.9),
            Outcome::GivenUp => panic!("gave up {goal} at {}", house.position()),
        }
    }
    assert_untouched(&house);
}

#[test]
fn it_goes_through_the_middle_of_a_door() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    controller.set_goal(House::at(22, 7), Some(0.0));
    assert_eq!(house.run(&mut controller, 30.0), Outcome::Reached);
    assert!(house.nearest_m > 0.2, "came within {} m", house.nearest_m);
}

#[test]
fn it_goes_around_what_appears_on_its_path() {
    for (along, appears_s) in [(8, 1.0), (8, 4.5), (14, 3.0), (18, 6.0)] {
        let (mut house, mut controller) = (House::new(&DOOR), controller());
        let place = House::at(along, 7);
        house.movers = vec![Mover { appears_s, ..Mover::new([place, place], 0.2, 0.3) }];
        controller.set_goal(House::at(22, 7), Some(0.0));
        let outcome = house.run(&mut controller, 60.0);
        // In the door, the box leaves too little room on both sides.
        assert_eq!(outcome == Outcome::Reached, along != 14, "a box at {place}");
        assert_untouched(&house);
    }
}

#[test]
fn it_waits_for_a_way_that_opens_again() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    let place = House::at(13, 7);
    house.movers = vec![Mover { appears_s: 2.0, goes_s: 6.0, ..Mover::new([place, place], 0.3, 0.3) }];
    controller.set_goal(House::at(22, 7), Some(0.0));
    assert_eq!(house.run(&mut controller, 60.0), Outcome::Reached);
    assert_untouched(&house);
}

#[test]
fn it_gets_past_a_box_that_goes_back_and_forth_across_the_door() {
    for phase in 0..6 {
        let (mut house, mut controller) = (House::new(&DOOR), controller());
        let between = [House::at(15, 2), House::at(15, 11)];
        house.movers = vec![Mover::new(between, 0.2, 0.3)];
        for _ in 0..phase * 20 {
            house.tick(&mut controller);
        }
        for goal in [House::at(22, 7), House::at(4, 3), House::at(22, 3)] {
            controller.set_goal(goal, Some(0.0));
            assert_eq!(house.run(&mut controller, 120.0), Outcome::Reached, "phase {phase}, {goal}");
        }
        assert_untouched(&house);
    }
}

#[test]
fn goals_in_walls_outside_and_behind_walls_end_as_near_as_can_be() {
    let rows = [
        "####################",
        "#........#####.....#",
        "#........#...#.....#",
        "#........#...#.....#",
        "#........#...#.....#",
        "#........#####.....#",
        "#..................#",
        "#..................#",
        "#..R...............#",
        "#..................#",
        "####################",
    ];
    for (goal, at_most_m) in [
        (House::at(11, 7), 1.06),
        (House::at(0, 5), 0.5),
        (Point2::new(-3.0, 1.0), 3.7),
        (Point2::new(9.0, 9.0), 9.0),
    ] {
        let (mut house, mut controller) = (House::new(&rows), controller());
        controller.set_goal(goal, Some(0.0));
        assert_eq!(house.run(&mut controller, 60.0), Outcome::Nearest);
        assert!((house.position() - goal).norm() < at_most_m, "{goal} {}", house.position());
        assert_untouched(&house);
    }
}

#[test]
fn a_trapped_robot_comes_to_an_end() {
    // By the map there is no room for the robot to stand; and a cage with some room.
    for rows in [["#####", "##R##", "#####"], ["#####", "#.R.#", "#####"]] {
        let (mut house, mut controller) = (House::new(&rows), controller());
        controller.set_goal(House::at(0, 0), None);
        assert_eq!(house.run(&mut controller, 180.0), Outcome::GivenUp);
    }
    let cage =
        ["########", "#......#", "#......#", "#..R...#", "#......#", "########", "#......#", "########"];
    let (mut house, mut controller) = (House::new(&cage), controller());
    controller.set_goal(House::at(3, 1), None);
    assert_eq!(house.run(&mut controller, 180.0), Outcome::Nearest);
    assert_untouched(&house);
}

#[test]
fn a_robot_shut_in_gets_out_when_it_can() {
    // A box appears so near that the cell of the robot becomes lethal.
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    let place = house.position() + nalgebra::Vector2::new(0.45, 0.1);
    house.movers = vec![Mover::new([place, place], 0.2, 0.3)];
    (0..20).for_each(|_| house.tick(&mut controller));
    controller.set_goal(House::at(22, 7), Some(0.0));
    assert_eq!(house.run(&mut controller, 60.0), Outcome::Reached);
    assert_untouched(&house);
}

#[test]
fn local_exploration_ends_soon_where_nothing_changes() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    controller.set_goal(House::at(8, 7), None);
    let mut explored_s = 0.0;
    loop {
        house.tick(&mut controller);
        match controller.status() {
            Status::Exploring => explored_s += 0.1,
            Status::Finished(outcome) => break assert_eq!(outcome, Outcome::Reached),
            _ => {}
        }
    }
    // One random step.
    assert!(explored_s > 0.5 && explored_s < 7.0, "{explored_s} s");
    assert!(controller.path().is_empty());
}

#[test]
fn local_exploration_stays_with_what_moves_and_does_not_touch_it() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    house.movers =
        vec![Mover { yields_m: 0.3, ..Mover::new([House::at(23, 2), House::at(23, 11)], 0.2, 0.3) }];
    let (mut nearest_m, mut explored_s) = (f64::INFINITY, 0.0);
    controller.set_goal(House::at(18, 7), None);
    while !matches!(controller.status(), Status::Finished(_)) {
        house.tick(&mut controller);
        if controller.status() == Status::Exploring {
            explored_s += 0.1;
            let mover = House::at(23, 7);
            nearest_m = nearest_m.min((house.position().x - mover.x).abs());
        }
        assert!(house.time_s < 400.0);
    }
    assert!(explored_s > 10.0, "{explored_s} s");
    assert!(nearest_m < 1.0, "{nearest_m} m");
    assert_untouched(&house);
}

#[test]
fn it_lives_with_another_robot() {
    let (mut goals, mut given_up) = (0, 0);
    for seed in 0..3 {
        let (mut house, mut controller) = (House::new(&ROOMS), controller());
        house.movers = vec![
            Mover { yields_m: 0.3, ..Mover::new([House::at(15, 23), House::at(23, 23)], 0.2, 0.3) },
            Mover { yields_m: 0.3, ..Mover::new([House::at(19, 3), House::at(19, 22)], 0.2, 0.3) },
        ];
        let mut rng = RandomStream::new(seed, Purpose::Controller);
        while house.time_s < 600.0 {
            match controller.status() {
                Status::Travelling | Status::Exploring => {}
                status => {
                    goals += 1;
                    given_up += u32::from(status == Status::Finished(Outcome::GivenUp));
                    let x_m = rng.random_range(0.3..6.2);
                    controller.set_goal(Point2::new(x_m, rng.random_range(0.3..6.2)), None);
                }
            }
            house.tick(&mut controller);
        }
        assert_untouched(&house);
    }
    assert!(given_up * 50 <= goals, "{given_up} of {goals} goals given up");
    println!("{given_up} of {goals} goals given up");
}

#[test]
fn a_robot_that_looks_around_turns_once_then_looks_from_elsewhere() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    let start = house.position();
    let looks_for = |house: &mut House, controller: &mut controller::Controller<_>, seconds: f64| {
        let mut farthest_m: f64 = 0.0;
        let end_s = house.input().time + seconds;
        while house.input().time < end_s {
            house.sense();
            let command = controller.pause(&house.input(), true);
            house.act(command);
            farthest_m = farthest_m.max((house.position() - start).norm());
        }
        farthest_m
    };
    let turning_m = looks_for(&mut house, &mut controller, 12.0);
    assert!(turning_m < 0.02, "it left its place while it turned, by {turning_m} m");
    let driving_m = looks_for(&mut house, &mut controller, 120.0);
    assert!(driving_m > 1.0, "it stayed within {driving_m} m");
    assert_untouched(&house);
}

#[test]
fn the_same_again_is_the_same() {
    let drive = || {
        let (mut house, mut controller) = (House::new(&ROOMS), controller());
        house.movers = vec![Mover::new([House::at(15, 18), House::at(23, 18)], 0.2, 0.3)];
        let mut trace = Vec::new();
        for goal in [House::at(20, 20), House::at(5, 20), House::at(20, 4)] {
            controller.set_goal(goal, None);
            for _ in 0..300 {
                house.tick(&mut controller);
                trace.push([house.pose.translation.x.to_bits(), house.pose.rotation.im.to_bits()]);
            }
        }
        trace
    };
    assert!(drive() == drive());
}

#[test]
fn a_goal_can_be_taken_back() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    assert_eq!((controller.status(), controller.goal()), (Status::Idle, None));
    controller.set_goal(House::at(22, 7), None);
    (0..30).for_each(|_| house.tick(&mut controller));
    assert_eq!((controller.status(), controller.goal()), (Status::Travelling, Some(House::at(22, 7))));
    assert!(!controller.path().is_empty());
    controller.cancel();
    (0..20).for_each(|_| house.tick(&mut controller));
    let rested_at = house.position();
    (0..5).for_each(|_| house.tick(&mut controller));
    assert_eq!((controller.status(), house.position()), (Status::Idle, rested_at));
}

#[test]
fn a_map_that_was_replaced_is_read_again() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    let goal = House::at(22, 7);
    controller.set_goal(goal, Some(0.0));
    (0..20).for_each(|_| house.tick(&mut controller));
    // In the new map, the door is closed. No transition says so.
    let mut map = house.input().map.clone();
    let frame = *map.frame();
    let is_in_door = |cell| (House::at(13, 0).x - frame.center(cell).x).abs() < house::CHARACTER_M / 2.0;
    for index in (0..frame.len()).filter(|&index| is_in_door(frame.cell(index))) {
        map.cells_mut()[index] = CellState::Blocked;
    }
    let input = ControlInput { map: &map, transitions: &[], ..house.input() };
    let end = |controller: &mut Controller<DiffDrive>| {
        controller.drive(&input);
        controller.path().last().copied().unwrap()
    };
    assert!((end(&mut controller) - goal).norm() < 0.1);
    controller.forget_map();
    assert!(end(&mut controller).x < House::at(13, 0).x);
    assert_eq!((controller.status(), controller.goal()), (Status::Travelling, Some(goal)));
}
