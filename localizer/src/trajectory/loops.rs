//! Loops: recognized places that other recognized places confirm.

use super::graph::{Edge, PoseGraph, reach};
use super::keyframe::Keyframe;
use super::places::{Places, RecognizedPlace};
use super::submap::FinishedSubmap;
use crate::constants::{FOUND_STD, KEYFRAME_WAY_M, NEIGHBORS, SHORT_WAY_M};
use interfaces::heading_rad;

/// Finds loops and adds them to the graph.
#[derive(Debug)]
pub(super) struct LoopCloser {
    pub(super) places: Places,
    /// Places that no other has confirmed yet.
    pending: Vec<RecognizedPlace>,
    /// In the order in which they were accepted.
    pub(super) accepted: Vec<RecognizedPlace>,
}

impl LoopCloser {
    pub(super) fn new(noise_m: f64) -> Self {
        Self { places: Places::new(noise_m), pending: Vec::new(), accepted: Vec::new() }
    }

    /// Searches for a finished submap in the earlier ones.
    pub(super) fn add(&mut self, submap: FinishedSubmap, keyframes: &[Keyframe], graph: &mut PoseGraph) {
        let to = self.places.add(submap, graph);
        let mut is_urgent = false;
        for place in self.places.of(to, keyframes, graph) {
            if place.way_m <= SHORT_WAY_M || self.is_confirmed(&place, graph) {
                is_urgent |= is_urgent_in(&place.edge, graph);
                self.accept(place, graph);
            } else {
                self.pending.push(place);
            }
        }
        if is_urgent {
            graph.optimize();
        }
    }

    /// At the end: of the places that wait for others, strong ones are accepted if two earlier submaps say the same.
    pub(super) fn accept_strong(&mut self, graph: &mut PoseGraph) {
        let pending = std::mem::take(&mut self.pending);
        for found in pending.iter().filter(|found| found.is_strong) {
            let mut others = pending.iter().filter(|other| other.from != found.from && other.to == found.to);
            if others.any(|other| agree(found, other, graph)) {
                self.accept(found.clone(), graph);
            }
        }
    }

    /// Whether other places between the same parts of the trajectory agree: at least one more than contradict. Places
    /// that wait for this are accepted with it.
    fn is_confirmed(&mut self, found: &RecognizedPlace, graph: &mut PoseGraph) -> bool {
        let (mut agreeing, mut contradicting) = (0, 0);
        for other in self.pending.iter().chain(&self.accepted).filter(|other| are_neighbors(found, other)) {
            match agree(found, other, graph) {
                true => agreeing += 1,
                false => contradicting += 1,
            }
        }
        let is_confirmed = agreeing > contradicting;
        if is_confirmed {
            let agrees =
                |other: &mut RecognizedPlace| are_neighbors(found, other) && agree(found, other, graph);
            let confirmed: Vec<RecognizedPlace> = self.pending.extract_if(.., agrees).collect();
            confirmed.into_iter().for_each(|other| self.accept(other, graph));
        }
        is_confirmed
    }

    fn accept(&mut self, found: RecognizedPlace, graph: &mut PoseGraph) {
        graph.edges.push(found.edge.clone());
        self.accepted.push(found);
    }
}

/// Whether two places connect the same parts of the trajectory, and were not found with the same submap.
fn are_neighbors(a: &RecognizedPlace, b: &RecognizedPlace) -> bool {
    a.from.abs_diff(b.from) <= NEIGHBORS && a.to.abs_diff(b.to) <= NEIGHBORS && a.to != b.to
}

/// Whether two places say the same.
fn agree(a: &RecognizedPlace, b: &RecognizedPlace, graph: &PoseGraph) -> bool {
    let between = |from: usize, to: usize| graph.poses[from].inv_mul(&graph.poses[to]);
    let expected = between(a.edge.from, b.edge.from) * b.edge.motion * between(b.edge.to, a.edge.to);
    let off = expected.inv_mul(&a.edge.motion);
    let keyframes = a.edge.from.abs_diff(b.edge.from) + a.edge.to.abs_diff(b.edge.to);
    let (max_m, max_rad) = reach(keyframes as f64 * KEYFRAME_WAY_M);
    off.translation.vector.norm() <= max_m && heading_rad(&off).abs() <= max_rad
}

/// Whether a loop contradicts the trajectory so much that all later searches profit from it.
fn is_urgent_in(edge: &Edge, graph: &PoseGraph) -> bool {
    let off = edge.motion.inv_mul(&graph.poses[edge.from].inv_mul(&graph.poses[edge.to]));
    !FOUND_STD.contains(&off)
}
