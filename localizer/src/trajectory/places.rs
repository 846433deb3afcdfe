//! Where a submap is in earlier submaps: branch and bound, Gauss-Newton, and the question whether it is the same place.

use super::free_space::passing_share;
use super::graph::{Edge, PoseGraph, reach};
use super::submap::{Agreement, FinishedSubmap, Keyframe, fit, information_of, thinned};
use crate::constants::{
    AMBIGUOUS, EXAMINED, MAJORITY, MAX_PASSING, MAX_WORK, MIN_WAY_M, NEAR_M, NEAR_RANGE_M, NEIGHBORS,
    PLACE_AGREEMENT, PLACE_MODEL_STD, PLACE_OVERLAP, PLACE_STD, STRONG_AGREEMENT,
};
use crate::matcher::Match;
use crate::scan_points::ScanPoint;
use crate::score_grid::ScoreGrid;
use crate::search::{Window, search};
use crate::surfel_map::SurfelMap;
use interfaces::Spread;
use nalgebra::Isometry2;

/// Earlier submaps in which one is searched for, with the score grids of twice as many; points that are compared.
const MAX_SEARCHES: usize = 3;
const COMPARED_POINTS: usize = 300;
/// Minimum score of a pose in a search.
const PLACE_SCORE: f64 = 0.35;
/// Poses of submaps that are the same.
const SAME_SUBMAP: Spread = Spread { m: 0.5, rad: 0.1 };
/// What a pose at the border of the window counts less.
const UNLIKELY: f64 = 0.3;
/// A submap with twice as many references nearer than this is no reference, m: hours in one place.
const REFERENCE_M: f64 = 3.0;

/// A recognized place: the pose of submap `to` in submap `from`.
#[derive(Clone, Debug)]
pub(crate) struct RecognizedPlace {
    pub(super) from: usize,
    pub(super) to: usize,
    /// The way between the two along the trajectory, m.
    pub(super) way_m: f64,
    pub(crate) edge: Edge,
    /// Whether little speaks against it.
    pub(super) is_strong: bool,
}

/// A pose of a submap in an earlier submap.
struct Fit {
    from: usize,
    way_m: f64,
    found: Match,
    agreement: Agreement,
    /// The share of beams that pass surfaces of the other submap.
    passing: f64,
    /// The confirmed points; poses that the trajectory makes unlikely count less.
    value: f64,
    /// The pose in the frame of the trajectory.
    at: Isometry2<f64>,
}

impl Fit {
    fn is_same(&self, other: &Self) -> bool {
        SAME_SUBMAP.contains(&self.at.inv_mul(&other.at))
    }

    fn holds(&self, overlap: f64, agreement: f64, passing: f64) -> bool {
        self.agreement.overlap() >= overlap && self.agreement.share() >= agreement && self.passing <= passing
    }
}

/// The submaps, and the scores of those that were searched last.
#[derive(Debug)]
pub(super) struct Places {
    pub(super) noise_m: f64,
    pub(super) submaps: Vec<FinishedSubmap>,
    /// The numbers of the submaps in which later ones are searched for, and with which keyframes are matched. Not every
    /// submap is one: of a robot that drives for hours in one place, the time would grow with the square of its log.
    references: Vec<usize>,
    grids: Vec<(usize, SurfelMap, ScoreGrid)>,
}

impl Places {
    pub(super) fn new(noise_m: f64) -> Self {
        Self { noise_m, submaps: Vec::new(), references: Vec::new(), grids: Vec::new() }
    }

    /// Adds a finished submap and returns its number.
    pub(super) fn add(&mut self, submap: FinishedSubmap, graph: &PoseGraph) -> usize {
        let middle = |submap: &FinishedSubmap| graph.poses[submap.anchor].translation.vector;
        let is_around =
            |other: &&usize| (middle(&self.submaps[**other]) - middle(&submap)).norm() < REFERENCE_M;
        let number = self.submaps.len();
        if self.references.iter().filter(is_around).count() < 2 * NEIGHBORS {
            self.references.push(number);
        }
        self.submaps.push(submap);
        number
    }

    /// The submaps with which others are compared, with their numbers.
    pub(super) fn references(&self) -> impl Iterator<Item = (usize, &FinishedSubmap)> {
        self.references.iter().map(|number| (*number, &self.submaps[*number]))
    }

    /// The places of a submap in earlier submaps. None, if its pose is ambiguous.
    pub(super) fn of(
        &mut self,
        to: usize,
        keyframes: &[Keyframe],
        graph: &PoseGraph,
    ) -> Vec<RecognizedPlace> {
        let mut fits = Vec::new();
        for (from, way_m) in self.candidates(to, graph) {
            self.fits(from, to, way_m, graph, &mut fits);
        }
        fits.retain_mut(|fit| {
            if !fit.holds(PLACE_OVERLAP, PLACE_AGREEMENT, 1.0) {
                return false;
            }
            let submaps = &self.submaps;
            fit.passing =
                passing_share(&submaps[fit.from], &submaps[to], &fit.found.placement.pose, keyframes);
            fit.passing <= MAX_PASSING
        });
        fits.sort_by(|a, b| b.value.total_cmp(&a.value));
        let Some(best) = fits.first() else { return Vec::new() };
        if fits.iter().any(|fit| fit.value >= AMBIGUOUS * best.value && !fit.is_same(best)) {
            return Vec::new();
        }
        let mut places: Vec<RecognizedPlace> = Vec::new();
        for fit in fits.iter().filter(|fit| fit.is_same(best)) {
            if places.iter().all(|place| place.from != fit.from) {
                places.extend(self.place(to, fit));
            }
        }
        places
    }

    fn place(&self, to: usize, fit: &Fit) -> Option<RecognizedPlace> {
        let information = information_of(&fit.found, PLACE_MODEL_STD)?;
        let (from, to_anchor) = (self.submaps[fit.from].anchor, self.submaps[to].anchor);
        let edge = Edge { from, to: to_anchor, motion: fit.found.placement.pose, information, is_loop: true };
        // Half as many beams speak against it.
        let is_strong = fit.holds(MAJORITY, STRONG_AGREEMENT, MAX_PASSING / 2.0);
        Some(RecognizedPlace { from: fit.from, to, way_m: fit.way_m, edge, is_strong })
    }

    /// The earlier submaps that may cover the place of a submap, and the ways to them, m: the nearest ones.
    fn candidates(&self, to: usize, graph: &PoseGraph) -> Vec<(usize, f64)> {
        let submap = &self.submaps[to];
        let ways_m = graph.ways_m(submap.anchor);
        let distance_m = |other: &FinishedSubmap| {
            graph.poses[other.anchor].inv_mul(&graph.poses[submap.anchor]).translation.vector.norm()
        };
        let earlier = self.references().filter(|(from, other)| *from < to && other.last < submap.first);
        let mut candidates: Vec<(usize, f64, f64)> = earlier
            .map(|(from, other)| (from, ways_m[other.anchor], distance_m(other)))
            .filter(|(_, way_m, distance_m)| *way_m >= MIN_WAY_M && *distance_m <= NEAR_M + reach(*way_m).0)
            .collect();
        candidates.sort_by(|a, b| a.2.total_cmp(&b.2));
        let mut chosen: Vec<(usize, f64)> = Vec::new();
        for (from, way_m, _) in candidates {
            // Neighbors share half of their keyframes.
            if chosen.len() < MAX_SEARCHES && chosen.iter().all(|(other, _)| from.abs_diff(*other) > 1) {
                chosen.push((from, way_m));
            }
        }
        chosen
    }

    /// Adds the poses at which a submap fits in an earlier one.
    fn fits(&mut self, from: usize, to: usize, way_m: f64, graph: &PoseGraph, fits: &mut Vec<Fit>) {
        self.prepare(from);
        let Some((_, map, grid)) = self.grids.iter().find(|(number, ..)| *number == from) else { return };
        let (anchor, other) = (self.submaps[from].anchor, self.submaps[to].anchor);
        let pose = graph.poses[anchor].inv_mul(&graph.poses[other]);
        let (reach_m, reach_rad) = reach(way_m);
        let is_near = |point: &&ScanPoint| point.at.coords.norm() <= NEAR_RANGE_M;
        let near: Vec<ScanPoint> = self.submaps[to].points.iter().filter(is_near).copied().collect();
        let points = thinned(&near, COMPARED_POINTS);
        let window = Window { pose, reach_m, reach_rad };
        for start in search(&mut { MAX_WORK }, grid, &points, &window, (PLACE_SCORE, EXAMINED)) {
            let Some((found, agreement)) = fit(map, &points, &start, PLACE_STD, self.noise_m) else {
                continue;
            };
            let off = (found.placement.pose.translation.vector - pose.translation.vector).norm() / reach_m;
            let value = agreement.confirmed * (1.0 - UNLIKELY * (off * off).min(1.0));
            let at = graph.poses[anchor] * found.placement.pose;
            fits.push(Fit { from, way_m, found, agreement, passing: 0.0, value, at });
        }
    }

    /// Makes the scores of a submap.
    fn prepare(&mut self, number: usize) {
        if self.grids.iter().any(|(known, ..)| *known == number) {
            return;
        }
        let Some(map) = SurfelMap::of_points(&self.submaps[number].points) else { return };
        let grid = ScoreGrid::anywhere(&map);
        if self.grids.len() == 2 * MAX_SEARCHES {
            self.grids.remove(0);
        }
        self.grids.push((number, map, grid));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream, pose};

    #[test]
    fn hours_in_one_place_need_no_more_references_than_the_first_passes() {
        let mut random = RandomStream::new(100, Purpose::Agent);
        let (mut places, mut graph) = (Places::new(0.01), PoseGraph::default());
        let mut after = Vec::new();
        for number in 0..2000 {
            graph.poses.push(pose(random.uniform(0.0..10.0), random.uniform(0.0..10.0), 0.0));
            let points = Vec::new();
            places.add(FinishedSubmap { anchor: number, first: number, last: number, points }, &graph);
            after.push(places.references.len());
        }
        // Any two points of a square of 2.1 m are nearer to each other: 25 such squares cover the place.
        assert!(after[11] == 12 && after[1999] <= 25 * 2 * NEIGHBORS, "{after:?}");
        let is_near = |from: usize, to: usize| {
            (graph.poses[from].translation.vector - graph.poses[to].translation.vector).norm() < REFERENCE_M
        };
        for submap in 0..2000 {
            let around = places.references().filter(|(reference, _)| is_near(*reference, submap)).count();
            let is_reference = places.references.contains(&submap);
            assert!(is_reference || around >= 2 * NEIGHBORS, "submap {submap}: {around}");
        }
    }
}
