//! How far scans are from the surfaces that others have seen: what remains of the errors of ranges and poses.

use super::graph::PoseGraph;
use super::keyframe::Keyframe;
use super::places::Places;
use super::refine::around;
use crate::constants::{CLEARANCE_M, REFINE};
use crate::scan_points::ScanPoint;

/// Share of the residuals before the tail; fewer points say nothing; standard deviation in medians.
const TAIL: f64 = 0.97;
const MIN_RESIDUALS: usize = 200;
const STD_PER_MEDIAN: f64 = 1.4826;

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
    let mut distances_m = around(places, graph, REFINE[0].0, |map, [_, keyframe], pose| {
        let distance_m = |point: &ScanPoint| {
            let nearest = map.nearest(&(pose * point.at), &(pose.rotation * point.normal), CLEARANCE_M);
            nearest.map(|(_, off_m)| off_m.abs())
        };
        keyframes[keyframe].points.iter().filter_map(distance_m).collect()
    });
    if distances_m.len() < MIN_RESIDUALS {
        return None;
    }
    let mut at = |share: f64| {
        let index = (distances_m.len() as f64 * share) as usize;
        *distances_m.select_nth_unstable_by(index, f64::total_cmp).1
    };
    Some(Residual { std_m: at(0.5) * STD_PER_MEDIAN, tail_m: at(TAIL) })
}
