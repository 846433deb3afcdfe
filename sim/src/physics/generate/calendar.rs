//! What gives a generated building a calendar: schedules of its doors, and places of boxes, people and parked robots.

use super::APART_M;
use super::plan::Plan;
use super::routes::Routes;
use crate::physics::shape::Rectangle;
use crate::physics::spec::{Motion, ObstacleSpec, Opening};
use calendar::{Changes, Habit, Hours, Kind, PHASES, Schedule, Stays, ThingKind, Timeline, WEEK_S};
use interfaces::{Purpose, RandomStream};
use nalgebra::{Point2, Vector2};
use rand::RngExt;

/// Weeks after which the state of a thing does not depend on that before them.
const WEEKS_BEFORE: f64 = 8.0;
/// The number of places with a thing that comes and goes, per room: from none to this.
const MAX_THINGS: usize = 2;
/// The kinds of these things, with a name, and the sides of the box that stands for one, m: within the circle that a place
/// keeps free.
const THINGS: [(ThingKind, &str, [f64; 2]); 3] = [
    (ThingKind::Person, "person", [0.35, 0.35]),
    (ThingKind::Box, "box", [0.4, 0.4]),
    (ThingKind::ParkedRobot, "parked robot", [0.4, 0.45]),
];

/// The calendar of a building.
pub(super) struct Calendar {
    kind: Kind,
    hours: Hours,
    rng: RandomStream,
}

impl Calendar {
    /// The calendar of a building of a kind. Its random numbers are none of those of the building: the same walls, doors and
    /// furniture as without a calendar.
    pub(super) fn new(kind: Kind, seed: u64) -> Self {
        let mut rng = RandomStream::new(seed, Purpose::DayGenerator);
        Self { hours: kind.draw_hours(&mut rng), kind, rng }
    }

    /// Gives the doors schedules.
    pub(super) fn schedule_doors(&mut self, obstacles: &mut [ObstacleSpec]) {
        for obstacle in obstacles {
            if let Motion::Door(door) = &mut obstacle.motion {
                let schedule = self.draw(ThingKind::Door);
                door.starts_open = !schedule.starts_blocked;
                door.opening = Opening::Scheduled { schedule: Box::new(schedule), waits_for_robots: true };
            }
        }
    }

    /// Things that come and go in rooms, away from where the explorer starts (m).
    pub(super) fn things(&mut self, routes: &Routes, plan: &Plan, start: &Point2<f64>) -> Vec<ObstacleSpec> {
        let mut things = Vec::new();
        for places in routes.places_by_room() {
            let count = self.rng.random_range(0..=MAX_THINGS.min(places.len()));
            for at in places.iter().take(count).filter(|at| (*at - start).norm() >= APART_M) {
                let (kind, name, sides_m) = THINGS[self.rng.random_range(0..THINGS.len())];
                let schedule = self.draw(kind);
                let sides_m =
                    if plan.is_upright { Vector2::new(sides_m[1], sides_m[0]) } else { sides_m.into() };
                let corner =
                    |offset: Vector2<f64>| (at + offset).map(|at_m| (at_m * 1000.0).round() / 1000.0);
                let shape = Rectangle::between(corner(-sides_m / 2.0), corner(sides_m / 2.0));
                let name = format!("{name} {}", things.len() + 1);
                things.push(ObstacleSpec::new(&name, shape, Motion::Scheduled(Box::new(schedule))));
            }
        }
        things
    }

    /// A schedule whose state at the start, Monday 0:00, is that of a thing that has done so for weeks.
    fn draw(&mut self, kind: ThingKind) -> Schedule {
        let mut habit = self.kind.draw_habit(kind, &self.hours, &mut self.rng);
        // A world file has short numbers.
        for stays in habit.active.iter_mut().chain(&mut habit.quiet) {
            let Stays { short_s, long_s, long_share } = *stays;
            let [short_s, long_s] = [short_s, long_s].map(|mean_s| (mean_s * 10.0).round() / 10.0);
            *stays = Stays { short_s, long_s, long_share: (long_share * 1000.0).round() / 1000.0 };
        }
        let starts_blocked = self.is_blocked_at_start(&habit);
        Schedule { changes: Changes::Habit(habit), starts_blocked }
    }

    fn is_blocked_at_start(&mut self, habit: &Habit) -> bool {
        let phases = [1.0 / PHASES as f64; PHASES];
        let mut before = Timeline::of_habit(habit, &phases, -WEEKS_BEFORE * WEEK_S, self.rng.clone());
        before.advance(0.0, |_, _| ());
        // The next thing has other numbers.
        self.rng.random::<u64>();
        before.is_blocked()
    }
}
