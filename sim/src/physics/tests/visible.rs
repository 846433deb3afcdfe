//! The cells that the driven robot could see, against sampled poses and exact segments.

use super::specs;
use crate::physics::*;
use calendar::{Habit, Hours, Schedule, Stays};
use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};

const RADIUS_M: f64 = 0.2;

fn wall([left, bottom, right, top]: [f64; 4]) -> Rectangle {
    Rectangle::between(Point2::new(left, bottom), Point2::new(right, top))
}

/// The four rooms, with a closet without a door, a recess that is too narrow for the robot, and a room behind a closed
/// door.
fn house() -> WorldSpec {
    let mut fleet = specs::four_rooms();
    fleet.robots.pop();
    let closet = [[0.1, 4.0, 1.1, 4.1], [1.0, 4.1, 1.1, 5.95]];
    let recess = [[3.0, 0.1, 3.1, 1.5], [3.3, 0.1, 3.4, 1.5]];
    let behind_a_door = [[8.5, 5.95, 9.5, 6.05]];
    fleet.walls.extend(closet.into_iter().chain(recess).chain(behind_a_door).map(wall));
    let opening = Opening::Periodic { closed_s: 1000.0, open_s: 10.0 };
    let leaf = Leaf::Sliding { by_m: Vector2::new(0.0, -1.0) };
    let motion = Motion::Door(DoorSpec { leaf, opening, move_s: 1.0, starts_open: false });
    fleet.obstacles.push(ObstacleSpec::new("door", wall([5.975, 2.5, 6.025, 3.5]), motion));
    WorldSpec::new(fleet).unwrap()
}

#[test]
fn closed_rooms_stay_hidden_but_not_rooms_with_doors() {
    let spec = house();
    let visible = spec.visible_cells();
    let at = |x: f64, y: f64| visible[spec.frame.index(spec.frame.cell_at(&Point2::new(x, y))).unwrap()];
    assert!(!at(0.5, 5.0), "in the closet");
    assert!(at(1.125, 5.0) && at(1.075, 5.0) && !at(1.025, 5.0), "the closet from outside");
    assert!(at(3.2, 0.8) && at(3.2, 0.05), "the recess and its end: too narrow, but in sight");
    assert!(at(9.0, 3.0), "the room behind the door");
    assert!(at(6.0, 3.0), "the doorway");
    assert!(at(6.025, 1.0) && at(5.975, 1.0), "both surfaces of a wall");
    assert!(!at(0.05, 5.0), "the wall of the closet, which is seen from nowhere");
}

#[test]
fn nothing_is_seen_from_enclosed_cells() {
    let spec = house();
    let by_trying = |frame: &GridFrame, states: &[interfaces::TrueState], _: &[bool]| {
        assert_eq!(states.len(), frame.len());
        states.iter().map(|state| *state != interfaces::TrueState::Blocked).collect()
    };
    assert_eq!(spec.visible_cells(), spec.visible_cells_among(by_trying));
}

/// The poses at which the robot fits, 0.25 m apart. In this house all but those in the closet can be reached.
fn poses(spec: &WorldSpec, solids: &[Rectangle]) -> Vec<Point2<f64>> {
    let places = (0..48 * 48)
        .map(|i| Point2::new(0.125, 0.125) + Vector2::new(f64::from(i % 48), f64::from(i / 48)) * 0.25);
    let is_open = |at: &Point2<f64>| solids.iter().all(|solid| solid.distance_m(at) >= RADIUS_M);
    let in_closet = |at: &Point2<f64>| at.x < 1.0 && at.y > 4.0 && at.y < 6.0;
    assert_eq!(spec.driven().radius_m, RADIUS_M);
    places.filter(|at| is_open(at) && !in_closet(at)).collect()
}

#[test]
fn what_can_be_seen_is_what_some_pose_sees() {
    let spec = house();
    let (frame, visible): (&GridFrame, _) = (&spec.frame, spec.visible_cells());
    let mut solids = spec.walls.clone();
    solids.push(wall([5.975, 1.5, 6.025, 2.5])); // the open door
    let (poses, range_m) = (poses(&spec, &solids), spec.driven().laser.range_max_m);
    let is_clear = |from: &Point2<f64>, to: &Point2<f64>| {
        (from - to).norm() < range_m && solids.iter().all(|solid| solid.segment_distance_m(from, to) > 0.0)
    };
    let (mut compared, mut missed, mut unproved) = (0, 0, 0);
    // Every 47th cell, so that all columns take part.
    for cell in (0..frame.len()).step_by(47).map(|index| frame.cell(index)) {
        let center = frame.center(cell);
        if solids.iter().any(|solid| solid.distance_m(&center) < 0.05) {
            continue;
        }
        let is_seen = poses.iter().any(|pose| is_clear(pose, &center));
        let index = |cell: Cell| frame.index(cell).unwrap();
        compared += 1;
        missed += usize::from(is_seen && !visible[index(cell)]);
        unproved += usize::from(!is_seen && visible[index(cell)]);
    }
    assert!(compared > 1000, "{compared}");
    // The poses are coarse, and so are the directions.
    assert!(missed == 0 && unproved * 200 < compared, "{missed} missed, {unproved} unproved of {compared}");
}

/// A parked robot in the place of the driven one, which comes later, and a box that closes a doorway until it leaves: both go away
/// by themselves, as a block on a path does.
#[test]
fn a_thing_with_a_schedule_is_not_in_the_way() {
    let spec = house();
    for starts_blocked in [false, true] {
        let thing = |name: &str, at: [f64; 4]| {
            let stays = [Stays::of_mean(600.0); 2];
            let changes =
                calendar::Changes::Habit(Habit { hours: Hours::always(), active: stays, quiet: stays });
            let schedule = Schedule { changes, starts_blocked };
            ObstacleSpec::new(name, wall(at), Motion::Scheduled(Box::new(schedule)))
        };
        let mut fleet = spec.fleet().clone();
        let box_in_doorway = thing("box", [2.5, 5.95, 3.5, 6.05]);
        let parked = (!starts_blocked).then(|| thing("parked", [1.5, 1.5, 2.5, 2.5]));
        fleet.obstacles.extend(parked.into_iter().chain([box_in_doorway]));
        let with_things = WorldSpec::new(fleet).unwrap();
        let [here, there] = [&spec, &with_things].map(|spec| FreeSpace::new(spec, RADIUS_M));
        assert_eq!(here.regions(), there.regions());
        assert!(spec.visible_cells() == with_things.visible_cells());
    }
}
