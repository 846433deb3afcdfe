//! The things of a world that come and go, or open and close: each as a whole, for metrics only.

use super::fleet::Fleet;
use super::ground_truth::cover::box_cells;
use super::ground_truth::start::walls_cover;
use super::shape::Rectangle;
use super::spec::{DoorSpec, FleetSpec, Motion, ObstacleSpec, Opening};
use interfaces::TrueState;
use std::collections::BTreeSet;

/// A thing that comes and goes by a schedule, or a door.
#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    /// The name.
    pub name: String,
    /// The index of its first obstacle.
    pub obstacle: usize,
    /// The cells that the thing overlaps in each of its places by more than a touch, in ascending order, without those of walls
    /// and of obstacles that always stand. A door has two places: closed and open.
    pub places: Vec<Vec<usize>>,
}

impl FleetSpec {
    /// The things of the world that come and go by a schedule, and its doors.
    pub fn things(&self) -> Vec<Thing> {
        let stands = |obstacle: &&ObstacleSpec| !obstacle.is_mover();
        let fixed = self.obstacles.iter().filter(stands).map(|obstacle| obstacle.shape);
        let solids = walls_cover(&self.frame, &self.walls.iter().copied().chain(fixed).collect::<Vec<_>>());
        let cells = |shapes: Vec<Rectangle>| {
            let mut cells = BTreeSet::new();
            for shape in &shapes {
                box_cells(&self.frame, shape, |cell, _| {
                    cells.extend((solids[cell] == TrueState::Free).then_some(cell));
                });
            }
            cells.into_iter().collect()
        };
        let obstacles = || self.obstacles.iter().enumerate();
        let at = |thing: usize, place: usize| {
            let parts =
                obstacles().filter(|(index, part)| (part.thing(*index), part.place()) == (thing, place));
            parts.map(|(_, part)| part.shape).collect()
        };
        let things = obstacles().filter_map(|(obstacle, first)| {
            let places: Vec<_> = match &first.motion {
                _ if first.thing(obstacle) != obstacle => return None,
                Motion::Scheduled(_) => {
                    (0..first.part.map_or(1, |part| part.places)).map(|place| at(obstacle, place)).collect()
                }
                Motion::Door(_) => vec![vec![first.shape], vec![first.opened()]],
                Motion::Fixed | Motion::Pushed(_) | Motion::Path(_) => return None,
            };
            Some(Thing {
                name: first.name.clone(),
                obstacle,
                places: places.into_iter().map(cells).collect(),
            })
        });
        things.collect()
    }
}

impl Fleet {
    /// The place where a thing is now; `None` if it is away. A door is closed (0) up to half of its way, and open (1) from there on.
    pub fn place_of(&self, thing: &Thing) -> Option<usize> {
        let mut obstacles = self.obstacles.iter().enumerate();
        obstacles.find_map(|(index, obstacle)| match obstacle.openness() {
            _ if obstacle.spec.thing(index) != thing.obstacle || !obstacle.is_standing() => None,
            Some(openness) => Some(usize::from(openness > 0.5)),
            None => Some(obstacle.spec.place()),
        })
    }
}

impl Thing {
    /// The nominal mean stays of the thing at a time since the start of its world, s: away (open) and there (closed), s. `None` for
    /// scripted changes.
    pub fn mean_stays_s(&self, world: &FleetSpec, time_s: f64) -> Option<[f64; 2]> {
        let obstacle = world.obstacles.get(self.obstacle)?;
        if let Motion::Door(DoorSpec { opening, .. }) = &obstacle.motion
            && let Opening::Periodic { closed_s, open_s } | Opening::Random { closed_s, open_s } = opening
        {
            return Some([*open_s, *closed_s]);
        }
        let habit = &obstacle.schedule()?.habit;
        let is_active = habit.hours.is_active(world.starts_s.unwrap_or_default() + time_s);
        Some(habit.stays(is_active).map(|stays| stays.mean_s()))
    }
}
