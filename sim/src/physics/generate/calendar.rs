//! What gives a generated building a calendar: schedules of its doors, and places of boxes, people and parked robots.

use super::APART_M;
use super::plan::Plan;
use super::routes::Routes;
use crate::building_calendar::BuildingCalendar;
use crate::physics::shape::Rectangle;
use crate::physics::spec::{Motion, ObstacleSpec, Opening};
use calendar::ThingKind;
use nalgebra::{Point2, Vector2};
use rand::RngExt;

/// The number of places with a thing that comes and goes, per room: from none to this.
const MAX_THINGS: usize = 2;
/// The kinds of these things, with a name, and the sides of the box that stands for one, m: within the circle that a place
/// keeps free.
const THINGS: [(ThingKind, &str, [f64; 2]); 3] = [
    (ThingKind::Person, "person", [0.35, 0.35]),
    (ThingKind::Box, "box", [0.4, 0.4]),
    (ThingKind::ParkedRobot, "parked robot", [0.4, 0.45]),
];

/// Gives the doors schedules.
pub(super) fn schedule_doors(calendar: &mut BuildingCalendar, obstacles: &mut [ObstacleSpec]) {
    for obstacle in obstacles {
        if let Motion::Door(door) = &mut obstacle.motion {
            let schedule = calendar.draw(ThingKind::Door);
            door.starts_open = !schedule.starts_blocked;
            door.opening = Opening::Scheduled { schedule: Box::new(schedule), waits_for_robots: true };
        }
    }
}

/// Things that come and go in rooms, away from where the explorer starts (m).
pub(super) fn things(
    calendar: &mut BuildingCalendar,
    routes: &Routes,
    plan: &Plan,
    start: &Point2<f64>,
) -> Vec<ObstacleSpec> {
    let mut things = Vec::new();
    for places in routes.places_by_room() {
        let count = calendar.rng.random_range(0..=MAX_THINGS.min(places.len()));
        for at in places.iter().take(count).filter(|at| (*at - start).norm() >= APART_M) {
            let (kind, name, sides_m) = THINGS[calendar.rng.random_range(0..THINGS.len())];
            let schedule = calendar.draw(kind);
            let sides_m = if plan.is_upright { Vector2::new(sides_m[1], sides_m[0]) } else { sides_m.into() };
            let corner = |offset: Vector2<f64>| (at + offset).map(|at_m| (at_m * 1000.0).round() / 1000.0);
            let shape = Rectangle::between(corner(-sides_m / 2.0), corner(sides_m / 2.0));
            let name = format!("{name} {}", things.len() + 1);
            things.push(ObstacleSpec::new(&name, shape, Motion::Scheduled(Box::new(schedule))));
        }
    }
    things
}
