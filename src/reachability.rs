//! Warnings about parts of a world that robots cannot reach, or that they can leave: such a world is valid, but not what
//! its author expects.

use nalgebra::Point2;
use sim::physics::{BehaviorSpec, FleetSpec, FreeSpace, RobotSpec};
use std::collections::BTreeSet;

/// The smallest room that is worth a warning, m².
const ROOM_M2: f64 = 0.25;
/// The maximum number of rooms, and of waypoints of a robot, that are named one by one.
const MAX_NAMED: usize = 5;

/// The warnings about a world, with all doors open: open outer walls, rooms that no robot can reach, and waypoints that
/// their robot cannot reach. Robots that stand still do not count.
pub fn warnings(spec: &FleetSpec) -> Vec<String> {
    let movers: Vec<&RobotSpec> =
        spec.robots.iter().filter(|robot| robot.behavior != BehaviorSpec::Standing).collect();
    let Some(least_m) = movers.iter().map(|robot| robot.radius_m).min_by(f64::total_cmp) else {
        return Vec::new();
    };
    // Wherever a larger robot can drive, the smallest one can.
    let space = FreeSpace::new(spec, least_m);
    let inhabited = movers.iter().filter_map(|robot| own_region(&space, robot)).collect();
    let mut warnings = Vec::from_iter(open_wall(spec, &space, &inhabited));
    warnings.extend(rooms(spec, &space, &inhabited));
    // Robots of the same size share a free space.
    let mut with_waypoints: Vec<&RobotSpec> =
        movers.into_iter().filter(|robot| matches!(robot.behavior, BehaviorSpec::Waypoints(_))).collect();
    with_waypoints.sort_by(|a, b| a.radius_m.total_cmp(&b.radius_m));
    for alike in with_waypoints.chunk_by(|a, b| a.radius_m == b.radius_m) {
        let radius_m = alike[0].radius_m;
        let larger = (radius_m > least_m).then(|| FreeSpace::new(spec, radius_m));
        let space = larger.as_ref().unwrap_or(&space);
        warnings.extend(alike.iter().filter_map(|robot| waypoints(spec, space, robot)));
    }
    warnings
}

/// The region in which a robot starts.
fn own_region(space: &FreeSpace, robot: &RobotSpec) -> Option<usize> {
    space.region_near(&robot.pose.translation.vector.into(), robot.radius_m)
}

/// The regions that touch the border of the map, each with a cell at the border.
fn at_border(spec: &FleetSpec, space: &FreeSpace) -> Vec<(usize, Point2<f64>)> {
    let frame = &spec.frame;
    let is_border = |index: &usize| frame.beside(*index).count() < 4;
    let cells = (0..frame.len()).filter(is_border);
    cells.filter_map(|index| Some((space.regions()[index]?, frame.center(frame.cell(index))))).collect()
}

fn open_wall(spec: &FleetSpec, space: &FreeSpace, inhabited: &BTreeSet<usize>) -> Option<String> {
    let (_, at) = at_border(spec, space).into_iter().find(|(region, _)| inhabited.contains(region))?;
    Some(format!(
        "warning: robots can leave the map of `{}` at {}\n  = help: close the outer wall there, or make the map larger",
        spec.name,
        point(&at)
    ))
}

fn rooms(spec: &FleetSpec, space: &FreeSpace, inhabited: &BTreeSet<usize>) -> Option<String> {
    // What is connected with the border is outside of the building.
    let outside: BTreeSet<usize> = at_border(spec, space).into_iter().map(|(region, _)| region).collect();
    let is_lonely = |(region, area_m2): &(usize, &f64)| {
        **area_m2 >= ROOM_M2 && !inhabited.contains(region) && !outside.contains(region)
    };
    let lonely: Vec<(usize, &f64)> = space.areas_m2().iter().enumerate().filter(is_lonely).collect();
    let named = lonely.iter().take(MAX_NAMED).filter_map(|(region, area_m2)| {
        let first = space.regions().iter().position(|other| *other == Some(*region))?;
        Some(format!("{area_m2:.1} m² at {}", point(&spec.frame.center(spec.frame.cell(first)))))
    });
    let named = listed(named.collect(), lonely.len());
    (!lonely.is_empty()).then(|| {
        format!(
            "warning: no robot can reach a part of `{}`, even with all doors open: {named}\n  = help: make a way in \
             that is wider than a robot, or fill the part by a wall",
            spec.name
        )
    })
}

fn waypoints(spec: &FleetSpec, space: &FreeSpace, robot: &RobotSpec) -> Option<String> {
    let BehaviorSpec::Waypoints(way) = &robot.behavior else { return None };
    let own = own_region(space, robot);
    let is_near =
        |at: &&Point2<f64>| space.region_near(at, spec.frame.resolution_m()) == own && own.is_some();
    let lost: Vec<&Point2<f64>> = way.points.iter().filter(|at| !is_near(at)).collect();
    let named = listed(lost.iter().take(MAX_NAMED).map(|at| point(at)).collect(), lost.len());
    (!lost.is_empty()).then(|| {
        format!(
            "warning: the robot `{}` can never reach {} of its {} waypoints, even with all doors open: {named}\n  = help: \
             its disc has a radius of {} m; move the waypoints away from walls and things",
            robot.name,
            lost.len(),
            way.points.len(),
            robot.radius_m
        )
    })
}

/// The names of the first of `count` things.
fn listed(names: Vec<String>, count: usize) -> String {
    let more = match count - names.len() {
        0 => String::new(),
        others => format!(", and {others} more"),
    };
    names.join(", ") + &more
}

fn point(at: &Point2<f64>) -> String {
    format!("[{:.2}, {:.2}]", at.x, at.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds;
    use sim::physics::{Rectangle, Repeat, WaypointsSpec};

    /// The four rooms with more walls, and with a robot on waypoints, the last of which is `waypoint`.
    fn four_rooms(walls: &[[f64; 4]], waypoint: [f64; 2]) -> FleetSpec {
        let mut world = worlds::load("four_rooms").unwrap().spec.fleet().clone();
        world.walls.extend(walls.iter().map(|[left, bottom, right, top]| {
            Rectangle::between(Point2::new(*left, *bottom), Point2::new(*right, *top))
        }));
        let way = BehaviorSpec::Waypoints(WaypointsSpec {
            points: vec![Point2::new(2.0, 2.0), waypoint.into()],
            speed_mps: 0.4,
            repeat: Repeat::Loop,
            clearance_m: 0.1,
        });
        world.robots = vec![RobotSpec::new("cat", interfaces::pose(1.0, 1.0, 0.0), way)];
        world
    }

    #[test]
    fn shipped_worlds_are_without_fault() {
        for (name, _) in worlds::SHIPPED {
            assert_eq!(warnings(worlds::load(name).unwrap().spec.fleet()), Vec::<String>::new(), "{name}");
        }
    }

    #[test]
    fn a_room_without_a_door_is_reported_and_so_is_what_is_in_it() {
        assert_eq!(warnings(&four_rooms(&[], [3.0, 3.0])), Vec::<String>::new());
        let closet = [[0.1, 4.0, 2.1, 4.1], [2.0, 4.1, 2.1, 5.95]];
        let found = warnings(&four_rooms(&closet, [1.0, 5.0]));
        let [room, waypoint] = &found[..] else { panic!("{found:?}") };
        assert!(room.contains("even with all doors open: 2.2 m² at [0.33, 4.33]"), "{room}");
        assert!(waypoint.contains("`cat` can never reach 1 of its 2 waypoints"), "{waypoint}");
        assert!(waypoint.contains("[1.00, 5.00]"), "{waypoint}");
    }

    #[test]
    fn a_waypoint_in_a_wall_is_reported() {
        let found = warnings(&four_rooms(&[], [6.0, 1.0]));
        assert!(matches!(&found[..], [one] if one.contains("[6.00, 1.00]")), "{found:?}");
    }

    #[test]
    fn an_open_outer_wall_is_reported() {
        let mut world = four_rooms(&[], [3.0, 3.0]);
        world.walls.remove(0); // at the bottom
        let found = warnings(&world);
        assert!(matches!(&found[..], [one] if one.contains("robots can leave the map")), "{found:?}");
    }
}
