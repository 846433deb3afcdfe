//! The state of a fleet: reset to the start, to bytes, and from bytes.

use super::Fleet;
use super::start::Start;
use crate::physics::snapshot::{self, SnapshotError, value};
use crate::physics::spec::FleetSpec;
use interfaces::{Values, values};
use std::sync::Arc;

impl Fleet {
    /// Resets the fleet to the start, with the same seed or another one: the result is that of [`Fleet::new`] with the
    /// same spec, bit for bit. The place is kept, so that a reset takes little more time than a clone.
    pub fn reset(&mut self, seed: u64) {
        let parallel_lasers = self.parallel_lasers;
        *self = Self::begin(Arc::clone(&self.start), seed);
        self.parallel_lasers = parallel_lasers;
    }

    /// The state as bytes. A fleet that [`Fleet::restored`] makes from the bytes continues bit for bit like
    /// this one.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut fleet = self.clone();
        let mut seed = fleet.seed;
        let mut values = vec![value(&mut seed)];
        values.extend(fleet.values());
        snapshot::write(fingerprint(self.spec()), values)
    }

    /// The fleet of `spec` in the state of a snapshot.
    ///
    /// # Errors
    ///
    /// When the bytes are not a snapshot, are damaged, or were taken of a fleet with another spec.
    pub fn restored(spec: &FleetSpec, snapshot: &[u8]) -> Result<Self, SnapshotError> {
        let bytes = snapshot::check(snapshot, fingerprint(spec))?;
        Self::at_snapshot(Arc::new(Start::new(spec)), bytes)
    }

    /// Returns to the state of a snapshot of a fleet with the same spec. The place is kept, as in [`Fleet::reset`].
    ///
    /// # Errors
    ///
    /// The errors of [`Fleet::restored`]. The state is then unchanged.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), SnapshotError> {
        let bytes = snapshot::check(snapshot, fingerprint(self.spec()))?;
        let parallel_lasers = self.parallel_lasers;
        *self = Self::at_snapshot(Arc::clone(&self.start), bytes)?;
        self.parallel_lasers = parallel_lasers;
        Ok(())
    }

    fn at_snapshot(start: Arc<Start>, mut bytes: &[u8]) -> Result<Self, SnapshotError> {
        let mut seed = 0_u64;
        snapshot::read(&mut bytes, vec![value(&mut seed)])?;
        let mut fleet = Self::begin(start, seed);
        snapshot::read(&mut bytes, fleet.values())?;
        if !bytes.is_empty() {
            return Err(SnapshotError::Damaged);
        }
        (0..fleet.robots.len()).for_each(|index| fleet.show_robot(index));
        (0..fleet.obstacles.len()).for_each(|index| fleet.show_obstacle(index));
        Ok(fleet)
    }

    fn values(&mut self) -> Values<'_> {
        let mut values = values![self.step; self.bodies, self.past];
        values.extend(self.robots.iter_mut().flat_map(|robot| robot.values()));
        values.extend(self.obstacles.iter_mut().flat_map(|obstacle| obstacle.values()));
        values
    }
}

/// A number that differs between specs.
fn fingerprint(spec: &FleetSpec) -> u64 {
    snapshot::fingerprint(format!("{spec:?}").as_bytes())
}
