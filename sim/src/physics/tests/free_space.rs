//! Where a robot can drive in a world with doors, and with things that leave by themselves.

use super::specs;
use crate::physics::*;
use calendar::{Habit, Hours, Schedule, Stays};
use nalgebra::{Point2, Vector2};

const RADIUS_M: f64 = 0.2;

fn wall([left, bottom, right, top]: [f64; 4]) -> Rectangle {
    Rectangle::between(Point2::new(left, bottom), Point2::new(right, top))
}

/// The four rooms, with a closet without a door, and a room behind a closed door.
fn house() -> WorldSpec {
    let mut fleet = specs::four_rooms();
    fleet.robots.pop();
    let closet = [[0.1, 4.0, 1.1, 4.1], [1.0, 4.1, 1.1, 5.95]];
    let behind_a_door = [[8.5, 5.95, 9.5, 6.05]];
    fleet.walls.extend(closet.into_iter().chain(behind_a_door).map(wall));
    let opening = Opening::Periodic { closed_s: 1000.0, open_s: 10.0 };
    let leaf = Leaf::Sliding { by_m: Vector2::new(0.0, -1.0) };
    let motion = Motion::Door(DoorSpec { leaf, opening, move_s: 1.0, starts_open: false });
    fleet.obstacles.push(ObstacleSpec::new("door", wall([5.975, 2.5, 6.025, 3.5]), motion));
    WorldSpec::new(fleet).unwrap()
}

#[test]
fn rooms_with_doors_can_be_reached_but_not_closets() {
    let spec = house();
    let reachable = FreePoses::reachable(&spec, spec.driven_index()).unwrap();
    assert!(reachable.contain(&Point2::new(9.0, 3.0)), "the room behind the door");
    assert!(!reachable.contain(&Point2::new(0.5, 5.0)), "the closet");
}

/// A parked robot in the place of the driven one, which comes later, and a box that closes a doorway until it leaves: both go away
/// by themselves, as a block on a path does.
#[test]
fn a_thing_with_a_schedule_is_not_in_the_way() {
    let spec = house();
    for starts_blocked in [false, true] {
        let thing = |name: &str, at: [f64; 4]| {
            let stays = [Stays::of_mean(600.0); 2];
            let habit = Habit { hours: Hours::always(), active: stays, quiet: stays };
            let schedule = Schedule { habit, starts_blocked };
            ObstacleSpec::new(name, wall(at), Motion::Scheduled(Box::new(schedule)))
        };
        let mut fleet = spec.fleet().clone();
        let box_in_doorway = thing("box", [2.5, 5.95, 3.5, 6.05]);
        let parked = (!starts_blocked).then(|| thing("parked", [1.5, 1.5, 2.5, 2.5]));
        fleet.obstacles.extend(parked.into_iter().chain([box_in_doorway]));
        let with_things = WorldSpec::new(fleet).unwrap();
        let [here, there] = [&spec, &with_things].map(|spec| FreeSpace::new(spec, RADIUS_M));
        assert_eq!(here.regions(), there.regions());
    }
}
