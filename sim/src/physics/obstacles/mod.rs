//! What has become of the obstacles.

mod door;
mod way;

use super::bodies::{Bodies, Handle, Mover};
use super::report::{Body, Move};
use super::shape::Rectangle;
use super::snapshot::{Played, Tape, Torn};
use super::spec::{Motion, ObstacleSpec};
use door::Door;
pub(super) use way::InTheWay;

/// An obstacle and what has become of it.
#[derive(Clone)]
pub(super) struct Obstacle {
    pub(super) spec: ObstacleSpec,
    /// Where it is, or would be.
    pub(super) shape: Rectangle,
    state: State,
}

#[derive(Clone)]
enum State {
    Due,
    Standing(Handle),
    Gone,
    Pushed(Mover),
    /// A block, and how many steps of its path it has done.
    Path(Mover, u64),
    Door(Mover, Box<Door>),
}

impl Obstacle {
    /// An obstacle at the start: it is there, or its time is still to come.
    pub(super) fn new(spec: &ObstacleSpec, index: usize, seed: u64, bodies: &mut Bodies) -> Self {
        let (shape, body) = (spec.start(), Body::Obstacle(index));
        let state = match &spec.motion {
            Motion::Fixed if spec.appears_s.is_some() => State::Due,
            Motion::Fixed => State::Standing(bodies.add_box(body, &shape)),
            Motion::Pushed(pushed) => State::Pushed(bodies.add_pushed(body, &shape, pushed)),
            Motion::Path(_) => State::Path(bodies.add_driven(body, &shape), 0),
            Motion::Door(door) => {
                State::Door(bodies.add_driven(body, &shape), Box::new(Door::new(door, index, seed)))
            }
        };
        Self { spec: spec.clone(), shape, state }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        match &mut self.state {
            State::Pushed(_) => {}
            State::Path(_, steps) => tape.u64(steps)?,
            State::Door(_, door) => door.play(tape)?,
            State::Due | State::Standing(_) | State::Gone => return self.play_standing(tape),
        }
        tape.pose(&mut self.shape.pose)
    }

    fn play_standing(&mut self, tape: &mut Tape<'_>) -> Played {
        let (mut state, mut handle) = match self.state {
            State::Standing(handle) => (1, handle),
            State::Gone => (2, Handle::default()),
            _ => (0, Handle::default()),
        };
        tape.u32(&mut state)?;
        handle.play(tape)?;
        self.state = match state {
            0 => State::Due,
            1 => State::Standing(handle),
            2 => State::Gone,
            _ => return Err(Torn),
        };
        Ok(())
    }

    /// Whether it is there.
    pub(super) fn is_standing(&self) -> bool {
        !matches!(self.state, State::Due | State::Gone)
    }

    /// Whether whatever drives against it pushes it.
    pub(super) fn is_pushed(&self) -> bool {
        matches!(self.state, State::Pushed(_))
    }

    /// Whether it is a door or a block.
    pub(super) fn moves_itself(&self) -> bool {
        matches!(self.state, State::Path(..) | State::Door(..))
    }

    /// Sets out on the next physics step, which ends at `time_s`, if nothing is in the way.
    pub(super) fn set_out(&mut self, time_s: f64, step_s: f64, bodies: &mut Bodies, in_the_way: &InTheWay) {
        let mut go = |shape: &mut Rectangle, mover: &Mover, next: Rectangle| {
            let is_free = next == *shape || in_the_way.is_free(shape, &next);
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
                let openness = door.next(spec, time_s, step_s);
                if go(&mut self.shape, mover, spec.shape(&self.spec.shape, openness)) {
                    door.openness = openness;
                }
            }
            _ => {}
        }
    }

    /// Takes over where the step brought what is pushed.
    pub(super) fn follow(&mut self, bodies: &mut Bodies) {
        if let State::Pushed(mover) = &self.state {
            self.shape.pose = bodies.pushed_pose(mover);
        }
    }

    /// Whether it is time to come or to go.
    pub(super) fn is_due(&self, time_s: f64) -> bool {
        match self.state {
            State::Due => is_past(time_s, self.spec.appears_s),
            State::Standing(_) => is_past(time_s, self.spec.disappears_s),
            _ => false,
        }
    }

    /// Comes or goes, if its time has come. Something in its place makes it wait; one that would
    /// have to go before its place is free never comes.
    pub(super) fn come_or_go(
        &mut self,
        index: usize,
        time_s: f64,
        bodies: &mut Bodies,
        in_the_way: &InTheWay,
    ) -> Option<Move> {
        let is_past = |due_s| is_past(time_s, due_s);
        match self.state {
            State::Due if is_past(self.spec.disappears_s) => {
                self.state = State::Gone;
                None
            }
            State::Due if is_past(self.spec.appears_s) => {
                if !in_the_way.has_room(&self.shape) {
                    return None;
                }
                self.state = State::Standing(bodies.add_box(Body::Obstacle(index), &self.shape));
                Some(Move::Appeared)
            }
            State::Standing(handle) if is_past(self.spec.disappears_s) => {
                bodies.remove_box(handle);
                self.state = State::Gone;
                Some(Move::Disappeared)
            }
            _ => None,
        }
    }
}

/// Whether a time has come, s, with half a microsecond of slack: times are sums of steps.
fn is_past(time_s: f64, due_s: Option<f64>) -> bool {
    due_s.is_some_and(|due_s| time_s >= due_s - 5e-7)
}
