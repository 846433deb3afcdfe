use super::{Platform, Surroundings, reported};
use crate::physics::rays::{Beams, Scratch};
use crate::physics::spec::SonarSpec;
use interfaces::{Purpose, RandomStream};
use serde::{Deserialize, Serialize};

/// The angle between two beams of the fan that fills the cone of a sonar, rad: half a degree.
const BEAM_SPACING_RAD: f64 = std::f64::consts::PI / 360.0;

/// The reading of a sonar.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct SonarReading {
    /// The time of the measurement, s.
    pub time_s: f64,
    /// The distance of the nearest surface in the cone, m; −∞ too close, +∞ no surface in range.
    pub range_m: f32,
}

/// A sonar or infrared range sensor.
#[derive(Clone)]
pub(in crate::physics) struct Sonar {
    pub(super) spec: SonarSpec,
    beams: Beams,
    pub(super) noise: RandomStream,
    pub(super) reading: Option<SonarReading>,
}

impl Sonar {
    /// A sonar with a random stream with the index `stream`.
    pub(super) fn new(spec: &SonarSpec, seed: u64, stream: usize) -> Self {
        let gaps = (spec.cone_rad / BEAM_SPACING_RAD).ceil().max(2.0);
        let (first_rad, spacing_rad) = (-spec.cone_rad / 2.0, spec.cone_rad / gaps);
        Self {
            spec: *spec,
            beams: Beams::new(first_rad, spacing_rad, gaps as usize + 1, spec.range_max_m),
            noise: RandomStream::new(seed, Purpose::SonarNoise(stream)),
            reading: None,
        }
    }

    /// Measures, unless there is already a reading of this time. `scratch` is overwritten.
    pub(super) fn measure(&mut self, platform: &Platform, now: &Surroundings<'_>, scratch: &mut Scratch) {
        let time_s = now.time_s;
        if self.reading.is_some_and(|reading| reading.time_s == time_s) {
            return;
        }
        now.scene.cast(&self.beams, &(platform.pose * self.spec.mount), platform.robot, scratch);
        let nearest = scratch.inverse.iter().fold(0.0, |most: f64, inverse| most.max(*inverse));
        let SonarSpec { range_min_m, range_max_m, noise_std_m, .. } = self.spec;
        let measured_m = 1.0 / nearest + noise_std_m * self.noise.normal();
        self.reading = Some(SonarReading { time_s, range_m: reported(measured_m, range_min_m, range_max_m) });
    }
}
