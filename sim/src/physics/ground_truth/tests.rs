use super::*;

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
    truth.states.chunks(truth.frame().width()).rev().map(|row| row.iter().map(letter).collect()).collect()
}

#[test]
fn what_can_be_seen_is_this_side_of_the_wall_and_has_a_free_side() {
    let truth = small();
    let index = |x, y| truth.frame().index(Cell::new(x, y));
    let seen = |x, y| index(x, y).is_some_and(|index| truth.can_be_seen(index));
    assert!((0..5).all(|x| seen(x, 3)), "the room of the robot");
    assert!(!seen(5, 3) && !seen(6, 3), "partly covered");
    assert!(!seen(7, 3), "the other side of the wall");
    assert!((0..=5).all(|x| seen(x, 0)) && !seen(7, 0), "the surface of the bottom wall");
    assert!(!seen(-1, 3) && !seen(0, 6));
}

#[test]
fn a_thin_thing_passes_cells_that_it_never_covers_completely() {
    let mut truth = small();
    let leaf = |x_m: f64| Rectangle::between(Point2::new(x_m, 0.2), Point2::new(x_m + 0.05, 0.3));
    truth.change_box(&leaf(0.1), &[leaf(0.1)], Some(Body::Obstacle(0)));
    truth.begin();
    for (from, to) in [(0.1, 0.22), (0.22, 0.32), (0.32, 0.22)] {
        truth.move_box(&leaf(from), &leaf(to), &[leaf(to)], Body::Obstacle(0));
    }
    let events = |x| {
        let index = truth.frame().index(Cell::new(x, 2)).unwrap();
        [truth.block_events(index), truth.pass_events(index)]
    };
    assert_eq!([1, 2, 3, 4].map(events), [[0, 0], [0, 2], [0, 1], [0, 0]]);
}

#[test]
fn a_disc_that_passes_blocks_every_cell_once() {
    let mut truth = small();
    let robot = Body::Robot(1);
    let (at, radius_m) = (Point2::new(0.1, 0.3), 0.2);
    let disc = |center| crate::physics::form::Form::Disc { center, radius_m };
    truth.move_robot(1, &disc(at));
    truth.begin();
    assert_eq!(drawn(&truth)[1..5], ["+++..++.", "##+..++.", "##+..++.", "+++..++."]);
    // A motion that uncovers a cell only partly is not an event.
    for to in [0.11, 0.1, 0.18, 0.1, 0.35, 0.33, 0.35, 0.1] {
        truth.move_robot(1, &disc(Point2::new(to, 0.3)));
    }
    let index = |x, y| truth.frame().index(Cell::new(x, y)).unwrap();
    // The robot was on the first cell, left it only partly, and returned.
    assert_eq!(truth.block_events(index(0, 3)), 1);
    assert_eq!(truth.block_events(index(3, 3)), 1);
    assert_eq!([truth.block_events(index(3, 4)), truth.pass_events(index(3, 4))], [0, 2]);
    assert_eq!(truth.mover(index(3, 3)), Some(robot));
    assert_eq!(truth.mover(index(7, 3)), None);
    assert_eq!(truth.state(index(3, 3)), TrueState::Free);
}
