//! How far apart two keyframes are along the trajectory, and how far their relative pose can be wrong.

use super::graph::{EdgeKind, PoseGraph};
use crate::constants::{LOOP_M, TURN_M};
use interfaces::Spread;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Errors after a way: at least these, m and rad; per way; per root of the way, rad; at most this, m.
const DRIFT: Spread = Spread { m: 0.4, rad: 0.08 };
const DRIFT_PER_M: f64 = 0.03;
const MAX_DRIFT_M: f64 = 12.0;

/// The shortest way from a keyframe to every other keyframe, along the edges of the graph, m.
pub(super) fn ways_m(graph: &PoseGraph, from: usize) -> Vec<f64> {
    let mut neighbors = vec![Vec::new(); graph.poses.len()];
    for edge in &graph.edges {
        let turn_m = interfaces::heading_rad(&edge.motion).abs() * TURN_M;
        let way_m =
            if edge.kind == EdgeKind::Loop { LOOP_M } else { edge.motion.translation.vector.norm() + turn_m };
        // Whole millimeters can be sorted.
        let way_mm = (way_m * 1e3) as u64;
        neighbors[edge.from].push((edge.to, way_mm));
        neighbors[edge.to].push((edge.from, way_mm));
    }
    let mut ways_mm = vec![u64::MAX; neighbors.len()];
    let mut queue = BinaryHeap::from([Reverse((0, from))]);
    while let Some(Reverse((way_mm, node))) = queue.pop() {
        if way_mm < ways_mm[node] {
            ways_mm[node] = way_mm;
            let next = neighbors[node].iter().map(|(other, step_mm)| Reverse((way_mm + step_mm, *other)));
            queue.extend(next);
        }
    }
    ways_mm.into_iter().map(|way_mm| way_mm as f64 * 1e-3).collect()
}

/// The largest error of position (m) and heading (rad) that is expected after a way.
pub(super) fn reach(way_m: f64) -> (f64, f64) {
    ((DRIFT.m + DRIFT_PER_M * way_m).min(MAX_DRIFT_M), DRIFT.rad + DRIFT_PER_M * way_m.sqrt())
}
