use super::chance::Gaussian;
use super::rays::{Beams, Scene, Scratch};
use super::snapshot::{Played, Tape};
use super::spec::LaserSpec;
use geometry::Scan;
use nalgebra::Isometry2;
use std::sync::Arc;

/// A laser at work.
#[derive(Clone, Debug)]
pub(super) struct Laser {
    spec: LaserSpec,
    beams: Arc<Beams>,
    noise: Gaussian,
}

impl Laser {
    /// A laser with `beams`, which are [`beams`] of its spec.
    pub(super) fn new(spec: &LaserSpec, beams: Arc<Beams>, noise: Gaussian) -> Self {
        Self { spec: *spec, beams, noise }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        self.noise.play(tape)
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
        let LaserSpec { range_min_m, range_max_m, noise_std_m, .. } = self.spec;
        let noise = &mut self.noise;
        into.ranges_m.clear();
        into.ranges_m.extend(scratch.inverse.iter().map(|inverse| {
            let range_m = 1.0 / inverse;
            // One draw per beam, hit or not: what one beam meets never changes another's noise.
            let measured_m = if noise_std_m > 0.0 { range_m + noise_std_m * noise.draw() } else { range_m };
            // REP-117: too far is +∞, too close −∞.
            if measured_m > range_max_m {
                f32::INFINITY
            } else if measured_m < range_min_m {
                f32::NEG_INFINITY
            } else {
                measured_m as f32
            }
        }));
    }
}

/// The beams of a laser.
pub(super) fn beams(spec: &LaserSpec) -> Beams {
    Beams::new(spec.angle_min_rad(), spec.angle_increment_rad(), spec.beams, spec.range_max_m)
}
