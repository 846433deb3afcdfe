//! The systematic error of the distances that the odometry of a log measures, from its closed trajectory: where scans fix the
//! position along the motion, they say how long the motion was.
//!
//! Along a bare corridor only the odometry knows how far a robot went, and no loop corrects it: on the way out and back, the
//! corridor is too long by the same share.

use super::graph::PoseGraph;
use crate::constants::{MIN_SCALE, MIN_SCALE_STDS, SCALE_NOISE_M, SCALED_M, SCALED_MOTIONS, SCALED_STD_M};
use nalgebra::{Isometry2, Matrix3, Vector2};

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
