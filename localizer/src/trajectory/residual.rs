//! How far scans are from the surfaces that others have seen: what remains of the errors of ranges and poses.

use super::graph::PoseGraph;
use super::keyframe::Keyframe;
use super::matching::thinned;
use super::places::Places;
use super::refine::near;
use crate::surfel_map::SurfelMap;

/// One of this many keyframes is compared with a submap.
const STRIDE: usize = 7;
/// The number of points of a keyframe that are compared.
const MOST_POINTS: usize = 60;
/// A point farther from a surface than this is on another one, m.
const GATE_M: f64 = 0.25;
/// The standard deviation of a normal distribution, in medians of the absolute value.
const STD_PER_MEDIAN: f64 = 1.4826;
/// Fewer points say nothing.
const LEAST_POINTS: usize = 200;

/// The standard deviation of the distances of points from the surfaces of submaps to which they do not belong, m, along
/// the trajectory as it is. It is robust: things that moved between do not count. `None` if no place was seen twice.
pub(super) fn std_m(places: &Places, keyframes: &[Keyframe], graph: &PoseGraph) -> Option<f64> {
    let mut distances_m = Vec::new();
    for (number, submap) in places.references() {
        let Some(map) = SurfelMap::of_points(&submap.points) else { continue };
        for keyframe in near(submap, graph).filter(|near| (near + number) % STRIDE == 0) {
            let pose = graph.poses[submap.anchor].inv_mul(&graph.poses[keyframe]);
            let points = thinned(&keyframes[keyframe].points, MOST_POINTS);
            distances_m.extend(points.iter().filter_map(|point| {
                let nearest = map.nearest(&(pose * point.at), &(pose.rotation * point.normal), GATE_M);
                nearest.map(|(_, off_m)| off_m.abs())
            }));
        }
    }
    if distances_m.len() < LEAST_POINTS {
        return None;
    }
    let middle = distances_m.len() / 2;
    let (_, median_m, _) = distances_m.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median_m * STD_PER_MEDIAN)
}
