//! How far scans are from the surfaces that others have seen: what remains of the errors of ranges and poses.

use super::graph::PoseGraph;
use super::keyframe::Keyframe;
use super::places::Places;
use super::refine::near;
use super::submap::FinishedSubmap;
use crate::constants::{CLEARANCE_M, MIN_RESIDUALS, REFINE, STD_PER_MEDIAN, TAIL};
use crate::surfel_map::SurfelMap;
use rayon::prelude::*;

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
    let of_submap = |(number, submap): (usize, &FinishedSubmap)| {
        let mut distances_m = Vec::new();
        let near: Vec<usize> =
            near(submap, graph).filter(|near| (near + number) % REFINE[0].0 == 0).collect();
        let map = if near.is_empty() { None } else { SurfelMap::of_points(&submap.points) };
        for (map, keyframe) in map.iter().flat_map(|map| near.iter().map(move |keyframe| (map, *keyframe))) {
            let pose = graph.poses[submap.anchor].inv_mul(&graph.poses[keyframe]);
            distances_m.extend(keyframes[keyframe].points.iter().filter_map(|point| {
                let nearest = map.nearest(&(pose * point.at), &(pose.rotation * point.normal), CLEARANCE_M);
                nearest.map(|(_, off_m)| off_m.abs())
            }));
        }
        distances_m
    };
    let submaps: Vec<(usize, &FinishedSubmap)> = places.references().collect();
    let mut distances_m: Vec<f64> = submaps.into_par_iter().flat_map_iter(of_submap).collect();
    if distances_m.len() < MIN_RESIDUALS {
        return None;
    }
    let mut at = |share: f64| {
        let index = (distances_m.len() as f64 * share) as usize;
        *distances_m.select_nth_unstable_by(index, f64::total_cmp).1
    };
    Some(Residual { std_m: at(0.5) * STD_PER_MEDIAN, tail_m: at(TAIL) })
}
