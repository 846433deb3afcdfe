//! The state of a fleet: reset to the start, to bytes, and from bytes.

use super::Fleet;
use crate::physics::snapshot::{self, SnapshotError, Values, value};
use crate::physics::spec::FleetSpec;

impl Fleet {
    /// Resets the fleet to the start, with the same seed or another one.
    pub fn reset(&mut self, seed: u64) {
        let parallel_lasers = self.parallel_lasers;
        *self = Self::new(&self.spec, seed);
        self.parallel_lasers = parallel_lasers;
    }

    /// The state as bytes. A fleet that [`Fleet::restored`] makes from the bytes continues bit for bit like
    /// this one.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut fleet = self.clone();
        let mut seed = fleet.seed;
        let mut values = vec![value(&mut seed)];
        values.extend(fleet.values());
        snapshot::write(fingerprint(&self.spec), values)
    }

    /// The fleet of `spec` in the state of a snapshot.
    ///
    /// # Errors
    ///
    /// When the bytes are not a snapshot, are damaged, or were taken of a fleet with another spec.
    pub fn restored(spec: &FleetSpec, snapshot: &[u8]) -> Result<Self, SnapshotError> {
        let mut bytes = snapshot::check(snapshot, fingerprint(spec))?;
        let mut seed = 0_u64;
        snapshot::read(&mut bytes, vec![value(&mut seed)])?;
        let mut fleet = Self::new(spec, seed);
        snapshot::read(&mut bytes, fleet.values())?;
        if !bytes.is_empty() {
            return Err(SnapshotError::Damaged);
        }
        (0..fleet.robots.len()).for_each(|index| fleet.show_robot(index));
        fleet.show_obstacles();
        Ok(fleet)
    }

    fn values(&mut self) -> Values<'_> {
        let mut values = vec![value(&mut self.step)];
        values.extend(self.bodies.values());
        values.extend(self.past.values());
        values.extend(self.robots.iter_mut().flat_map(|robot| robot.values()));
        values.extend(self.obstacles.iter_mut().flat_map(|obstacle| obstacle.values()));
        values
    }
}

/// A number that differs between specs.
fn fingerprint(spec: &FleetSpec) -> u64 {
    snapshot::fingerprint(format!("{spec:?}").as_bytes())
}
