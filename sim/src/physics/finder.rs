use super::eye::Stance;
use super::form::Form;
use super::rays::{Beams, Scene, Scratch};
use super::report::{Body, Fiducial};
use super::snapshot::{Played, Tape};
use super::spec::FiducialSpec;
use interfaces::rotation;
use nalgebra::{Isometry2, Point2};

/// A ray counts as meeting a thing if it ends within this of its surface, m.
const NEAR_M: f64 = 1e-6;

/// Something with a tag.
pub(super) struct Tagged {
    pub(super) tag: u32,
    pub(super) body: Body,
    /// Its middle, m.
    pub(super) center: Point2<f64>,
    pub(super) form: Form,
}

/// A fiducial finder on a robot, and what it found last.
#[derive(Clone)]
pub(super) struct Finder {
    spec: FiducialSpec,
    /// A single beam straight ahead.
    beam: Beams,
    pub(super) found: Vec<Fiducial>,
}

impl Finder {
    /// A finder that has not looked yet.
    pub(super) fn new(spec: &FiducialSpec) -> Self {
        Self { spec: *spec, beam: Beams::new(0.0, 1.0, 1, spec.range_max_m), found: Vec::new() }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        let new = Fiducial { tag: 0, body: Body::Wall(0), bearing_rad: 0.0, range_m: 0.0 };
        tape.list(&mut self.found, new, |tape, found| {
            tape.u32(&mut found.tag)?;
            tape.body(&mut found.body)?;
            tape.f64(&mut found.bearing_rad)?;
            tape.f64(&mut found.range_m)
        })
    }

    /// Whether its next look is due at a step.
    pub(super) fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.spec.period_steps)
    }

    /// Looks for everything that has a tag.
    pub(super) fn look(&mut self, stance: &Stance, things: &[Tagged], scene: &Scene, scratch: &mut Scratch) {
        let pose = stance.pose * self.spec.mount;
        self.found.clear();
        for thing in things.iter().filter(|thing| thing.body != Body::Robot(stance.robot)) {
            let to = pose.inverse_transform_point(&thing.center).coords;
            let (range_m, bearing_rad) = (to.norm(), libm::atan2(to.y, to.x));
            if range_m > self.spec.range_max_m || bearing_rad.abs() > self.spec.fov_rad / 2.0 + 1e-12 {
                continue;
            }
            // What the ray to its middle meets first must be itself.
            let ray = pose * Isometry2::from_parts(nalgebra::Translation2::identity(), rotation(bearing_rad));
            scene.look(&self.beam, &ray, stance.robot, scratch);
            let first_m = 1.0 / scratch.inverse[0];
            if first_m > range_m || thing.form.gap_m_to(&(ray * Point2::new(first_m, 0.0))) < NEAR_M {
                self.found.push(Fiducial { tag: thing.tag, body: thing.body, bearing_rad, range_m });
            }
        }
    }
}
