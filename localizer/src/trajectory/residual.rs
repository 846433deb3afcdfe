//! How far scans are from the surfaces that others have seen: what remains of the errors of ranges and poses.

use super::graph::PoseGraph;
use super::keyframe::Keyframe;
use super::places::Places;
use super::refine::around;
use crate::constants::{CLEARANCE_M, REFINE};
use crate::scan_points::ScanPoint;

/// The share of the distances before their tail, and how few of them say nothing.
const TAIL: f64 = 0.97;
const MIN_DISTANCES: usize = 200;

/// The distance from the surfaces of submaps to which they do not belong, below which 97 % of the points of scans lie, m: 2.2
/// standard deviations of normal noise. Real scans have more of large distances: at edges, plants and glass. `None` if no place
/// was seen twice.
pub(super) fn residual_m(places: &Places, keyframes: &[Keyframe], graph: &PoseGraph) -> Option<f64> {
    let mut distances_m = around(places, graph, REFINE[0].0, |map, [_, keyframe], pose| {
        let distance_m = |point: &ScanPoint| {
            let nearest = map.nearest(&(pose * point.at), &(pose.rotation * point.normal), CLEARANCE_M);
            nearest.map(|(_, off_m)| off_m.abs())
        };
        keyframes[keyframe].points.iter().filter_map(distance_m).collect()
    });
    if distances_m.len() < MIN_DISTANCES {
        return None;
    }
    let index = (distances_m.len() as f64 * TAIL) as usize;
    Some(*distances_m.select_nth_unstable_by(index, f64::total_cmp).1)
}
