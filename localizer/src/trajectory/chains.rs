//! The last pass over keyframes that are far from each other: each is correlated with the chains of earlier keyframes around it
//! (Konolige, Grisetti, Kümmerle, Burgard, Limketkai & Vincent 2010).

use super::correlation::{Correlated, Correlation, matched_at};
use super::graph::{Edge, PoseGraph};
use super::submap::{Keyframe, in_frame};
use crate::constants::{CORRELATED, CORRELATED_KEYFRAMES};
use interfaces::Spread;
use rayon::prelude::*;
use std::ops::Range;

/// A keyframe is far from the one before after this motion.
const SPARSE: Spread = Spread { m: 0.5, rad: 0.4 };
/// A chain: keyframes in a row within this distance, m; minimum length; number of chains that are tried, the nearest first; keyframes
/// before and after them that are compared as well.
const CHAIN_M: f64 = 4.0;
const MIN_CHAIN: usize = 4;
const MAX_CHAINS: usize = 2;
const CHAIN_KEYFRAMES: usize = 8;
/// Minimum response of a keyframe in a chain, and number of rounds.
const CHAIN_RESPONSE: f64 = 0.45;
const CHAIN_ROUNDS: usize = 2;

/// Whether most keyframes are far from the one before.
pub(super) fn are_sparse(keyframes: &[Keyframe]) -> bool {
    let sparse = keyframes.iter().filter(|keyframe| !SPARSE.contains(&keyframe.from_last.0)).count();
    2 * sparse > keyframes.len()
}

/// Adds the motions between chains and the keyframes near them, and optimizes the graph, some times.
pub(super) fn correlate(keyframes: &[Keyframe], graph: &mut PoseGraph) {
    let without = graph.edges.clone();
    for _ in 0..CHAIN_ROUNDS {
        let edges: Vec<Edge> = (0..keyframes.len())
            .into_par_iter()
            .flat_map_iter(|number| edges_of(number, keyframes, graph))
            .collect();
        graph.edges.clone_from(&without);
        graph.edges.extend(edges);
        graph.optimize();
        graph.remove_outliers();
        graph.optimize();
    }
}

/// The motions from chains to a keyframe.
fn edges_of(number: usize, keyframes: &[Keyframe], graph: &PoseGraph) -> Vec<Edge> {
    let (keyframe, predicted) = (&keyframes[number], graph.poses[number]);
    let edge = |chain: Range<usize>| {
        let from = nearest(chain.clone(), number, graph)?;
        let near = chain.start.saturating_sub(CHAIN_KEYFRAMES)..chain.end + CHAIN_KEYFRAMES;
        let near = near.start..near.end.min(number.saturating_sub(CORRELATED_KEYFRAMES));
        let posed = near.map(|other| (&graph.poses[other], &keyframes[other]));
        let scores = Correlation::of(posed, &predicted);
        let Correlated { pose, response } = scores.best(&keyframe.scan, &keyframe.mount, CORRELATED);
        let found = matched_at(&pose, &keyframe.points).filter(|_| response >= CHAIN_RESPONSE)?;
        let motion = graph.poses[from].inv_mul(&pose);
        let information = in_frame(&found.information, &graph.poses[from]);
        Some(Edge { from, to: number, motion, information, is_loop: true })
    };
    chains(number, graph).into_iter().filter_map(edge).collect()
}

/// The runs of keyframes near one that are long enough, and earlier than those with which its scan was matched.
fn chains(number: usize, graph: &PoseGraph) -> Vec<Range<usize>> {
    let is_near = |other: &usize| distance_m(*other, number, graph) <= CHAIN_M;
    let mut chains: Vec<Range<usize>> = Vec::new();
    for other in (0..number.saturating_sub(CORRELATED_KEYFRAMES)).filter(is_near) {
        match chains.last_mut() {
            Some(chain) if chain.end == other => chain.end += 1,
            _ => chains.push(other..other + 1),
        }
    }
    chains.retain(|chain| chain.len() >= MIN_CHAIN);
    let distance_m = |chain: &Range<usize>| {
        nearest(chain.clone(), number, graph).map_or(f64::INFINITY, |near| distance_m(near, number, graph))
    };
    chains.sort_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
    chains.truncate(MAX_CHAINS);
    chains
}

fn nearest(chain: Range<usize>, number: usize, graph: &PoseGraph) -> Option<usize> {
    chain.min_by(|a, b| distance_m(*a, number, graph).total_cmp(&distance_m(*b, number, graph)))
}

fn distance_m(a: usize, b: usize, graph: &PoseGraph) -> f64 {
    (graph.poses[a].translation.vector - graph.poses[b].translation.vector).norm()
}
