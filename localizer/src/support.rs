//! How well a scan at a pose agrees with the maps.

use crate::constants::END_M;
use crate::work;
use interfaces::{CellState, FARTHEST_M, Grid, GridFrame, Scan};
use nalgebra::{Isometry2, Matrix3, Point2, Vector2};
use std::ops::Range;

/// One of this many beams without a return is compared, with half the weight of a point for each.
const CLEAR_STRIDE: usize = 6;

/// The length of the surface that a scan saw, in weights of points.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Support {
    /// On surfels.
    pub(crate) confirmed: f64,
    /// In space that the map knows as free, or behind something that the map knows as blocked.
    pub(crate) contradicted: f64,
    /// The part of the contradicted weight whose beams did not return, though something blocked is in their way.
    pub(crate) blind: f64,
    /// In regions that were never seen, or where no surfel was learned.
    pub(crate) new: f64,
    /// On or near surfels that have never moved: in place, or a little off.
    pub(crate) in_place: f64,
    pub(crate) displaced: f64,
    /// The information about x, y and heading of the confirmed points (1/m² and 1 per rad², per unit of weight).
    pub(crate) geometry: Matrix3<f64>,
}

impl Support {
    /// The share of what the map confirms, of what it can judge; 1 if it can judge nothing.
    pub(crate) fn share(&self) -> f64 {
        let judged = self.confirmed + self.contradicted;
        if judged > 0.0 { self.confirmed / judged } else { 1.0 }
    }

    /// [`Support::share`], of the beams that returned: a covered laser contradicts nothing.
    pub(crate) fn seen_share(&self) -> f64 {
        Self { contradicted: self.contradicted - self.blind, ..*self }.share()
    }

    /// The share of what the map confirms, of all. For the choice between poses in a known map: where the map does not
    /// know anything, nothing speaks for the pose.
    pub(crate) fn score(&self) -> f64 {
        let all = self.weight();
        if all > 0.0 { self.confirmed / all } else { 0.0 }
    }

    /// The share of the surfaces that are seen a little off their place, of those that have never moved before.
    pub(crate) fn displaced_share(&self) -> f64 {
        let all = self.in_place + self.displaced;
        if all > 0.0 { self.displaced / all } else { 0.0 }
    }

    /// The weight of all points.
    pub(crate) fn weight(&self) -> f64 {
        self.confirmed + self.contradicted + self.new
    }

    /// Whether the confirmed points alone fix x, y and heading: seen from the robot, `least` units of weight stand
    /// against a shift in every direction, and against a turn at an arm of one meter.
    pub(crate) fn fixes_pose(&self, min_information: f64) -> bool {
        self.geometry.symmetric_eigenvalues().min() >= min_information
    }

    /// The distance by which a turn shifts the confirmed surfaces, m per rad: the root of the mean square.
    pub(crate) fn lever_m(&self) -> f64 {
        if self.confirmed > 0.0 { (self.geometry[(2, 2)] / self.confirmed).sqrt() } else { f64::INFINITY }
    }
}

/// Whether a point on a surface contradicts the map: the map knows its cell as free, or something in front.
pub(crate) fn is_contradicted(states: &Grid<CellState>, laser: &Point2<f64>, at: &Point2<f64>) -> bool {
    state_at(states, at) == CellState::Free || passes_blocked(states, laser, at)
}

/// The state of the cell that contains a point.
fn state_at(states: &Grid<CellState>, point: &Point2<f64>) -> CellState {
    states.get(states.frame().cell_at(point)).copied().unwrap_or_default()
}

/// Whether something blocked lies between the laser and a point.
fn passes_blocked(states: &Grid<CellState>, laser: &Point2<f64>, at: &Point2<f64>) -> bool {
    let way = at - laser;
    let length_m = way.norm();
    let step_m = states.frame().resolution_m();
    let steps = ((length_m - 2.0 * END_M) / step_m).max(0.0) as usize;
    let along = way / length_m;
    let at = |step: usize| laser + along * (END_M + step as f64 * step_m);
    let inside = inside(states.frame(), &at(0), &(along * step_m));
    let steps = inside.start..steps.min(inside.end);
    work::count(steps.len());
    steps.into_iter().any(|step| state_at(states, &at(step)) == CellState::Blocked)
}

/// The steps from a point that can lie in a frame, with one more on either side: outside of the map nothing is known, and a beam
/// may be said to reach any distance.
fn inside(frame: &GridFrame, from: &Point2<f64>, step: &Vector2<f64>) -> Range<usize> {
    let steps = |axis: usize, cells: usize| {
        let step_m = step[axis].abs().max(1e-300).copysign(step[axis]);
        let low = (frame.origin()[axis] - from[axis]) / step_m;
        let high = low + cells as f64 * frame.resolution_m() / step_m;
        (low.min(high), low.max(high))
    };
    let (x, y) = (steps(0, frame.width()), steps(1, frame.height()));
    (x.0.max(y.0) - 1.0) as usize..(x.1.min(y.1) + 2.0) as usize
}

/// Some of the beams without a return. Where such a beam passes something blocked, the map contradicts the scan: the
/// laser is covered, or the pose is wrong.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClearBeams {
    /// Unit vectors in the frame of the laser.
    directions: Vec<Vector2<f64>>,
    range_m: f64,
}

impl ClearBeams {
    /// The beams of `scan`.
    pub(crate) fn of(scan: &Scan) -> Self {
        let beams = (0..scan.ranges_m.len()).step_by(CLEAR_STRIDE);
        let clear = beams.filter(|&beam| scan.ranges_m[beam] == f32::INFINITY);
        let direction = |beam| interfaces::rotation(scan.angle_rad(beam)) * Vector2::x();
        Self { directions: clear.map(direction).collect(), range_m: scan.range_max_m.min(FARTHEST_M) }
    }

    /// The weight of the beams that pass something blocked.
    pub(crate) fn contradicted(&self, states: &Grid<CellState>, laser: &Isometry2<f64>) -> f64 {
        let origin = Point2::from(laser.translation.vector);
        let ends = self.directions.iter().map(|along| origin + laser.rotation * along * self.range_m);
        let passing = ends.filter(|end| passes_blocked(states, &origin, end)).count();
        passing as f64 * CLEAR_STRIDE as f64 / 2.0
    }
}
