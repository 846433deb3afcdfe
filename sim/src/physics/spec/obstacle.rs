//! Things that stand, come and go, are pushed, or move by themselves.

use crate::physics::shape::{Rectangle, turned_point};
use nalgebra::{Point2, UnitComplex, Vector2};

/// A box, a moving block or a door.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleSpec {
    /// What it is called.
    pub name: String,
    /// Where it is at the start; of a door: where its leaf is while closed.
    pub shape: Rectangle,
    /// How it moves.
    pub motion: Motion,
    /// Its tag, by which robots find it.
    pub tag: Option<u32>,
    /// When it is put there, s; `None`: it is there from the start.
    pub appears_s: Option<f64>,
    /// When it is taken away, s; `None`: never.
    pub disappears_s: Option<f64>,
}

impl ObstacleSpec {
    /// Whether it comes, goes or moves at all.
    pub fn is_mover(&self) -> bool {
        self.appears_s.is_some() || self.disappears_s.is_some() || self.motion != Motion::Fixed
    }

    /// Where it is at the start, a door open or closed.
    pub fn start(&self) -> Rectangle {
        match &self.motion {
            Motion::Door(door) => door.shape(&self.shape, f64::from(u8::from(door.starts_open))),
            Motion::Fixed | Motion::Pushed(_) | Motion::Path(_) => self.shape,
        }
    }

    /// The same after the world has turned about `middle` (m).
    pub(super) fn turn(&mut self, turn: &UnitComplex<f64>, middle: &Point2<f64>) {
        self.shape = self.shape.turned(turn, middle);
        match &mut self.motion {
            Motion::Fixed | Motion::Pushed(_) => {}
            Motion::Path(path) => {
                path.keys.iter_mut().for_each(|(_, at)| *at = turned_point(at, turn, middle));
            }
            Motion::Door(DoorSpec { leaf: Leaf::Hinged { hinge, .. }, .. }) => {
                *hinge = turned_point(hinge, turn, middle);
            }
            Motion::Door(DoorSpec { leaf: Leaf::Sliding { by_m }, .. }) => *by_m = turn * *by_m,
        }
    }
}

/// How an obstacle moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// It stands.
    Fixed,
    /// Whatever drives against it pushes it.
    Pushed(PushedSpec),
    /// It moves along a path.
    Path(PathSpec),
    /// It opens and closes.
    Door(DoorSpec),
}

/// A box that can be pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PushedSpec {
    /// Its mass, kg.
    pub mass_kg: f64,
    /// The coefficient of its friction on the floor: it takes this share of its weight to move it,
    /// and slows it down again. 0: it glides.
    pub friction: f64,
}

/// A path in time. Something in the way makes a block wait; the rest of its path is later then.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSpec {
    /// Where its middle is at which time (s and m), in order, the first at 0; straight and even in
    /// between.
    pub keys: Vec<(f64, Point2<f64>)>,
    /// Whether it begins again at the last time (where the last place is the first one), or stays.
    pub is_loop: bool,
}

impl PathSpec {
    /// Where its middle is at a time (s) of its own, m.
    pub(in crate::physics) fn at(&self, time_s: f64) -> Point2<f64> {
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

/// A door. Something in the way of its leaf makes it wait.
#[derive(Clone, Debug, PartialEq)]
pub struct DoorSpec {
    /// How its leaf moves.
    pub leaf: Leaf,
    /// When it opens and closes.
    pub opening: Opening,
    /// How long it takes from closed to open, s.
    pub move_s: f64,
    /// Whether it is open at the start.
    pub starts_open: bool,
}

impl DoorSpec {
    /// Where a leaf is that is at `closed` while closed; `openness`: 0 closed, 1 open.
    pub fn shape(&self, closed: &Rectangle, openness: f64) -> Rectangle {
        match self.leaf {
            Leaf::Hinged { hinge, open_rad } => {
                closed.turned(&interfaces::rotation(open_rad * openness), &hinge)
            }
            Leaf::Sliding { by_m } => closed.moved(by_m * openness),
        }
    }
}

/// How a door's leaf moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leaf {
    /// It turns.
    Hinged {
        /// What it turns about, m.
        hinge: Point2<f64>,
        /// How far it is turned when open, counter-clockwise, rad.
        open_rad: f64,
    },
    /// It slides.
    Sliding {
        /// How far away it is when open, m.
        by_m: Vector2<f64>,
    },
}

/// When a door opens and closes. Times count from when it begins to do so.
#[derive(Clone, Debug, PartialEq)]
pub enum Opening {
    /// Always alike.
    Periodic {
        /// How long it is told to be closed, s.
        closed_s: f64,
        /// How long it is told to be open, s.
        open_s: f64,
    },
    /// At random, by a Poisson process: the times are exponentially distributed.
    Random {
        /// The mean time that it is told to be closed, s.
        closed_s: f64,
        /// The mean time that it is told to be open, s.
        open_s: f64,
    },
    /// At these times, s, in order: each time the other way.
    Scripted {
        /// The times, s.
        switches_s: Vec<f64>,
    },
}
