//! The systematic error of the distances that the odometry of a log measures, from its closed trajectory: where scans fix the
//! position along the motion, they say how long the motion was.
//!
//! Along a bare corridor only the odometry knows how far a robot went, and no loop corrects it: on the way out and back, the
//! corridor is too long by the same share.

use super::graph::PoseGraph;
use nalgebra::{Isometry2, Matrix3, Vector2};

/// Motions of at least this length, m, whose distance the scan fixes with at most this standard deviation, m, at least this many;
/// the noise of the odometry after 1 m, m.
const SCALED_M: f64 = 0.2;
const SCALED_STD_M: f64 = 0.03;
const SCALED_MOTIONS: usize = 30;
const SCALE_NOISE_M: f64 = 0.04;
/// A scale that is off by a smaller share than this, or by fewer standard deviations, needs no second pass.
const MIN_SCALE: f64 = 0.005;
const MIN_SCALE_STDS: f64 = 4.0;
/// A scale beyond this factor, in either direction, is no error of wheels.
const MAX_SCALE: f64 = 2.0;

/// A motion between two keyframes in a row, as the odometry measured it.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredMotion {
    /// The number of the second keyframe.
    pub(super) to: usize,
    pub(super) motion: Isometry2<f64>,
    /// What the scan alone says of the pose of the second keyframe, in the frame of the first one.
    pub(super) information: Matrix3<f64>,
}

/// The true distance per distance that the odometry measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceScale {
    /// The scale; 1 for an odometry without a systematic error.
    pub scale: f64,
    /// Its standard deviation.
    pub std: f64,
}

impl DistanceScale {
    /// Whether the scale is so far from 1 that another pass, with this scale, is better.
    pub fn is_significant(&self) -> bool {
        (self.scale - 1.0).abs() > MIN_SCALE.max(MIN_SCALE_STDS * self.std)
    }

    /// Whether wheels can explain the scale. Other units, or the odometry of another robot, cannot be scaled away.
    pub fn is_plausible(&self) -> bool {
        (MAX_SCALE.recip()..=MAX_SCALE).contains(&self.scale)
    }
}

impl MeasuredMotion {
    /// The true distance per measured one, and the inverse of its variance; `None` where the scan does not fix the distance.
    fn ratio(&self, graph: &PoseGraph) -> Option<(f64, f64)> {
        let measured = self.motion.translation.vector;
        let distance_m = measured.norm();
        if distance_m < SCALED_M {
            return None;
        }
        let along: Vector2<f64> = measured / distance_m;
        let spread = self.information.try_inverse()?.fixed_view::<2, 2>(0, 0).into_owned();
        let variance = along.dot(&(spread * along));
        if variance > SCALED_STD_M * SCALED_STD_M {
            return None;
        }
        let found = graph.poses[self.to - 1].inv_mul(&graph.poses[self.to]).translation.vector;
        let variance = variance + SCALE_NOISE_M * SCALE_NOISE_M * distance_m;
        Some((found.dot(&along) / distance_m, distance_m * distance_m / variance))
    }
}

/// The scale of the distances of an odometry; `None` where too few scans fix them.
pub(super) fn distance_scale(motions: &[MeasuredMotion], graph: &PoseGraph) -> Option<DistanceScale> {
    let mut ratios: Vec<(f64, f64)> = motions.iter().filter_map(|motion| motion.ratio(graph)).collect();
    if ratios.len() < SCALED_MOTIONS {
        return None;
    }
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Glitches, and scans that were put in the wrong place, are in the outer quarters.
    let quarter = ratios.len() / 4;
    let middle = &ratios[quarter..ratios.len() - quarter];
    let weight: f64 = middle.iter().map(|(_, weight)| weight).sum();
    let scale = middle.iter().map(|(ratio, weight)| ratio * weight).sum::<f64>() / weight;
    // The quartiles of a normal distribution are 1.35 standard deviations apart.
    let std = (middle[middle.len() - 1].0 - middle[0].0) / 1.35 / (ratios.len() as f64).sqrt();
    Some(DistanceScale { scale, std })
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::pose;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Normal};

    /// Steps of 0.5 m along a bent way, which the odometry measures too long by `error`, with noise; every tenth pose is wrong.
    /// The scans fix a position with these standard deviations along and across the motion, m.
    fn measured(error: f64, steps: usize, stds_m: [f64; 2]) -> (Vec<MeasuredMotion>, PoseGraph) {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let noise = Normal::new(0.0, 0.01).unwrap();
        let mut graph = PoseGraph { poses: vec![Isometry2::identity()], edges: Vec::new() };
        let information =
            Matrix3::from_diagonal(&[stds_m[0], stds_m[1], 0.01].map(|std| 1.0 / (std * std)).into());
        let mut motions = Vec::new();
        for to in 1..=steps {
            let true_m = if to % 10 == 0 { 0.9 } else { 0.5 };
            let measured_m = 0.5 * (1.0 + error) + noise.sample(&mut rng);
            graph.poses.push(graph.poses[to - 1] * pose(true_m, 0.0, 0.1));
            motions.push(MeasuredMotion { to, motion: pose(measured_m, 0.0, 0.1), information });
        }
        (motions, graph)
    }

    #[test]
    fn the_scale_is_that_of_most_motions() {
        for error in [-0.05, 0.03, 0.0] {
            let (motions, graph) = measured(error, 500, [0.01, 0.01]);
            let found = distance_scale(&motions, &graph).unwrap();
            let off = found.scale - 1.0 / (1.0 + error);
            assert!(off.abs() < 3.5 * found.std && found.std < 0.003, "{off} of {found:?}");
            assert_eq!(found.is_significant(), error != 0.0, "{found:?}");
        }
    }

    #[test]
    fn a_scale_beyond_a_factor_of_two_is_no_error_of_wheels() {
        let is_plausible = |scale| DistanceScale { scale, std: 0.001 }.is_plausible();
        assert_eq!([0.49, 0.51, 1.9, 2.1].map(is_plausible), [false, true, true, false]);
    }

    #[test]
    fn a_scale_needs_scans_that_fix_the_position_along_the_motion() {
        let is_known = |steps, stds_m| {
            let (motions, graph) = measured(0.03, steps, stds_m);
            distance_scale(&motions, &graph).is_some()
        };
        assert!(is_known(SCALED_MOTIONS, [0.01, 0.01]) && is_known(500, [0.01, 1.0]));
        // Along a bare corridor; where nothing at all is seen along it; too few motions.
        assert!(!is_known(500, [1.0, 0.01]));
        assert!(!is_known(500, [f64::INFINITY, 0.01]));
        assert!(!is_known(SCALED_MOTIONS - 1, [0.01, 0.01]));
    }
}
