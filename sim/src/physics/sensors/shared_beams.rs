use crate::physics::rays::Beams;
use crate::physics::spec::LaserSpec;
use std::sync::Arc;

/// The beams of all lasers and sonars. Sensors with the same beams share them.
#[derive(Clone, Default)]
pub(crate) struct SharedBeams {
    known: Vec<(Key, Arc<Beams>)>,
}

/// First angle, spacing and maximum range, and the number of beams.
type Key = ([f64; 3], usize);

impl SharedBeams {
    /// See [`Beams::new`].
    pub(super) fn of(
        &mut self,
        first_rad: f64,
        spacing_rad: f64,
        count: usize,
        range_max_m: f64,
    ) -> Arc<Beams> {
        let key = ([first_rad, spacing_rad, range_max_m], count);
        if let Some((_, beams)) = self.known.iter().find(|(known, _)| *known == key) {
            return Arc::clone(beams);
        }
        let beams = Arc::new(Beams::new(first_rad, spacing_rad, count, range_max_m));
        self.known.push((key, Arc::clone(&beams)));
        beams
    }

    /// The beams of a laser.
    pub(crate) fn of_laser(&mut self, spec: &LaserSpec) -> Arc<Beams> {
        self.of(spec.angle_min_rad(), spec.angle_increment_rad(), spec.beams, spec.range_max_m)
    }
}
