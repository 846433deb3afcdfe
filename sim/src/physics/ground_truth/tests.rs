use super::*;
use crate::physics::{PhysicsWorld, WorldSpec};
use interfaces::{Twist, World};
use nalgebra::Vector2;

const TURNED: &str = include_str!("../../../../worlds/turned_house.toml");

/// A world of 0.8 m × 0.6 m in cells of 0.1 m, drawn below.
fn small() -> PhysicsGroundTruth {
    let frame = GridFrame::covering(Point2::origin(), 0.8, 0.6, 0.1).unwrap();
    let walls = [
        Rectangle::between(Point2::new(0.0, 0.0), Point2::new(0.8, 0.1)),
        Rectangle::between(Point2::new(0.55, 0.1), Point2::new(0.65, 0.6)),
    ];
    PhysicsGroundTruth::new(frame, &walls, &Point2::new(0.15, 0.35))
}

/// Row by row from the top: `#` blocked, `+` partly, `.` free.
fn drawn(truth: &PhysicsGroundTruth) -> Vec<String> {
    let letter = |state: &TrueState| match state {
        TrueState::Free => '.',
        TrueState::PartlyCovered => '+',
        TrueState::Blocked => '#',
    };
    truth.states().chunks(truth.frame().width()).rev().map(|row| row.iter().map(letter).collect()).collect()
}

#[test]
fn walls_block_cells_wholly_or_in_part() {
    let free = ".....++.";
    assert_eq!(drawn(&small()), [free, free, free, free, free, "########"]);
}

#[test]
fn what_can_be_seen_is_this_side_of_the_wall_and_has_a_free_side() {
    let truth = small();
    let seen = |x, y| truth.can_be_seen(Cell::new(x, y));
    assert!((0..5).all(|x| seen(x, 3)), "the room of the robot");
    assert!(!seen(5, 3) && !seen(6, 3), "partly covered");
    assert!(!seen(7, 3), "the other side of the wall");
    assert!((0..=5).all(|x| seen(x, 0)) && !seen(7, 0), "the surface of the bottom wall");
    assert!(!seen(-1, 3) && !seen(0, 6));
}

#[test]
fn a_disc_that_passes_blocks_every_cell_once() {
    let mut truth = small();
    let robot = Body::Robot(1);
    let (mut at, radius_m) = (Point2::new(0.1, 0.3), 0.2);
    let disc = |center| crate::physics::form::Form::Disc { center, radius_m };
    truth.move_robot(robot, None, &disc(at));
    truth.begin();
    assert_eq!(drawn(&truth)[1..5], ["+++..++.", "##+..++.", "##+..++.", "+++..++."]);
    // A wobble that uncovers a cell in part is not an event.
    for to in [0.11, 0.1, 0.18, 0.1, 0.35, 0.33, 0.35, 0.1] {
        let to = Point2::new(to, 0.3);
        truth.move_robot(robot, Some(&disc(at)), &disc(to));
        at = to;
    }
    let index = |x, y| truth.frame().index(Cell::new(x, y)).unwrap();
    // It stood on the first cell, left it in part only, and came back.
    assert_eq!(truth.block_events()[index(0, 3)], 1);
    assert_eq!(truth.block_events()[index(3, 3)], 1);
    assert_eq!(truth.block_events()[index(3, 4)], 0);
    assert_eq!(truth.movers()[index(3, 3)], Some(robot));
    assert_eq!(truth.movers()[index(7, 3)], None);
    assert_eq!(truth.states()[index(3, 3)], TrueState::Free);
}

#[test]
fn changes_lead_from_one_truth_to_the_next() {
    let mut world = PhysicsWorld::new(&WorldSpec::parse("t", TURNED).unwrap(), 0);
    let mut states = world.truth().states().to_vec();
    for _ in 0..3100 {
        world.act(&Twist::STOP);
        for change in world.truth().changes() {
            let index = world.truth().frame().index(change.cell).unwrap();
            assert_eq!(std::mem::replace(&mut states[index], change.after), change.before);
        }
        assert_eq!(states, world.truth().states());
    }
    assert_eq!(world.obstacle_events().len(), 1);
    assert!(world.truth().block_events().iter().any(|events| *events > 10));
}

/// Points spread over a cell; its border is left out, where slivers count as nothing.
fn samples(frame: &GridFrame, cell: Cell) -> impl Iterator<Item = Point2<f64>> {
    let (center, side_m) = (frame.center(cell), frame.resolution_m());
    let place = move |i: i32| (f64::from(i) / 12.0 - 0.5) * side_m * 0.995;
    (0..=12).flat_map(move |i| (0..=12).map(move |j| center + Vector2::new(place(i), place(j))))
}

#[test]
fn truth_is_what_sampled_points_say() {
    for text in [TURNED, include_str!("../../../../worlds/toy_on_the_floor.toml")] {
        let mut world = PhysicsWorld::new(&WorldSpec::parse("t", text).unwrap(), 0);
        for _ in 0..77 {
            world.act(&Twist::STOP);
        }
        let truth = world.truth();
        let boxes = world.spec().walls().iter().chain(
            world.spec().obstacles().iter().filter(|o| o.appears_s.is_none()).map(|obstacle| &obstacle.shape),
        );
        let boxes: Vec<_> = boxes.collect();
        let dummy = world.robots().nth(1).map(|robot| Point2::from(robot.pose.translation.vector)).unwrap();
        let (mut partly, mut blurred) = (0, 0);
        for (index, state) in truth.states().iter().enumerate() {
            let solid = |point: &Point2<f64>| {
                boxes.iter().any(|shape| shape.distance_m(point) == 0.0) || (point - dummy).norm() < 0.2
            };
            let (mut inside, mut count) = (0, 0);
            for point in samples(truth.frame(), truth.frame().cell(index)) {
                inside += usize::from(solid(&point));
                count += 1;
            }
            match state {
                TrueState::Free => assert_eq!(inside, 0, "cell {index}"),
                TrueState::Blocked => assert_eq!(inside, count, "cell {index}"),
                TrueState::PartlyCovered => {
                    partly += 1;
                    // A sliver may fall between the samples.
                    blurred += usize::from(inside == 0 || inside == count);
                }
            }
        }
        assert!(blurred * 10 <= partly, "{blurred} of {partly}");
    }
}

#[test]
fn of_an_askew_wall_the_inner_side_can_be_seen() {
    let world = PhysicsWorld::new(&WorldSpec::parse("t", TURNED).unwrap(), 0);
    let truth = world.truth();
    let (middle, back) = (Point2::new(6.0, 6.0), interfaces::rotation(-10.0_f64.to_radians()));
    let (mut free, mut blocked) = (0, 0);
    for index in 0..truth.frame().len() {
        let cell = truth.frame().cell(index);
        if truth.can_be_seen(cell) {
            // It is open, or open on a side that lies within the middle lines of the outer walls.
            let open = |cell: &Cell| truth.state(*cell).is_some_and(|state| state != TrueState::Blocked);
            let within = |cell: &Cell| {
                let at = middle + back * (truth.frame().center(*cell) - middle);
                (0.05..11.95).contains(&at.x) && (0.05..11.95).contains(&at.y)
            };
            let places = [cell].into_iter().chain(cell.neighbours4());
            assert!(places.into_iter().any(|place| open(&place) && within(&place)), "{cell:?}");
            match truth.state(cell) {
                Some(TrueState::Free) => free += 1,
                _ => blocked += 1,
            }
        }
    }
    // 12 m × 12 m less 67 m of walls with a fringe of partly covered cells on both sides.
    assert!((50_500..54_500).contains(&free), "{free}");
    // A wall of 2 cells covers 0.1/cos 10° − 0.05·tan 10° − 0.05 = 0.0428 m of a column wholly, on
    // average 0.855 cells: 67 m · cos 10° / 0.05 m columns have 1130, and corners a few more.
    assert!((1_050..1_250).contains(&blocked), "{blocked}");
}
