use super::bodies::{Bodies, Handle};
use super::report::{Body, Move};
use super::snapshot::{Played, Tape, Torn};
use super::spec::ObstacleSpec;
use nalgebra::Point2;

/// A place is free for an obstacle when every robot keeps this far away, m: far enough for the
/// physics not to push anything apart.
const ROOM_M: f64 = 0.005;

/// An obstacle and what has become of it.
#[derive(Clone)]
pub(super) struct Obstacle {
    pub(super) spec: ObstacleSpec,
    state: State,
}

#[derive(Clone, Copy)]
enum State {
    Due,
    Standing(Handle),
    Gone,
}

impl Obstacle {
    /// An obstacle at the start: it stands, or its time is still to come.
    pub(super) fn new(spec: &ObstacleSpec, index: usize, bodies: &mut Bodies) -> Self {
        let state = match spec.appears_s {
            None => State::Standing(bodies.add_box(Body::Obstacle(index), &spec.shape)),
            Some(_) => State::Due,
        };
        Self { spec: spec.clone(), state }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        let (mut state, mut handle) = match self.state {
            State::Due => (0, Handle::default()),
            State::Standing(handle) => (1, handle),
            State::Gone => (2, Handle::default()),
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

    pub(super) fn is_standing(&self) -> bool {
        matches!(self.state, State::Standing(_))
    }

    /// Comes or goes, if its time has come. A robot in its place makes it wait; one that would
    /// have to go before its place is free never comes.
    pub(super) fn step(
        &mut self,
        index: usize,
        time_s: f64,
        bodies: &mut Bodies,
        mut robots: impl Iterator<Item = (Point2<f64>, f64)>,
    ) -> Option<Move> {
        // Half a microsecond of slack: times are sums of steps.
        let is_past = |due_s: Option<f64>| due_s.is_some_and(|due_s| time_s >= due_s - 5e-7);
        match self.state {
            State::Due if is_past(self.spec.disappears_s) => {
                self.state = State::Gone;
                None
            }
            State::Due if is_past(self.spec.appears_s) => {
                let shape = &self.spec.shape;
                if robots.any(|(at, radius_m)| shape.distance_m(&at) < radius_m + ROOM_M) {
                    return None;
                }
                self.state = State::Standing(bodies.add_box(Body::Obstacle(index), shape));
                Some(Move::Appeared)
            }
            State::Standing(handle) if is_past(self.spec.disappears_s) => {
                bodies.remove_box(handle);
                self.state = State::Gone;
                Some(Move::Disappeared)
            }
            State::Due | State::Standing(_) | State::Gone => None,
        }
    }
}
