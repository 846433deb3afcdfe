//! Obstacles: boxes, moving blocks and doors.

use crate::physics::shape::{Rectangle, Transform};
use calendar::Schedule;
use nalgebra::{Point2, Vector2};

/// A box, a moving block or a door.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleSpec {
    /// The name of the obstacle.
    pub name: String,
    /// The shape at the start; for a door, the shape of the closed leaf.
    pub shape: Rectangle,
    /// The motion of the obstacle.
    pub motion: Motion,
    /// The time at which the obstacle appears, s; `None` if it is present from the start.
    pub appears_s: Option<f64>,
    /// The time at which the obstacle disappears, s; `None` if it never disappears.
    pub disappears_s: Option<f64>,
    /// The thing with a schedule that the obstacle is a part of, if that has several boxes or places.
    pub part: Option<ThingPart>,
}

/// A part of a thing that comes and goes as a whole: a leg of a chair, in one of the places of the chair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThingPart {
    /// The index of the obstacle that is the first part of the thing, at its first place. All parts have its schedule.
    pub thing: usize,
    /// The place of the thing at which the part is there, from 0 on.
    pub place: usize,
    /// The number of places of the thing. Whenever it comes, it comes to another one of them.
    pub places: usize,
}

impl ObstacleSpec {
    /// An obstacle that is there from the start to the end.
    pub fn new(name: &str, shape: Rectangle, motion: Motion) -> Self {
        let name = name.to_owned();
        Self { name, shape, motion, appears_s: None, disappears_s: None, part: None }
    }

    /// Whether the obstacle ever appears, disappears or moves.
    pub fn is_mover(&self) -> bool {
        self.appears_s.is_some() || self.disappears_s.is_some() || self.motion != Motion::Fixed
    }

    /// When the obstacle comes and goes, or opens and closes, if it does so by a schedule.
    pub fn schedule(&self) -> Option<&Schedule> {
        match &self.motion {
            Motion::Scheduled(schedule)
            | Motion::Door(DoorSpec { opening: Opening::Scheduled { schedule, .. }, .. }) => Some(schedule),
            _ => None,
        }
    }

    /// Whether the obstacle is a door that is open for robots that need it.
    pub(crate) fn waits_for_robots(&self) -> bool {
        matches!(
            &self.motion,
            Motion::Door(DoorSpec { opening: Opening::Scheduled { waits_for_robots: true, .. }, .. })
        )
    }

    /// The index of the first obstacle of the thing that it is a part of: its own `index` unless it is one.
    pub fn thing(&self, index: usize) -> usize {
        self.part.map_or(index, |part| part.thing)
    }

    /// The place of its thing at which the obstacle is there, from 0 on.
    pub fn place(&self) -> usize {
        self.part.map_or(0, |part| part.place)
    }

    /// Whether the obstacle is present at the start.
    pub fn starts_present(&self) -> bool {
        match &self.motion {
            Motion::Scheduled(schedule) => schedule.starts_blocked && self.place() == 0,
            _ => self.appears_s.is_none(),
        }
    }

    /// The shape at the start; for a door, open or closed.
    pub fn start(&self) -> Rectangle {
        self.with_door(|door| f64::from(u8::from(door.starts_open)))
    }

    /// The shape at the start, but with a door open.
    pub fn opened(&self) -> Rectangle {
        self.with_door(|_| 1.0)
    }

    /// The shape at the start, but of a door with the openness that is given for it.
    fn with_door(&self, openness: impl Fn(&DoorSpec) -> f64) -> Rectangle {
        let Motion::Door(door) = &self.motion else { return self.shape };
        door.shape(&self.shape, openness(door))
    }

    /// Moves the obstacle with the world.
    pub(super) fn transform(&mut self, by: &Transform) {
        self.shape = self.shape.transformed(by);
        match &mut self.motion {
            Motion::Fixed | Motion::Pushed(_) | Motion::Scheduled(_) => {}
            Motion::Path(path) => path.keys.iter_mut().for_each(|(_, at)| *at = by.point(at)),
            Motion::Door(DoorSpec { leaf: Leaf::Hinged { hinge, .. }, .. }) => *hinge = by.point(hinge),
            Motion::Door(DoorSpec { leaf: Leaf::Sliding { by_m }, .. }) => *by_m = by.turn * *by_m,
        }
    }
}

/// The motion of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// The obstacle does not move.
    Fixed,
    /// Robots can push the obstacle.
    Pushed(PushedSpec),
    /// The obstacle moves along a path, at given times.
    Path(PathSpec),
    /// The obstacle is a door: it opens and closes.
    Door(DoorSpec),
    /// The obstacle does not move, but comes and goes by a schedule: a parked robot, a box, a person in a place. It comes as
    /// soon as nothing is in its place.
    Scheduled(Box<Schedule>),
}

/// Settings of a box that can be pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PushedSpec {
    /// The mass, kg.
    pub mass_kg: f64,
    /// The coefficient of friction on the floor; 0: the box glides.
    pub friction: f64,
}

/// A path with times. The block waits while a body is in the way; the rest of the path is then delayed.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSpec {
    /// Times (s) and positions of the center (m), in ascending order, the first time is 0; linear interpolation in
    /// between.
    pub keys: Vec<(f64, Point2<f64>)>,
    /// Whether the path begins again at the last time (the last position is then the first one), or the block stops
    /// there.
    pub is_loop: bool,
}

impl PathSpec {
    /// The position of the center (m) at a time on the path (s).
    pub(crate) fn at(&self, time_s: f64) -> Point2<f64> {
        let (end_s, last) = self.keys[self.keys.len() - 1];
        let time_s = if self.is_loop { time_s % end_s } else { time_s };
        let next = self.keys.partition_point(|(key_s, _)| *key_s <= time_s);
        if next == self.keys.len() {
            return last;
        }
        let ((from_s, from), (to_s, to)) = (self.keys[next - 1], self.keys[next]);
        from + (to - from) * ((time_s - from_s) / (to_s - from_s))
    }
}

/// Settings of a door. If a body is in the way of its leaf for 2 s, the door moves back, stays there for 5 s, and tries
/// again.
#[derive(Clone, Debug, PartialEq)]
pub struct DoorSpec {
    /// The motion of the leaf.
    pub leaf: Leaf,
    /// When the door opens and closes.
    pub opening: Opening,
    /// The duration of the motion from closed to open, s.
    pub move_s: f64,
    /// Whether the door is open at the start.
    pub starts_open: bool,
}

impl DoorSpec {
    /// The leaf at an `openness` from 0 (closed, at `closed`) to 1 (open).
    pub fn shape(&self, closed: &Rectangle, openness: f64) -> Rectangle {
        match self.leaf {
            Leaf::Hinged { hinge, open_rad } => {
                let turn = interfaces::rotation(open_rad * openness);
                closed.transformed(&Transform { turn, from: hinge, to: hinge })
            }
            Leaf::Sliding { by_m } => closed.moved(by_m * openness),
        }
    }
}

/// The motion of the leaf of a door.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leaf {
    /// The leaf rotates.
    Hinged {
        /// The position of the hinge, m.
        hinge: Point2<f64>,
        /// The angle when open, counter-clockwise, rad.
        open_rad: f64,
    },
    /// The leaf slides.
    Sliding {
        /// The displacement when open, m.
        by_m: Vector2<f64>,
    },
}

/// When a door opens and closes. The time of a change is the time at which the leaf begins to move.
#[derive(Clone, Debug, PartialEq)]
pub enum Opening {
    /// The door opens and closes periodically.
    Periodic {
        /// The time from the beginning of closing to the beginning of opening, s.
        closed_s: f64,
        /// The time from the beginning of opening to the beginning of closing, s.
        open_s: f64,
    },
    /// The door opens and closes at random: the times are exponentially distributed.
    Random {
        /// The mean time from the beginning of closing to the beginning of opening, s.
        closed_s: f64,
        /// The mean time from the beginning of opening to the beginning of closing, s.
        open_s: f64,
    },
    /// The door opens and closes alternately at given times.
    Scripted {
        /// The times of the changes, in ascending order, s.
        switches_s: Vec<f64>,
    },
    /// The door opens (free) and closes (blocked) by a schedule.
    Scheduled {
        /// The schedule.
        schedule: Box<Schedule>,
        /// Whether people open the door for robots: it is open, against its schedule, while it is on the way with the fewest
        /// such doors from the room of a driven robot to its dock. A leaf closes a room if the robot does not fit past it.
        waits_for_robots: bool,
    },
}
