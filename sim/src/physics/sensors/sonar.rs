use super::on_demand::{Device, Look};
use super::{SharedBeams, reported};
use crate::physics::rays::{Beams, Ring};
use crate::physics::spec::SonarSpec;
use interfaces::RandomStream;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

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
pub(crate) struct Sonar {
    pub(super) spec: SonarSpec,
    beams: Arc<Beams>,
    /// Of all sensors of the robot.
    ring: Ring,
}

impl Sonar {
    pub(super) fn new(spec: &SonarSpec, beams: &mut SharedBeams, ring: Ring) -> Self {
        let gaps = (spec.cone_rad / BEAM_SPACING_RAD).ceil().max(2.0);
        let (first_rad, spacing_rad) = (-spec.cone_rad / 2.0, spec.cone_rad / gaps);
        let beams = beams.of(first_rad, spacing_rad, gaps as usize + 1, spec.range_max_m);
        Self { spec: *spec, beams, ring }
    }
}

impl Device for Sonar {
    type Reading = SonarReading;
    type Streams = RandomStream;

    fn measure(&self, look: &Look, noise: &mut RandomStream, _: Option<SonarReading>) -> SonarReading {
        let Look { platform, surroundings, .. } = look;
        let SonarSpec { range_min_m, range_max_m, noise_std_m, mount, .. } = self.spec;
        let nearest =
            surroundings.scene.nearest(&self.beams, &(platform.pose * mount), look.vicinity(&self.ring));
        let noise_m = if noise_std_m > 0.0 { noise_std_m * noise.normal() } else { 0.0 };
        let measured_m = 1.0 / nearest + noise_m;
        let range_m = reported(measured_m, range_min_m, range_max_m);
        SonarReading { time_s: surroundings.time_s, range_m }
    }

    fn skip(&self, noise: &mut RandomStream) {
        if self.spec.noise_std_m > 0.0 {
            noise.normal();
        }
    }

    fn time_s(reading: &SonarReading) -> Option<f64> {
        Some(reading.time_s)
    }
}
