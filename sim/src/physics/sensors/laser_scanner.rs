use super::{Platform, Surroundings, reported};
use crate::physics::rays::{Beams, Scratch};
use crate::physics::spec::LaserSpec;
use interfaces::{LaserReading, Purpose, RandomStream, Twist};
use nalgebra::Isometry2;
use std::sync::Arc;

/// A planar laser scanner.
#[derive(Clone)]
pub(in crate::physics) struct LaserScanner {
    pub(super) spec: LaserSpec,
    beams: Arc<Beams>,
    pub(super) noise: RandomStream,
    pub(super) dropout: RandomStream,
    pub(super) reading: Option<LaserReading>,
}

impl LaserScanner {
    /// A scanner with the `beams` of its spec (see [`SharedBeams`]), and random streams with the index `stream`.
    pub(in crate::physics) fn new(spec: &LaserSpec, beams: Arc<Beams>, seed: u64, stream: usize) -> Self {
        Self {
            spec: *spec,
            beams,
            noise: RandomStream::new(seed, Purpose::LaserNoise(stream)),
            dropout: RandomStream::new(seed, Purpose::LaserDropout(stream)),
            reading: None,
        }
    }

    /// Measures, unless there is already a reading of this time. `scratch` is overwritten.
    pub(super) fn measure(&mut self, platform: &Platform, now: &Surroundings<'_>, scratch: &mut Scratch) {
        let LaserSpec { range_min_m, range_max_m, noise_std_m, dropout, mount, .. } = self.spec;
        let reading = self.reading.get_or_insert_with(|| LaserReading {
            // Before any time, so that the first measurement is a new one.
            time_s: f64::NEG_INFINITY,
            pose: Isometry2::identity(),
            twist: Twist::STOP,
            mount,
            scan: self.spec.empty_scan(),
        });
        if reading.time_s == now.time_s {
            return;
        }
        reading.time_s = now.time_s;
        reading.pose = platform.odometry_pose;
        reading.twist = platform.odometry_twist;
        now.scene.cast(&self.beams, &(platform.pose * mount), platform.robot, scratch);
        let reported = |measured_m: f64| reported(measured_m, range_min_m, range_max_m);
        let ranges_m = &mut reading.scan.ranges_m;
        ranges_m.resize(scratch.inverse.len(), 0.0);
        let beams = ranges_m.iter_mut().zip(&scratch.inverse);
        if noise_std_m > 0.0 {
            for (range_m, inverse) in beams {
                // One draw per beam, whether or not the beam hits anything: the result of one beam never changes
                // the noise of another.
                *range_m = reported(1.0 / inverse + noise_std_m * self.noise.normal());
            }
        } else {
            // A separate loop without a state: the compiler processes several beams at once.
            for (range_m, inverse) in beams {
                *range_m = reported(1.0 / inverse);
            }
        }
        if dropout > 0.0 {
            for range_m in ranges_m {
                // REP-117: a missing measurement is NaN. One draw per beam, as above.
                if self.dropout.bernoulli(dropout) {
                    *range_m = f32::NAN;
                }
            }
        }
    }
}

/// The beams of all lasers. Lasers with the same spec share them.
#[derive(Default)]
pub(in crate::physics) struct SharedBeams {
    known: Vec<(LaserSpec, Arc<Beams>)>,
}

impl SharedBeams {
    pub(in crate::physics) fn of(&mut self, spec: &LaserSpec) -> Arc<Beams> {
        if let Some((_, beams)) = self.known.iter().find(|(known, _)| known == spec) {
            return Arc::clone(beams);
        }
        let (first_rad, spacing_rad) = (spec.angle_min_rad(), spec.angle_increment_rad());
        let beams = Arc::new(Beams::new(first_rad, spacing_rad, spec.beams, spec.range_max_m));
        self.known.push((*spec, Arc::clone(&beams)));
        beams
    }
}
