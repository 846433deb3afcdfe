//! The pose graph: keyframes, and measured motions between them. Its optimum is the trajectory.
//!
//! Gauss-Newton on the differences between measured and estimated motions (Grisetti, Kümmerle, Stachniss & Burgard
//! 2010). A recognized place can be wrong: it counts by the kernel of Geman and McClure, whose scale shrinks from step to
//! step (graduated non-convexity: Yang, Antonante, Tzoumas & Carlone 2020), since after a long way a correct loop
//! contradicts all that is known.

use super::sparse::Equations;
use crate::constants::{LOOP_M, STEP, TURN_M};
use crate::matcher::difference;
use interfaces::{Spread, wrap_rad};
use nalgebra::{Isometry2, Matrix3, Vector3};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Steps of the graph at most; the change that ends them; a loop off by this (over its covariance) counts a quarter; factor
/// by which this limit shrinks.
const GRAPH_STEPS: usize = 25;
const GRAPH_KERNEL: f64 = 16.0;
const GRAPH_SHRINK: f64 = 3.0;
/// Errors after a way: at least these, m and rad; per way; per root of the way, rad; at most this, m.
const DRIFT: Spread = Spread { m: 0.4, rad: 0.08 };
const DRIFT_PER_M: f64 = 0.03;
const MAX_DRIFT_M: f64 = 12.0;

/// A measured motion from one keyframe to another.
#[derive(Clone, Debug)]
pub(crate) struct Edge {
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// The pose of `to` in the frame of `from`.
    pub(crate) motion: Isometry2<f64>,
    /// The inverse covariance of x, y and heading of the motion, in the frame of `from`.
    pub(super) information: Matrix3<f64>,
    /// Whether the motion was measured by recognizing a place, which can be wrong; otherwise from one keyframe to the next, by matching
    /// with the submap of the last keyframes.
    pub(super) is_loop: bool,
}

/// The pose graph.
#[derive(Clone, Debug, Default)]
pub(super) struct PoseGraph {
    pub(super) poses: Vec<Isometry2<f64>>,
    pub(super) edges: Vec<Edge>,
}

impl Edge {
    /// The measured motion less the motion between two poses, in the frame of `from`.
    fn error(&self, poses: &[Isometry2<f64>]) -> Vector3<f64> {
        difference(&poses[self.from].inv_mul(&poses[self.to]), &self.motion)
    }

    /// The square of the error, over its covariance.
    fn square(&self, poses: &[Isometry2<f64>]) -> f64 {
        let error = self.error(poses);
        (error.transpose() * self.information * error)[0]
    }

    /// Adds the edge to the normal equations.
    fn add_to(&self, equations: &mut Equations, poses: &[Isometry2<f64>], weight: f64) {
        let back = poses[self.from].rotation.inverse();
        let motion = poses[self.from].inv_mul(&poses[self.to]).translation.vector;
        let to = back.to_homogeneous();
        let mut from = -to;
        // A turn of `from` swings `to` the other way around.
        from[(0, 2)] = motion.y;
        from[(1, 2)] = -motion.x;
        let information = self.information * weight;
        let error = self.error(poses);
        for (node, j) in [(self.from, &from), (self.to, &to)] {
            equations.diagonal[node] += j.transpose() * information * j;
            equations.right[node] -= j.transpose() * information * error;
        }
        equations.add_pair(self.from, self.to, &(from.transpose() * information * to));
    }
}

impl PoseGraph {
    /// Moves all poses but the first to the optimum.
    pub(super) fn optimize(&mut self) {
        if self.edges.is_empty() {
            return;
        }
        let largest = self.loops().map(|edge| edge.square(&self.poses)).fold(0.0, f64::max);
        let mut scale = largest.max(GRAPH_KERNEL);
        for _ in 0..GRAPH_STEPS {
            let Some(step) = self.step(scale) else { return };
            let largest = step.iter().map(|part| part.amax()).fold(0.0, f64::max);
            for (pose, part) in self.poses.iter_mut().zip(&step) {
                pose.translation.vector += part.xy();
                pose.rotation = interfaces::rotation(wrap_rad(part.z)) * pose.rotation;
                pose.rotation.renormalize();
            }
            if scale <= GRAPH_KERNEL && largest < STEP.m {
                return;
            }
            scale = (scale / GRAPH_SHRINK).max(GRAPH_KERNEL);
        }
    }

    /// Removes the loops that contradict the optimum.
    pub(super) fn remove_outliers(&mut self) {
        let poses = &self.poses;
        self.edges.retain(|edge| !edge.is_loop || edge.square(poses) <= 2.0 * GRAPH_KERNEL);
    }

    /// The shortest way from a keyframe to every other keyframe, along the edges of the graph, m.
    pub(super) fn ways_m(&self, from: usize) -> Vec<f64> {
        let mut neighbors = vec![Vec::new(); self.poses.len()];
        for edge in &self.edges {
            let turn_m = interfaces::heading_rad(&edge.motion).abs() * TURN_M;
            let way_m = if edge.is_loop { LOOP_M } else { edge.motion.translation.vector.norm() + turn_m };
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

    fn loops(&self) -> impl Iterator<Item = &Edge> {
        self.edges.iter().filter(|edge| edge.is_loop)
    }

    fn step(&self, scale: f64) -> Option<Vec<Vector3<f64>>> {
        let mut equations = Equations::new(self.poses.len());
        equations.diagonal[0] += Matrix3::identity() * 1e12;
        for edge in &self.edges {
            let root = scale / (scale + edge.square(&self.poses));
            let weight = if edge.is_loop { root * root } else { 1.0 };
            edge.add_to(&mut equations, &self.poses, weight);
        }
        equations.solve().filter(|step| step.iter().all(|part| part.iter().all(|value| value.is_finite())))
    }
}

/// The largest error of position (m) and heading (rad) that is expected after a way.
pub(super) fn reach(way_m: f64) -> (f64, f64) {
    ((DRIFT.m + DRIFT_PER_M * way_m).min(MAX_DRIFT_M), DRIFT.rad + DRIFT_PER_M * way_m.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::pose;
    use std::f64::consts::TAU;

    const NODES: usize = 100;

    fn edge(from: usize, to: usize, motion: Isometry2<f64>, std: f64, is_loop: bool) -> Edge {
        let information = Matrix3::identity() / (std * std);
        Edge { from, to, motion, information, is_loop }
    }

    /// A circle of 100 m, whose every step turns a little too much.
    fn circle(bend_rad: f64) -> (PoseGraph, Vec<Isometry2<f64>>) {
        let turn = TAU / NODES as f64;
        let (mut graph, mut truth) = (PoseGraph::default(), vec![Isometry2::identity()]);
        graph.poses.push(Isometry2::identity());
        for node in 1..NODES {
            let motion = pose(1.0, 0.0, turn + bend_rad);
            truth.push(truth[node - 1] * pose(1.0, 0.0, turn));
            graph.poses.push(graph.poses[node - 1] * motion);
            graph.edges.push(edge(node - 1, node, motion, 0.003, false));
        }
        (graph, truth)
    }

    fn worst_m(graph: &PoseGraph, truth: &[Isometry2<f64>]) -> f64 {
        let error = |(found, truth): (&Isometry2<f64>, &Isometry2<f64>)| {
            (found.translation.vector - truth.translation.vector).norm()
        };
        graph.poses.iter().zip(truth).map(error).fold(0.0, f64::max)
    }

    #[test]
    fn a_loop_straightens_a_bent_trajectory() {
        let (mut graph, truth) = circle(0.01);
        let before_m = worst_m(&graph, &truth);
        let closing = truth[NODES - 1].inv_mul(&truth[0]);
        graph.edges.push(edge(NODES - 1, 0, closing, 0.001, true));
        graph.optimize();
        let after_m = worst_m(&graph, &truth);
        assert!(before_m > 5.0 && after_m < 0.1, "{before_m} m before, {after_m} m after");
    }

    #[test]
    fn a_wrong_loop_among_others_bends_nothing() {
        let (mut graph, truth) = circle(0.003);
        let before_m = worst_m(&graph, &truth);
        for (from, to) in [(NODES - 1, 0), (NODES - 2, 1), (NODES - 3, 0)] {
            let motion = truth[from].inv_mul(&truth[to]);
            graph.edges.push(edge(from, to, motion, 0.01, true));
        }
        let wrong = truth[70].inv_mul(&truth[20]) * pose(2.0, 1.0, 0.1);
        graph.edges.push(edge(70, 20, wrong, 0.01, true));
        assert!(before_m > 3.0, "{before_m} m");
        graph.optimize();
        graph.remove_outliers();
        let worst_m = worst_m(&graph, &truth);
        assert!(worst_m < 0.25 && graph.loops().count() == 3, "{worst_m} m, {}", graph.loops().count());
    }
}
