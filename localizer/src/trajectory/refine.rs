//! The last pass: keyframes are matched with the submaps around them.

use super::graph::{Edge, PoseGraph};
use super::places::Places;
use super::submap::{Agreement, FinishedSubmap, Keyframe, fit, information_of};
use crate::constants::{CLEARANCE_M, MIN_AGREEMENT, MIN_OVERLAP, NEAR_M, REFINE, SUBMAP_STD};
use crate::matcher::Match;
use crate::scan_points::ScanPoint;
use crate::surfel_map::SurfelMap;
use nalgebra::Isometry2;
use rayon::prelude::*;

/// The share of the distances before their tail, and how few of them say nothing.
const TAIL: f64 = 0.97;
const MIN_DISTANCES: usize = 200;

/// Matches keyframes with all submaps around them of which they are no part, and optimizes the graph; once more from the
/// better poses.
pub(super) fn refine(places: &Places, keyframes: &[Keyframe], graph: &mut PoseGraph) {
    let without = graph.edges.clone();
    for (stride, std) in REFINE {
        let edges = around(places, graph, stride, |map, [anchor, keyframe], pose| {
            let found = fit(map, &keyframes[keyframe].points, &pose, std, places.noise_m);
            found.and_then(|found| edge(anchor, keyframe, &found)).into_iter().collect()
        });
        graph.edges.clone_from(&without);
        graph.edges.extend(edges);
        graph.optimize();
    }
    graph.remove_outliers();
    graph.optimize();
}

/// What `of` says of submaps and the keyframes around them of which they are no part, one of `stride`: of the map, the middle
/// keyframe, the other keyframe, and its pose in the map.
fn around<T: Send>(
    places: &Places,
    graph: &PoseGraph,
    stride: usize,
    of: impl Fn(&SurfelMap, [usize; 2], Isometry2<f64>) -> Vec<T> + Sync,
) -> Vec<T> {
    let of_submap = |(number, submap): (usize, &FinishedSubmap)| {
        let near: Vec<usize> = near(submap, graph).filter(|near| (near + number) % stride == 0).collect();
        let map = if near.is_empty() { None } else { SurfelMap::of_points(&submap.points) };
        let mut all = Vec::new();
        for (map, keyframe) in map.iter().flat_map(|map| near.iter().map(move |keyframe| (map, *keyframe))) {
            let pose = graph.poses[submap.anchor].inv_mul(&graph.poses[keyframe]);
            all.extend(of(map, [submap.anchor, keyframe], pose));
        }
        all
    };
    // In the order of the submaps, however many threads there are.
    let submaps: Vec<(usize, &FinishedSubmap)> = places.references().collect();
    submaps.into_par_iter().flat_map_iter(of_submap).collect()
}

/// The keyframes around a submap of which they are no part.
fn near<'a>(submap: &'a FinishedSubmap, graph: &'a PoseGraph) -> impl Iterator<Item = usize> + 'a {
    let middle = graph.poses[submap.anchor].translation.vector;
    let is_near = move |number: &usize| {
        let is_part = (submap.first..=submap.last).contains(number);
        !is_part && (graph.poses[*number].translation.vector - middle).norm() <= NEAR_M
    };
    (0..graph.poses.len()).filter(is_near)
}

/// The motion from the middle of a submap to a keyframe, if the scan of the keyframe agrees with the submap.
fn edge(anchor: usize, keyframe: usize, (found, agreement): &(Match, Agreement)) -> Option<Edge> {
    if agreement.overlap() < MIN_OVERLAP || agreement.share() < MIN_AGREEMENT {
        return None;
    }
    let information = information_of(found, SUBMAP_STD)?;
    Some(Edge { from: anchor, to: keyframe, motion: found.placement.pose, information, is_loop: true })
}

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
