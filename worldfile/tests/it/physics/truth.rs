//! The ground truth of whole worlds.

use super::*;
use interfaces::{Cell, GridFrame};
use nalgebra::Vector2;

/// The states of all cells, by index.
fn states(truth: &impl GroundTruth) -> Vec<TrueState> {
    (0..truth.frame().len()).map(|index| truth.state(index)).collect()
}

const TURNED: &str = include_str!("../../../../worlds/turned_house.toml");

#[test]
fn changes_lead_from_one_truth_to_the_next() {
    let mut world = PhysicsWorld::new(&parse(TURNED), 0);
    let mut expected = states(world.truth());
    let mut passes = vec![0; expected.len()];
    for _ in 0..3100 {
        world.act(&Twist::STOP);
        for change in world.truth().changes() {
            let index = world.truth().frame().index(change.cell).unwrap();
            assert_eq!(std::mem::replace(&mut expected[index], change.after), change.before);
            passes[index] += u32::from(change.before == TrueState::Free);
        }
        assert_eq!(states(world.truth()), expected);
    }
    assert_eq!(world.obstacle_events().len(), 1);
    let truth = world.truth();
    assert!((0..truth.frame().len()).any(|index| truth.block_events(index) > 10));
    let counted = |index: usize| truth.pass_events(index) == passes[index].max(truth.block_events(index));
    assert!((0..passes.len()).all(counted));
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
        let mut world = PhysicsWorld::new(&parse(text), 0);
        for _ in 0..77 {
            world.act(&Twist::STOP);
        }
        let truth = world.truth();
        let standing = world.spec().obstacles.iter().filter(|obstacle| obstacle.appears_s.is_none());
        let boxes: Vec<_> =
            world.spec().walls.iter().chain(standing.map(|obstacle| &obstacle.shape)).collect();
        let dummy = super::fleet::at(world.fleet(), 1);
        let (mut partly, mut blurred) = (0, 0);
        for (index, state) in states(truth).into_iter().enumerate() {
            let solid = |point: &Point2<f64>| {
                boxes.iter().any(|shape| shape.distance_m(point) == 0.0) || (point - dummy).norm() < 0.2
            };
            let points: Vec<_> = samples(truth.frame(), truth.frame().cell(index)).collect();
            let (inside, count) = (points.iter().filter(|point| solid(point)).count(), points.len());
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
    let world = PhysicsWorld::new(&parse(TURNED), 0);
    let truth = world.truth();
    let (middle, back) = (Point2::new(6.0, 6.0), interfaces::rotation(-10.0_f64.to_radians()));
    let (mut free, mut blocked) = (0, 0);
    for index in 0..truth.frame().len() {
        let cell = truth.frame().cell(index);
        if truth.can_be_seen(index) {
            // It is open, or open on a side that lies within the middle lines of the outer walls.
            let state = |cell: &Cell| truth.frame().index(*cell).map(|index| truth.state(index));
            let open = |cell: &Cell| state(cell).is_some_and(|state| state != TrueState::Blocked);
            let within = |cell: &Cell| {
                let at = middle + back * (truth.frame().center(*cell) - middle);
                (0.05..11.95).contains(&at.x) && (0.05..11.95).contains(&at.y)
            };
            let places = [cell].into_iter().chain(cell.neighbours4());
            assert!(places.into_iter().any(|place| open(&place) && within(&place)), "{cell:?}");
            match truth.state(index) {
                TrueState::Free => free += 1,
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
