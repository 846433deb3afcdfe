//! The state of a fleet: back to the start, to bytes, and from bytes.

use super::Fleet;
use crate::physics::snapshot::{Played, SnapshotError, Tape, fingerprint};
use crate::physics::spec::FleetSpec;

impl Fleet {
    /// Goes back to the start, with another seed or the same.
    pub fn reset(&mut self, seed: u64) {
        let parallel_lasers = self.parallel_lasers;
        *self = Self::new(&self.spec, seed);
        self.parallel_lasers = parallel_lasers;
    }

    /// The state as bytes, from which [`Fleet::restored`] makes a fleet that lives on bit by bit as
    /// this one will.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut tape = Tape::writing(spec_fingerprint(&self.spec));
        tape = match self.clone().play(&mut tape) {
            Ok(()) => tape,
            // Writing to memory has no way to fail; an empty tape would be refused when read.
            Err(_) => Tape::Writing(Vec::new()),
        };
        tape.finish()
    }

    /// The fleet of `spec` in the state of a snapshot.
    ///
    /// # Errors
    ///
    /// When the bytes are no snapshot, are damaged, or were taken of a fleet with another spec.
    pub fn restored(spec: &FleetSpec, snapshot: &[u8]) -> Result<Self, SnapshotError> {
        let mut tape = Tape::reading(snapshot, spec_fingerprint(spec))?;
        let mut seed = 0;
        tape.u64(&mut seed).map_err(|_| SnapshotError::Damaged)?;
        let mut fleet = Self::new(spec, seed);
        fleet.play_state(&mut tape).map_err(|_| SnapshotError::Damaged)?;
        if !tape.is_at_end() {
            return Err(SnapshotError::Damaged);
        }
        (0..fleet.robots.len()).for_each(|index| fleet.show_robot(index));
        fleet.show_obstacles();
        Ok(fleet)
    }

    fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.u64(&mut self.seed)?;
        self.play_state(tape)
    }

    fn play_state(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.u64(&mut self.step)?;
        self.bodies.play(tape)?;
        self.robots.iter_mut().try_for_each(|robot| robot.play(tape))?;
        self.obstacles.iter_mut().try_for_each(|obstacle| obstacle.play(tape))
    }
}

/// A number that another spec would hardly have.
fn spec_fingerprint(spec: &FleetSpec) -> u64 {
    fingerprint(format!("{spec:?}").as_bytes())
}
