use super::chance::{Gaussian, Purpose};
use super::eye::Stance;
use super::rays::{Beams, Scene, Scratch};
use super::report::Ping;
use super::snapshot::{Played, Tape};
use super::spec::SonarSpec;

/// The cone of a sonar is filled with beams this far apart, rad: half a degree.
const APART_RAD: f64 = std::f64::consts::PI / 360.0;

/// A sonar on a robot, and what it heard last.
#[derive(Clone)]
pub(super) struct Ear {
    spec: SonarSpec,
    beams: Beams,
    noise: Gaussian,
    pub(super) ping: Option<Ping>,
}

impl Ear {
    /// Sonar `which` of the robot in place `robot`.
    pub(super) fn new(spec: &SonarSpec, seed: u64, robot: usize, which: usize) -> Self {
        let gaps = (spec.cone_rad / APART_RAD).ceil().max(2.0);
        let (first_rad, apart_rad) = (-spec.cone_rad / 2.0, spec.cone_rad / gaps);
        Self {
            spec: *spec,
            beams: Beams::new(first_rad, apart_rad, gaps as usize + 1, spec.range_max_m),
            noise: Gaussian::new(seed, Purpose::Sonar, robot + (which << 24)),
            ping: None,
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        self.noise.play(tape)?;
        let new = || Ping { time_s: 0.0, range_m: 0.0 };
        tape.option(&mut self.ping, new, |tape, ping| {
            tape.f64(&mut ping.time_s)?;
            let mut range_m = f64::from(ping.range_m);
            tape.f64(&mut range_m)?;
            ping.range_m = range_m as f32;
            Ok(())
        })
    }

    /// Whether its next measurement is due at a step.
    pub(super) fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.spec.period_steps)
    }

    /// Listens for the nearest thing, unless it has done so already at that time.
    pub(super) fn listen(&mut self, stance: &Stance, scene: &Scene, scratch: &mut Scratch) {
        if self.ping.is_some_and(|ping| ping.time_s == stance.time_s) {
            return;
        }
        scene.look(&self.beams, &(stance.pose * self.spec.mount), stance.robot, scratch);
        let nearest = scratch.inverse.iter().fold(0.0, |most: f64, inverse| most.max(*inverse));
        let SonarSpec { range_min_m, range_max_m, noise_std_m, .. } = self.spec;
        let measured_m = 1.0 / nearest + noise_std_m * self.noise.draw();
        // REP-117, as for lasers.
        let range_m = if measured_m > range_max_m {
            f32::INFINITY
        } else if measured_m < range_min_m {
            f32::NEG_INFINITY
        } else {
            measured_m as f32
        };
        self.ping = Some(Ping { time_s: stance.time_s, range_m });
    }
}
