//! How far scans are from the surfaces that others have seen: what remains of the errors of ranges and poses.

use super::graph::PoseGraph;
use super::keyframe::Keyframe;
use super::places::Places;
use super::refine::near;
use crate::surfel_map::SurfelMap;

/// One of this many keyframes is compared with a submap.
const STRIDE: usize = 7;
/// A point farther from a surface than this is on another one, m.
const GATE_M: f64 = 0.25;
/// The standard deviation of a normal distribution, in medians of the absolute value.
const STD_PER_MEDIAN: f64 = 1.4826;
/// The share of the points before the tail.
const TAIL: f64 = 0.97;
/// Fewer points say nothing.
const LEAST_POINTS: usize = 200;

/// The distances of scans from the surfaces that were seen in other passes: the errors of ranges and poses together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The standard deviation, m. It is robust: things that moved between do not count.
    pub std_m: f64,
    /// The distance below which 97 % of the points lie, m; 2.2 standard deviations of normal noise. Real scans have more of
    /// large distances: at edges, plants and glass.
    pub tail_m: f64,
}

/// The distances of points from the surfaces of submaps to which they do not belong, along the trajectory as it is. `None` if
/// no place was seen twice.
pub(super) fn residual(places: &Places, keyframes: &[Keyframe], graph: &PoseGraph) -> Option<Residual> {
    let mut distances_m = Vec::new();
    for (number, submap) in places.references() {
        let Some(map) = SurfelMap::of_points(&submap.points) else { continue };
        for keyframe in near(submap, graph).filter(|near| (near + number) % STRIDE == 0) {
            let pose = graph.poses[submap.anchor].inv_mul(&graph.poses[keyframe]);
            distances_m.extend(keyframes[keyframe].points.iter().filter_map(|point| {
                let nearest = map.nearest(&(pose * point.at), &(pose.rotation * point.normal), GATE_M);
                nearest.map(|(_, off_m)| off_m.abs())
            }));
        }
    }
    if distances_m.len() < LEAST_POINTS {
        return None;
    }
    let mut at = |share: f64| {
        let index = (distances_m.len() as f64 * share) as usize;
        *distances_m.select_nth_unstable_by(index, f64::total_cmp).1
    };
    Some(Residual { std_m: at(0.5) * STD_PER_MEDIAN, tail_m: at(TAIL) })
}
