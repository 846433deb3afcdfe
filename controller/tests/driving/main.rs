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
fn it_goes_around_what_appears_and_waits_for_a_way_that_opens_again() {
    let beside = House::new(&DOOR).position() + nalgebra::Vector2::new(0.45, 0.1);
    for (place, half_m, appears_s, goes_s, is_reached) in [
        (House::at(8, 7), 0.2, 1.0, f64::INFINITY, true),
        (House::at(8, 7), 0.2, 4.5, f64::INFINITY, true),
        (House::at(18, 7), 0.2, 6.0, f64::INFINITY, true),
        // In the door, the box leaves too little room on both sides.
        (House::at(14, 7), 0.2, 3.0, f64::INFINITY, false),
        (House::at(13, 7), 0.3, 2.0, 6.0, true),
        // So near that the cell of the robot becomes lethal.
        (beside, 0.2, 0.0, f64::INFINITY, true),
    ] {
        let (mut house, mut controller) = (House::new(&DOOR), controller());
        house.movers = vec![Mover { appears_s, goes_s, ..Mover::new([place, place], half_m, 0.3) }];
        if appears_s == 0.0 {
            (0..20).for_each(|_| house.tick(&mut controller));
        }
        controller.set_goal(House::at(22, 7), Some(0.0));
        let outcome = house.run(&mut controller, 60.0);
        assert_eq!(outcome == Outcome::Reached, is_reached, "a box at {place} from {appears_s} s");
        assert_untouched(&house);
    }
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
    let cage =
        ["########", "#......#", "#......#", "#..R...#", "#......#", "########", "#......#", "########"];
    for (rows, goal, expected) in [
        (&["#####", "##R##", "#####"][..], House::at(0, 0), Outcome::GivenUp),
        (&["#####", "#.R.#", "#####"], House::at(0, 0), Outcome::GivenUp),
        (&cage, House::at(3, 1), Outcome::Nearest),
    ] {
        let (mut house, mut controller) = (House::new(rows), controller());
        controller.set_goal(goal, None);
        assert_eq!(house.run(&mut controller, 180.0), expected);
        assert!(expected == Outcome::GivenUp || house.contacts == 0);
    }
}

#[test]
fn local_exploration_ends_soon_where_nothing_changes() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    controller.set_goal(House::at(8, 7), None);
    let mut explored_s = 0.0;
    while controller.view().status != Status::Finished(Outcome::Reached) {
        house.tick(&mut controller);
        explored_s += if controller.view().status == Status::Exploring { 0.1 } else { 0.0 };
        assert!(house.time_s < 60.0);
    }
    // One random step.
    assert!(explored_s > 0.5 && explored_s < 7.0, "{explored_s} s");
    assert!(controller.view().path.is_empty());
}

#[test]
fn local_exploration_stays_with_what_moves_and_does_not_touch_it() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    house.movers =
        vec![Mover { yields_m: 0.3, ..Mover::new([House::at(23, 2), House::at(23, 11)], 0.2, 0.3) }];
    let (mut nearest_m, mut explored_s) = (f64::INFINITY, 0.0);
    controller.set_goal(House::at(18, 7), None);
    while !matches!(controller.view().status, Status::Finished(_)) {
        house.tick(&mut controller);
        if controller.view().status == Status::Exploring {
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
            match controller.view().status {
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
    let mut farthest_m = [0.0_f64; 2];
    while house.time_s < 132.0 {
        house.sense();
        let command = controller.pause(&house.input(), true);
        house.act(command);
        let farthest_m = &mut farthest_m[usize::from(house.time_s > 12.0)];
        *farthest_m = farthest_m.max((house.position() - start).norm());
    }
    let [turning_m, driving_m] = farthest_m;
    assert!(turning_m < 0.02, "it left its place while it turned, by {turning_m} m");
    assert!(driving_m > 1.0, "it stayed within {driving_m} m");
    assert_untouched(&house);
}

#[test]
fn a_goal_can_be_taken_back() {
    let (mut house, mut controller) = (House::new(&DOOR), controller());
    assert_eq!((controller.view().status, controller.view().goal), (Status::Idle, None));
    controller.set_goal(House::at(22, 7), None);
    (0..30).for_each(|_| house.tick(&mut controller));
    assert_eq!(
        (controller.view().status, controller.view().goal),
        (Status::Travelling, Some(House::at(22, 7)))
    );
    assert!(!controller.view().path.is_empty());
    controller.cancel();
    (0..20).for_each(|_| house.tick(&mut controller));
    let rested_at = house.position();
    (0..5).for_each(|_| house.tick(&mut controller));
    assert_eq!((controller.view().status, house.position()), (Status::Idle, rested_at));
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
        controller.view().path.last().copied().unwrap()
    };
    assert!((end(&mut controller) - goal).norm() < 0.1);
    controller.forget_map();
    assert!(end(&mut controller).x < House::at(13, 0).x);
    assert_eq!((controller.view().status, controller.view().goal), (Status::Travelling, Some(goal)));
}
