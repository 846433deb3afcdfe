use super::on_demand::{Device, Look};
use super::{SharedBeams, reported};
use crate::physics::rays::{Beams, Ray};
use crate::physics::spec::LaserSpec;
use interfaces::{LaserReading, RandomStream, Scan};
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// A beam with a width is this number of rays, beside the one in its middle.
const RAYS: usize = 8;
/// A surface that gets a smaller share of a beam does not change its range.
const MIN_SHARE: f64 = 0.25;

/// A planar laser scanner.
#[derive(Clone)]
pub(crate) struct LaserScanner {
    pub(super) spec: LaserSpec,
    beams: Arc<Beams>,
}

/// The random streams of a laser scanner.
#[derive(Clone)]
pub(crate) struct LaserStreams {
    pub(super) noise: RandomStream,
    pub(super) dropout: RandomStream,
}

impl LaserScanner {
    pub(crate) fn new(spec: &LaserSpec, beams: &mut SharedBeams) -> Self {
        Self { spec: *spec, beams: beams.of_laser(spec) }
    }

    /// The beams of a scan that sweeps.
    fn rays(&self, look: &Look, scan: &Scan) -> Vec<Ray> {
        let (robot, recent) = (look.platform.robot, &look.surroundings.recent);
        let mut motion = (usize::MAX, recent.motion(robot, 0));
        let directions = self.beams.directions().enumerate();
        let rays = directions.map(|(beam, (x, y))| {
            let (interval, share) = recent.at(scan.age_s(beam));
            if motion.0 != interval {
                motion = (interval, recent.motion(robot, interval));
            }
            let laser = motion.1.pose(share) * self.spec.mount;
            let (from, along) = (laser.translation.vector.into(), laser.rotation * Vector2::new(x, y));
            Ray { from, along, interval, share }
        });
        rays.collect()
    }

    /// The reading of this time without ranges, in the memory of a spare one.
    fn empty_reading(&self, look: &Look, spare: Option<LaserReading>) -> LaserReading {
        let Look { platform, surroundings, .. } = look;
        let (scan, mut velocities) = spare
            .map_or_else(|| (self.spec.empty_scan(), Vec::new()), |spare| (spare.scan, spare.velocities));
        velocities.clear();
        if self.spec.sweep_s > 0.0 {
            velocities.extend(surroundings.recent.velocities(platform.robot, surroundings.time_s));
        }
        LaserReading {
            time_s: surroundings.time_s,
            pose: platform.odometry_pose,
            twist: platform.odometry_twist,
            velocities,
            mount: self.spec.mount,
            scan,
        }
    }

    /// Takes the ranges of beams that end in glass. `exact`: one over the range without noise of each beam, 1/m.
    fn swallow(&self, look: &Look, rays: &[Ray], exact: &[f64], ranges_m: &mut [f32]) {
        let laser = look.platform.pose * self.spec.mount;
        for (beam, (inverse, (x, y))) in exact.iter().zip(self.beams.directions()).enumerate() {
            let (from, along) = rays.get(beam).map_or_else(
                || (laser.translation.vector.into(), laser.rotation * Vector2::new(x, y)),
                |ray| (ray.from, ray.along),
            );
            let end: Point2<f64> = from + along / *inverse;
            if *inverse > 0.0 && look.surroundings.glass.iter().any(|glass| glass.swallows(&end, &along)) {
                ranges_m[beam] = f32::INFINITY;
            }
        }
    }

    /// One over the ranges of beams with a width, 1/m. `rays`: the beams of a scan that sweeps.
    fn mixed(&self, look: &Look, rays: &[Ray]) -> Vec<f64> {
        let Look { platform, surroundings, .. } = look;
        let (scene, laser) = (&surroundings.scene, platform.pose * self.spec.mount);
        let cast = |share: f64| {
            let turn = interfaces::rotation(self.spec.beam_width_rad * share);
            let turned: Vec<_> = rays.iter().map(|ray| Ray { along: turn * ray.along, ..*ray }).collect();
            if rays.is_empty() {
                scene.cast(&self.beams, &(laser * turn), platform.robot, <[f64]>::to_vec)
            } else {
                let (bodies, range_max_m) = (&surroundings.recent.bodies, self.spec.range_max_m);
                scene.sweep(&turned, bodies, range_max_m, platform.robot, <[f64]>::to_vec)
            }
        };
        let parts: Vec<_> = (0..RAYS).map(|ray| cast((ray as f64 + 0.5) / RAYS as f64 - 0.5)).collect();
        let middle = cast(0.0).into_iter().enumerate();
        middle.map(|(beam, middle)| mixed(parts.iter().map(|part| 1.0 / part[beam]), middle)).collect()
    }
}

/// One over the range of a beam whose rays have these ranges (m), and the ray in its middle one over the range `middle`:
/// the mean, if a near and a far surface both have a good share.
fn mixed(ranges_m: impl Iterator<Item = f64> + Clone, middle: f64) -> f64 {
    let (near_m, far_m) =
        (ranges_m.clone().fold(f64::INFINITY, f64::min), ranges_m.clone().fold(0.0, f64::max));
    let near = ranges_m.clone().filter(|range_m| *range_m < (near_m + far_m) / 2.0).count();
    let is_mixed = (MIN_SHARE..=1.0 - MIN_SHARE).contains(&(near as f64 / RAYS as f64));
    if is_mixed && far_m.is_finite() { RAYS as f64 / ranges_m.sum::<f64>() } else { middle }
}

impl Device for LaserScanner {
    type Reading = LaserReading;
    type Streams = LaserStreams;

    fn measure(&self, look: &Look, streams: &mut LaserStreams, spare: Option<LaserReading>) -> LaserReading {
        let Look { platform, surroundings, .. } = look;
        let LaserSpec { range_min_m, range_max_m, noise_std_m, dropout, mount, sweep_s, .. } = self.spec;
        let mut reading = self.empty_reading(look, spare);
        let rays = if sweep_s > 0.0 { self.rays(look, &reading.scan) } else { Vec::new() };
        let reported = move |measured_m: f64| reported(measured_m, range_min_m, range_max_m);
        let (glass, mut exact) = (&surroundings.glass, Vec::new());
        let ranges_m = &mut reading.scan.ranges_m;
        let (scene, noise) = (&surroundings.scene, &mut streams.noise);
        // By value: the limits cannot be among the ranges that are written, so that the loops below need not read them
        // again for every beam.
        let kept = &mut exact;
        let mut report = move |inverses: &[f64]| {
            if !glass.is_empty() {
                kept.extend_from_slice(inverses);
            }
            ranges_m.resize(inverses.len(), 0.0);
            let beams = ranges_m.iter_mut().zip(inverses);
            if noise_std_m > 0.0 {
                for (range_m, inverse) in beams {
                    // One draw per beam, whether or not the beam hits anything: the result of one beam never changes
                    // the noise of another.
                    *range_m = reported(1.0 / inverse + noise_std_m * noise.normal());
                }
            } else {
                // A separate loop without a state: the compiler processes several beams at once.
                for (range_m, inverse) in beams {
                    *range_m = reported(1.0 / inverse);
                }
            }
        };
        if self.spec.beam_width_rad > 0.0 {
            report(&self.mixed(look, &rays));
        } else if rays.is_empty() {
            scene.cast(&self.beams, &(platform.pose * mount), platform.robot, report);
        } else {
            scene.sweep(&rays, &surroundings.recent.bodies, range_max_m, platform.robot, report);
        }
        self.swallow(look, &rays, &exact, &mut reading.scan.ranges_m);
        if dropout > 0.0 {
            for range_m in &mut reading.scan.ranges_m {
                // REP-117: a missing measurement is NaN. One draw per beam, as above.
                if streams.dropout.bernoulli(dropout) {
                    *range_m = f32::NAN;
                }
            }
        }
        reading
    }

    fn skip(&self, streams: &mut LaserStreams) {
        let LaserSpec { beams, noise_std_m, dropout, .. } = self.spec;
        for _ in 0..beams {
            if noise_std_m > 0.0 {
                streams.noise.normal();
            }
            if dropout > 0.0 {
                streams.dropout.bernoulli(dropout);
            }
        }
    }

    fn time_s(reading: &LaserReading) -> f64 {
        reading.time_s
    }
}
