use super::on_demand::{Device, Look};
use crate::physics::form::Form;
use crate::physics::rays::{Beams, Ring};
use crate::physics::report::Body;
use crate::physics::spec::FiducialSpec;
use interfaces::rotation;
use nalgebra::{Isometry2, Point2};
use serde::{Deserialize, Serialize};

/// A ray counts as hitting a body if the ray ends within this distance of its surface, m.
const ON_SURFACE_M: f64 = 1e-6;

/// A detected body with a tag.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Fiducial {
    /// The tag of the body.
    pub tag: u32,
    /// The body that was detected.
    pub body: Body,
    /// The direction of the center of the body in the frame of the finder, counter-clockwise, rad.
    pub bearing_rad: f64,
    /// The distance to the center of the body, m.
    pub range_m: f64,
}

/// A body with a tag.
pub(crate) struct Tagged {
    pub(crate) tag: u32,
    pub(crate) body: Body,
    /// The center, m.
    pub(crate) center: Point2<f64>,
    pub(crate) form: Form,
}

/// A sensor that detects bodies with a tag.
#[derive(Clone)]
pub(crate) struct FiducialFinder {
    pub(super) spec: FiducialSpec,
    /// A single beam straight ahead.
    beam: Beams,
    /// Of all sensors of the robot.
    ring: Ring,
}

impl FiducialFinder {
    pub(super) fn new(spec: &FiducialSpec, ring: Ring) -> Self {
        Self { spec: *spec, beam: Beams::new(0.0, 1.0, 1, spec.range_max_m), ring }
    }
}

impl Device for FiducialFinder {
    type Reading = Vec<Fiducial>;
    type Streams = ();

    fn measure(&self, look: &Look, (): &mut (), spare: Option<Vec<Fiducial>>) -> Vec<Fiducial> {
        let Look { platform, surroundings, .. } = look;
        let pose = platform.pose * self.spec.mount;
        let mut bodies = spare.unwrap_or_default();
        bodies.clear();
        let own = Body::Robot(platform.robot);
        for &Tagged { tag, body, center, ref form } in surroundings.tagged.iter().filter(|it| it.body != own)
        {
            let to = pose.inverse_transform_point(&center).coords;
            let (range_m, bearing_rad) = (to.norm(), libm::atan2(to.y, to.x));
            if range_m > self.spec.range_max_m || bearing_rad.abs() > self.spec.fov_rad / 2.0 + 1e-12 {
                continue;
            }
            // The first body that the ray to the center hits must be the body itself.
            let ray = pose * Isometry2::from_parts(nalgebra::Translation2::identity(), rotation(bearing_rad));
            let first_m = 1.0 / surroundings.scene.nearest(&self.beam, &ray, look.vicinity(&self.ring));
            if first_m > range_m || form.gap_m_to(&(ray * Point2::new(first_m, 0.0))) < ON_SURFACE_M {
                bodies.push(Fiducial { tag, body, bearing_rad, range_m });
            }
        }
        bodies
    }

    fn skip(&self, (): &mut ()) {}

    fn time_s(_: &Vec<Fiducial>) -> Option<f64> {
        None
    }
}
