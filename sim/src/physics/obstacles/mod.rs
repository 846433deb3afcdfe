//! Obstacles that stand, appear, disappear, are pushed, or move on their own.

mod door;

use super::bodies::{Bodies, Handle, Mover};
use super::form::Form;
use super::report::Body;
use super::shape::Rectangle;
use super::snapshot::{Values, pose, value};
use super::spec::{Motion, ObstacleSpec};
use crate::routine::Routine;
use door::{Calls, Door};
use nalgebra::Point2;
use serde::{Deserialize, Serialize};

/// An obstacle and its state.
#[derive(Clone)]
pub(super) struct Obstacle {
    pub(super) spec: ObstacleSpec,
    /// The present shape; before the obstacle appears, the shape that it will have.
    pub(super) shape: Rectangle,
    state: State,
    /// What it does by its schedule, if it has one.
    routine: Option<Box<Routine>>,
}

#[derive(Clone, Deserialize, Serialize)]
enum State {
    /// The obstacle has not appeared yet, or is away by its schedule.
    Due,
    Standing(Handle),
    Gone,
    Pushed(Mover),
    /// A block, and the number of steps of its path that it has done.
    Path(Mover, u64),
    Door(Mover, Box<Door>),
}

impl Obstacle {
    /// The obstacle with an index, at the start, with random streams of the seed 0. `starts_s` is the time of the week then.
    pub(super) fn new(spec: &ObstacleSpec, index: usize, starts_s: Option<f64>, bodies: &mut Bodies) -> Self {
        let (shape, body) = (spec.start(), Body::Obstacle(index));
        let state = match &spec.motion {
            Motion::Fixed | Motion::Scheduled(_) if !spec.starts_present() => State::Due,
            Motion::Fixed | Motion::Scheduled(_) => State::Standing(bodies.add_box(body, &shape)),
            Motion::Pushed(pushed) => State::Pushed(bodies.add_pushed(body, &shape, pushed)),
            Motion::Path(_) => State::Path(bodies.add_driven(body, &shape), 0),
            Motion::Door(door) => {
                State::Door(bodies.add_driven(body, &shape), Box::new(Door::new(door, index, 0)))
            }
        };
        let routine = routine(spec, index, starts_s, 0);
        Self { spec: spec.clone(), shape, state, routine }
    }

    /// The obstacle with an index at the start, with random streams of another seed. This one must be at the start.
    pub(super) fn reseeded(&self, index: usize, starts_s: Option<f64>, seed: u64) -> Self {
        let mut obstacle = Self { routine: routine(&self.spec, index, starts_s, seed), ..self.clone() };
        if let (State::Door(_, door), Motion::Door(spec)) = (&mut obstacle.state, &self.spec.motion) {
            **door = Door::new(spec, index, seed);
        }
        obstacle
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        let mut values = vec![pose(&mut self.shape.pose), value(&mut self.state)];
        values.extend(self.routine.iter_mut().flat_map(|routine| routine.values()));
        values
    }

    /// Whether the obstacle is present.
    pub(super) fn is_standing(&self) -> bool {
        !matches!(self.state, State::Due | State::Gone)
    }

    /// For a door, its openness: 0 closed, 1 open.
    pub(super) fn openness(&self) -> Option<f64> {
        let State::Door(_, door) = &self.state else { return None };
        Some(door.openness)
    }

    /// Whether robots can push the obstacle.
    pub(super) fn is_pushed(&self) -> bool {
        matches!(self.state, State::Pushed(_))
    }

    /// Whether the obstacle is a door or a moving block.
    pub(super) fn moves_itself(&self) -> bool {
        matches!(self.state, State::Path(..) | State::Door(..))
    }

    /// Starts the motion in the next physics step, which ends at `time_s`, if nothing is in the way. `is_needed`: a robot
    /// that a door waits for needs it to get to its dock.
    pub(super) fn start_step(
        &mut self,
        [time_s, step_s]: [f64; 2],
        is_needed: bool,
        bodies: &mut Bodies,
        blockers: &Blockers,
    ) {
        let mut go = |shape: &mut Rectangle, mover: &Mover, next: Rectangle| {
            let is_free = next == *shape || blockers.is_free(shape, &next);
            if is_free && next != *shape {
                *shape = next;
                bodies.drive(mover, &next.pose);
            }
            is_free
        };
        match (&mut self.state, &self.spec.motion) {
            (State::Path(mover, steps), Motion::Path(path)) => {
                let at = path.at((*steps + 1) as f64 * step_s);
                if go(&mut self.shape, mover, self.spec.shape.moved(at - path.keys[0].1)) {
                    *steps += 1;
                }
            }
            (State::Door(mover, door), Motion::Door(spec)) => {
                let calls = Calls { routine: self.routine.as_deref_mut(), is_needed };
                let openness = door.next(spec, calls, time_s, step_s);
                let is_free = go(&mut self.shape, mover, spec.shape(&self.spec.shape, openness));
                door.end_step(openness, is_free, step_s);
            }
            _ => {}
        }
    }

    /// Stores the pose of the body of a pushed obstacle after the step.
    pub(super) fn end_step(&mut self, bodies: &mut Bodies) {
        if let State::Pushed(mover) = &self.state {
            self.shape.pose = bodies.pushed_pose(mover);
        }
    }

    /// The time until which nothing happens to the obstacle while all other bodies rest, s, from `time_s` on; `None` if it
    /// moves now.
    pub(super) fn rests_until_s(&mut self, time_s: f64, is_needed: bool) -> Option<f64> {
        let still_to_come =
            |due_s: Option<f64>| due_s.filter(|due_s| *due_s > time_s).unwrap_or(f64::INFINITY);
        match (&mut self.state, &self.spec.motion) {
            (State::Door(_, door), Motion::Door(spec)) => {
                door.rests_until_s(spec, Calls { routine: self.routine.as_deref_mut(), is_needed }, time_s)
            }
            (State::Path(..), _) => None,
            (State::Due | State::Standing(_), Motion::Scheduled(_)) => {
                self.routine.as_ref().map(|routine| routine.next_s())
            }
            (State::Due, _) => {
                Some(still_to_come(self.spec.appears_s).min(still_to_come(self.spec.disappears_s)))
            }
            (State::Standing(_), _) => Some(still_to_come(self.spec.disappears_s)),
            _ => Some(f64::INFINITY),
        }
    }

    /// Whether it is time to appear (`true`) or to disappear (`false`).
    pub(super) fn due(&mut self, time_s: f64) -> Option<bool> {
        let is_past = |due_s: Option<f64>| due_s.is_some_and(|due_s| time_s >= due_s - SLACK_S);
        let ObstacleSpec { motion, appears_s, disappears_s, .. } = &self.spec;
        let is_standing = self.is_standing();
        let is_wanted = match (&mut self.routine, motion) {
            (Some(routine), Motion::Scheduled(_)) => {
                routine.place(time_s + SLACK_S) == Some(self.spec.place())
            }
            _ => !is_past(*disappears_s) && (is_standing || is_past(*appears_s)),
        };
        (is_wanted != is_standing).then_some(is_wanted)
    }

    /// Appears, or disappears: without a schedule, for good.
    pub(super) fn set_present(&mut self, is_present: bool, index: usize, bodies: &mut Bodies) {
        if let State::Standing(handle) = self.state {
            bodies.remove_box(handle);
        }
        self.state = match (is_present, &self.spec.motion) {
            (true, _) => State::Standing(bodies.add_box(Body::Obstacle(index), &self.shape)),
            (false, Motion::Scheduled(_)) => State::Due,
            (false, _) => State::Gone,
        };
    }
}

/// Times are sums of steps: a time within this of an event counts as the time of the event, s.
const SLACK_S: f64 = 5e-7;

/// What an obstacle does by its schedule, if it has one.
fn routine(spec: &ObstacleSpec, index: usize, starts_s: Option<f64>, seed: u64) -> Option<Box<Routine>> {
    let (starts_s, places) = (starts_s.unwrap_or_default(), spec.part.map_or(1, |part| part.places));
    Some(Box::new(Routine::new(spec.schedule()?, starts_s, places, spec.thing(index), seed)))
}

/// An obstacle may move to a pose if every other moving body is at least this far away, m: far enough that the
/// physics engine does not push the bodies apart.
const ROOM_M: f64 = 0.005;

/// The bodies that an obstacle must not hit. The obstacle waits instead, so that it does not crush anything.
#[derive(Default)]
pub(crate) struct Blockers {
    things: Vec<Thing>,
}

struct Thing {
    /// Center and radius of a circle around the body, m.
    center: Point2<f64>,
    radius_m: f64,
    form: Form,
}

impl Blockers {
    /// Adds a body that lies within `radius_m` of `center` (m).
    pub(crate) fn add(&mut self, center: Point2<f64>, radius_m: f64, form: Form) {
        self.things.push(Thing { center, radius_m, form });
    }

    /// Whether a rectangle can move from one pose to the other: a body that is near on the way or afterwards was at
    /// least as near before.
    pub(super) fn is_free(&self, from: &Rectangle, to: &Rectangle) -> bool {
        let (before, after) = (from.corners(), to.corners());
        let motions_m = before.iter().zip(&after).map(|(before, after)| (after - before).norm());
        let motion_m = motions_m.fold(0.0, f64::max);
        // Most bodies are far away: compares circles first.
        let center = Point2::from(to.pose.translation.vector);
        let reach_m = to.half_m.norm() + motion_m + ROOM_M;
        let is_near =
            |thing: &&Thing| (thing.center - center).norm_squared() <= (reach_m + thing.radius_m).powi(2);
        self.things.iter().filter(is_near).all(|thing| {
            let before_m = thing.form.gap_m(&before);
            let has_room = |gap_m: f64| gap_m >= ROOM_M || gap_m >= before_m;
            // As many poses as it takes not to skip a body between two of them.
            let poses = (motion_m / from.half_m.min().max(thing.form.inner_m())).ceil() as usize;
            let mut between = (1..poses).map(|pose| {
                let pose = from.pose.lerp_slerp(&to.pose, pose as f64 / poses as f64);
                thing.form.gap_m(&Rectangle { pose, ..*from }.corners())
            });
            has_room(thing.form.gap_m(&after)) && between.all(has_room)
        })
    }

    /// Whether a convex body can appear.
    pub(super) fn has_room(&self, corners: &[Point2<f64>]) -> bool {
        self.things.iter().all(|thing| thing.form.gap_m(corners) >= ROOM_M)
    }
}
