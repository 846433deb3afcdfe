use super::chance::Gaussian;
use super::fan::Fan;
use super::spec::LaserSpec;
use geometry::Scan;
use nalgebra::{Isometry2, Point2};

/// Everything that a laser can see.
#[derive(Clone, Debug, Default)]
pub(super) struct Scene {
    /// Walls and the obstacles that stand now, corners counter-clockwise, m.
    pub(super) boxes: Vec<[Point2<f64>; 4]>,
    /// The bodies of the robots, by the robots' order: middle (m) and radius (m).
    pub(super) discs: Vec<(Point2<f64>, f64)>,
}

/// A laser at work.
#[derive(Clone, Debug)]
pub(super) struct Laser {
    spec: LaserSpec,
    fan: Fan,
    noise: Gaussian,
}

impl Laser {
    pub(super) fn new(spec: &LaserSpec, noise: Gaussian) -> Self {
        let (start, step) = (spec.angle_min_rad(), spec.angle_increment_rad());
        Self { spec: *spec, fan: Fan::new(start, step, spec.beams, spec.range_max_m), noise }
    }

    /// The unit vectors of the beams in the laser's frame.
    pub(super) fn directions(&self) -> impl Iterator<Item = (f64, f64)> {
        self.fan.directions()
    }

    /// The scan from a laser at `pose` on the robot in place `own`, which it never sees.
    pub(super) fn scan(&mut self, pose: &Isometry2<f64>, scene: &Scene, own: usize, into: &mut Scan) {
        self.fan.clear();
        for corners in &scene.boxes {
            self.fan.add_polygon(pose, corners);
        }
        for (_, (center, radius_m)) in scene.discs.iter().enumerate().filter(|(robot, _)| *robot != own) {
            self.fan.add_disc(pose, center, *radius_m);
        }
        let LaserSpec { range_min_m, range_max_m, noise_std_m, .. } = self.spec;
        let noise = &mut self.noise;
        into.ranges_m.clear();
        into.ranges_m.extend(self.fan.ranges_m().map(|range_m| {
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
