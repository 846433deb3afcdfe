use super::chance::{Gaussian, Uniform};
use super::rays::{Beams, Scene, Scratch};
use super::snapshot::{Played, Tape};
use super::spec::LaserSpec;
use interfaces::Scan;
use nalgebra::Isometry2;
use std::sync::Arc;

/// A laser at work.
#[derive(Clone, Debug)]
pub(super) struct Laser {
    spec: LaserSpec,
    beams: Arc<Beams>,
    noise: Gaussian,
    dropout: Uniform,
}

impl Laser {
    /// A laser with `beams`, which are [`beams`] of its spec.
    pub(super) fn new(spec: &LaserSpec, beams: Arc<Beams>, noise: Gaussian, dropout: Uniform) -> Self {
        Self { spec: *spec, beams, noise, dropout }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        self.noise.play(tape)?;
        self.dropout.play(tape)
    }

    /// The scan from a laser at `pose` on the robot in place `own`, which it never sees. `scratch`
    /// is overwritten.
    pub(super) fn scan(
        &mut self,
        pose: &Isometry2<f64>,
        scene: &Scene,
        own: usize,
        scratch: &mut Scratch,
        into: &mut Scan,
    ) {
        scene.look(&self.beams, pose, own, scratch);
        let LaserSpec { range_min_m, range_max_m, noise_std_m, dropout, .. } = self.spec;
        // REP-117: too far is +∞, too close −∞.
        let reported = |measured_m: f64| {
            if measured_m > range_max_m {
                f32::INFINITY
            } else if measured_m < range_min_m {
                f32::NEG_INFINITY
            } else {
                measured_m as f32
            }
        };
        into.ranges_m.resize(scratch.inverse.len(), 0.0);
        let beams = into.ranges_m.iter_mut().zip(&scratch.inverse);
        if noise_std_m > 0.0 {
            for (range_m, inverse) in beams {
                // One draw per beam, hit or not: what one beam meets never changes another's noise.
                *range_m = reported(1.0 / inverse + noise_std_m * self.noise.draw());
            }
        } else {
            // A loop of its own, without a state: several beams at once.
            for (range_m, inverse) in beams {
                *range_m = reported(1.0 / inverse);
            }
        }
        if dropout > 0.0 {
            for range_m in &mut into.ranges_m {
                // REP-117: what was not measured is not a number. One draw per beam, as above.
                if self.dropout.between(0.0..1.0) < dropout {
                    *range_m = f32::NAN;
                }
            }
        }
    }
}

/// The beams of a laser.
pub(super) fn beams(spec: &LaserSpec) -> Beams {
    Beams::new(spec.angle_min_rad(), spec.angle_increment_rad(), spec.beams, spec.range_max_m)
}
