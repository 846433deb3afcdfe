//! Correlative scan matching (Olson 2009): the best of all poses in a window, by the end points of a scan among those of
//! keyframes. Coarse cells bound the scores of blocks of shifts, so that few blocks are searched.

use super::score_kernel::{BLOCK, BLOCK_BITS, Scores, TOP_SCORE, index, sums};
use super::submap::{Keyframe, information_of};
use crate::constants::{
    ALL_HEADINGS, CORRELATED, CORRELATED_KEYFRAMES, CORRELATED_M, CORRELATION_CELL_M, CORRELATION_PENALTY,
    CORRELATION_RANGE_M, CORRELATION_STD_M, CORRELATION_STEP_RAD, MIN_RESPONSE, RECENT_KEYFRAMES, SUBMAP_STD,
    SURE_FACTOR, SURE_RESPONSE,
};
use crate::local_trajectory_builder::IncomingScan;
use crate::matcher::{Match, derivative};
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use interfaces::{LaserReading, Scan, Spread};
use nalgebra::{Isometry2, Matrix3, Point2, Vector2};
use std::ops::Range;

/// Half the side of the grid, m: beams of the largest range, and shifts.
const HALF_SIDE_M: f64 = CORRELATION_RANGE_M + 2.0;
/// Bounds of blocks are summed up for squares of this number of blocks along a side.
const TILE: usize = 8;
/// The pattern search for the pose ends with this share of a cell.
const MIN_STEP: f64 = 0.05;

/// How well an end point fits at each place: fine cells, and maxima over two blocks of them. The grid is a square around the
/// predicted pose and turns with it, so that the heading of the frame of the trajectory does not matter.
pub(super) struct Correlation {
    predicted: Isometry2<f64>,
    scores: Scores,
}

/// A pose, and the mean score of the end points there, from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Correlated {
    pub(super) pose: Isometry2<f64>,
    pub(super) response: f64,
}

/// The end points of a scan at one heading.
struct Turned {
    turn_rad: f64,
    cells: Vec<[i32; 2]>,
}

/// A heading and a block of shifts, with an upper bound of the score.
struct Candidate {
    bound: f64,
    heading: usize,
    block: [i32; 2],
}

impl Correlation {
    /// The scores around a predicted pose, from keyframes at these poses.
    pub(super) fn of<'a>(
        keyframes: impl Iterator<Item = (&'a Isometry2<f64>, &'a Keyframe)>,
        predicted: &Isometry2<f64>,
    ) -> Self {
        let blocks = (2.0 * HALF_SIDE_M / CORRELATION_CELL_M) as i32 / BLOCK;
        let (mut scores, predicted) = (Scores::new(blocks), *predicted);
        for (pose, keyframe) in keyframes {
            let laser = predicted.inv_mul(pose) * keyframe.mount;
            hits(&keyframe.scan).for_each(|hit| scores.add(cell(&(laser * hit).coords)));
        }
        Self { predicted, scores }
    }

    /// The best pose of a scan in a window around the predicted one; poses far from it count less.
    pub(super) fn best(&self, scan: &Scan, mount: &Isometry2<f64>, window: Spread) -> Correlated {
        let points: Vec<Point2<f64>> = hits(scan).map(|hit| mount * hit).collect();
        let headings = headings(&points, &window);
        let mut candidates = self.candidates(&headings, &window);
        let mut best = (0.0, 0.0, [0, 0]);
        // The most promising block leaves few others, which are put in order.
        let first =
            candidates.iter().reduce(|best, other| if other.bound > best.bound { other } else { best });
        first.into_iter().for_each(|first| self.search(first, &headings, &window, &mut best));
        candidates.retain(|candidate| candidate.bound > best.0);
        candidates.sort_by(|a, b| b.bound.total_cmp(&a.bound));
        for candidate in &candidates {
            if candidate.bound <= best.0 {
                break;
            }
            self.search(candidate, &headings, &window, &mut best);
        }
        let (_, turn_rad, shift) = best;
        let shift_m = Vector2::from(shift.map(f64::from)) * CORRELATION_CELL_M;
        self.polished(&points, interfaces::pose(shift_m.x, shift_m.y, turn_rad))
    }

    /// Searches the shifts of a block; `best` is the best score so far with its heading and its shift.
    fn search(
        &self,
        candidate: &Candidate,
        headings: &[Turned],
        window: &Spread,
        best: &mut (f64, f64, [i32; 2]),
    ) {
        let Turned { turn_rad, cells } = &headings[candidate.heading];
        let first = candidate.block.map(|block| block * BLOCK);
        let scores: [[u32; BLOCK as usize]; BLOCK as usize] =
            sums(&self.scores.fine, self.scores.side, cells.iter().copied(), first);
        for [x, y] in squares(0..BLOCK) {
            let shift = [first[0] + x, first[1] + y];
            let score = f64::from(scores[y as usize][x as usize]) * likelihood(*turn_rad, shift, window);
            if score > best.0 {
                *best = (score, *turn_rad, shift);
            }
        }
    }

    /// The blocks of a window at all headings.
    fn candidates(&self, headings: &[Turned], window: &Spread) -> Vec<Candidate> {
        let blocks = libm::ceil(window.m / (f64::from(BLOCK) * CORRELATION_CELL_M)) as i32;
        let mut candidates = Vec::with_capacity(headings.len() * (4 * blocks * blocks) as usize);
        for (heading, Turned { turn_rad, cells }) in headings.iter().enumerate() {
            let bounds = self.bounds(cells, blocks);
            for ([x, y], most) in squares(-blocks..blocks).zip(bounds) {
                let block = [x, y];
                let corner = block.map(|block| block * BLOCK);
                let nearest = corner.map(|low| low.max(0) + (low + BLOCK - 1).min(0));
                let bound = f64::from(most) * likelihood(*turn_rad, nearest, window);
                candidates.push(Candidate { bound, heading, block });
            }
        }
        candidates
    }

    /// Upper bounds of the sums of scores in the blocks of a window, row by row.
    fn bounds(&self, cells: &[[i32; 2]], blocks: i32) -> Vec<u32> {
        let (columns, side) = (2 * blocks as usize, self.scores.side / BLOCK);
        let mut bounds = vec![0; columns * columns];
        let coarse = || cells.iter().map(|cell| cell.map(|at| at >> BLOCK_BITS));
        for row in (0..columns).step_by(TILE) {
            for column in (0..columns).step_by(TILE) {
                let first = [column, row].map(|at| at as i32 - blocks);
                let sums: [[u32; TILE]; TILE] = sums(&self.scores.coarse, side, coarse(), first);
                for (row, sums) in (row..columns).zip(&sums) {
                    let here = &mut bounds[row * columns..][column..columns.min(column + TILE)];
                    here.copy_from_slice(&sums[..here.len()]);
                }
            }
        }
        bounds
    }

    /// The best pose near one of a cell and a heading of the search, by smaller and smaller steps.
    fn polished(&self, points: &[Point2<f64>], mut pose: Isometry2<f64>) -> Correlated {
        let (mut score, mut share) = (self.score(points, &pose), 1.0);
        while share > MIN_STEP {
            let (step_m, step_rad) = (share * CORRELATION_CELL_M, share * CORRELATION_STEP_RAD);
            let mut is_better = false;
            for (x, y, turn_rad) in [(step_m, 0.0, 0.0), (0.0, step_m, 0.0), (0.0, 0.0, step_rad)] {
                for step in [interfaces::pose(x, y, turn_rad), interfaces::pose(-x, -y, -turn_rad)] {
                    let other = self.score(points, &(pose * step));
                    if other > score {
                        (pose, score, is_better) = (pose * step, other, true);
                    }
                }
            }
            if !is_better {
                share /= 2.0;
            }
        }
        let mut pose = self.predicted * pose;
        pose.rotation.renormalize();
        Correlated { pose, response: score / (f64::from(TOP_SCORE) * points.len().max(1) as f64) }
    }

    /// The sum of the scores of points, interpolated between the middles of cells.
    fn score(&self, points: &[Point2<f64>], pose: &Isometry2<f64>) -> f64 {
        let scores = &self.scores;
        let score = |point: &Point2<f64>| {
            let at = ((pose * point).coords + Vector2::repeat(HALF_SIDE_M)) / CORRELATION_CELL_M
                - Vector2::repeat(0.5);
            let low = [libm::floor(at.x), libm::floor(at.y)];
            let (right, up) = (at.x - low[0], at.y - low[1]);
            let [x, y] = low.map(|low| low as i32);
            let here = |dx, dy| {
                index([x + dx, y + dy], scores.side).map_or(0.0, |here| f64::from(scores.fine[here]))
            };
            let below = here(0, 0) * (1.0 - right) + here(1, 0) * right;
            let above = here(0, 1) * (1.0 - right) + here(1, 1) * right;
            below * (1.0 - up) + above * up
        };
        points.iter().map(score).sum()
    }
}

/// The points at all headings of a window.
fn headings(points: &[Point2<f64>], window: &Spread) -> Vec<Turned> {
    let steps = libm::ceil(window.rad / CORRELATION_STEP_RAD) as i32;
    let turned = |step: i32| {
        let turn_rad = f64::from(step) * window.rad / f64::from(steps);
        let rotation = interfaces::rotation(turn_rad);
        let cells = points.iter().map(|point| cell(&(rotation * point.coords))).collect();
        Turned { turn_rad, cells }
    };
    (-steps..=steps).map(turned).collect()
}

fn cell(at: &Vector2<f64>) -> [i32; 2] {
    [at.x, at.y].map(|at| libm::floor((at + HALF_SIDE_M) / CORRELATION_CELL_M) as i32)
}

/// What a pose counts by its distance from the prediction: 1 there, and never less than a quarter.
fn likelihood(turn_rad: f64, shift: [i32; 2], window: &Spread) -> f64 {
    let share = |x: f64| (1.0 - CORRELATION_PENALTY * x * x).max(0.5);
    let shift = Vector2::from(shift.map(f64::from)) * CORRELATION_CELL_M;
    share(shift.norm() / window.m) * share(turn_rad / window.rad)
}

fn squares(range: Range<i32>) -> impl Iterator<Item = [i32; 2]> {
    range.clone().flat_map(move |y| range.clone().map(move |x| [x, y]))
}

/// The end points of the beams of a scan, in the frame of the laser.
fn hits(scan: &Scan) -> impl Iterator<Item = Point2<f64>> {
    let farthest_m = CORRELATION_RANGE_M.min(scan.range_max_m);
    scan.ranges_m.iter().enumerate().filter_map(move |(beam, range_m)| {
        let range_m = f64::from(*range_m);
        let is_hit = range_m > scan.range_min_m && range_m < farthest_m;
        is_hit.then(|| interfaces::rotation(scan.angle_rad(beam)) * Point2::new(range_m, 0.0))
    })
}

/// The pose of a scan that fits best around the predicted one; where none fits, of all headings. `None` before the first
/// keyframe.
pub(super) fn found_among(keyframes: &[Keyframe], scan: &IncomingScan) -> Option<Correlated> {
    keyframes.first()?;
    let (LaserReading { scan: beams, mount, .. }, predicted) = (&scan.reading, &scan.predicted.pose);
    let is_near = |keyframe: &&Keyframe| {
        (keyframe.local.translation.vector - predicted.translation.vector).norm() <= CORRELATED_M
    };
    let best = |count: usize, window| {
        let last = keyframes.iter().rev().take(count).take_while(is_near);
        Correlation::of(last.map(|keyframe| (&keyframe.local, keyframe)), predicted)
            .best(beams, mount, window)
    };
    let near = best(CORRELATED_KEYFRAMES, CORRELATED);
    if near.response >= MIN_RESPONSE {
        return Some(near);
    }
    let other = best(RECENT_KEYFRAMES, ALL_HEADINGS);
    let is_sure = other.response >= SURE_RESPONSE && other.response > SURE_FACTOR * near.response;
    Some(if is_sure { other } else { near })
}

/// The match at a correlated pose. Straight surfaces say how well it is known: a direction that none of them fixes stays free.
pub(super) fn matched_at(pose: &Isometry2<f64>, points: &[ScanPoint]) -> Option<Match> {
    let mut found = Match {
        placement: Placement::rigid(pose),
        scan_information: points.iter().map(|point| information(point, pose)).sum(),
        information: Matrix3::zeros(),
        beam_covariance: Matrix3::zeros(),
        residual_ratio: 1.0,
    };
    found.scan_information = information_of(&found, SUBMAP_STD)?;
    found.information = found.scan_information;
    Some(found)
}

fn information(point: &ScanPoint, pose: &Isometry2<f64>) -> Matrix3<f64> {
    let j = derivative(&(pose.rotation * point.at.coords), &(pose.rotation * point.normal));
    j * j.transpose() * (point.weight / (CORRELATION_STD_M * CORRELATION_STD_M))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{heading_rad, pose};

    #[test]
    fn a_scan_is_found_where_it_was_taken() {
        let (local, mount) = (pose(3.0, -2.0, 0.7), pose(0.1, 0.0, 0.0));
        // The end of a room, which is not symmetric.
        let range_m = |beam: u8| {
            let angle_rad = -1.5 + 0.02 * f32::from(beam);
            let side_m = if angle_rad > 0.0 { 2.2 } else { 1.4 };
            (3.0 / angle_rad.cos()).min(side_m / angle_rad.sin().abs().max(1e-3))
        };
        let scan = Scan {
            angle_min_rad: -1.5,
            angle_increment_rad: 0.02,
            range_max_m: 80.0,
            ranges_m: (0_u8..150).map(range_m).collect(),
            ..Scan::default()
        };
        let from_last = (local, Matrix3::zeros());
        let keyframe = Keyframe { local, from_last, points: Vec::new(), mount, scan: scan.clone() };
        for predicted in [local * pose(0.21, -0.13, 0.3), local * pose(-0.1, 0.25, -0.2)] {
            let scores = Correlation::of(std::iter::once((&local, &keyframe)), &predicted);
            let found = scores.best(&scan, &mount, CORRELATED);
            let off = local.inv_mul(&found.pose);
            // Half a cell in each direction, and a little toward the prediction.
            assert!(off.translation.vector.norm() < 0.025 && heading_rad(&off).abs() < 0.01, "{off}");
            assert!(found.response > 0.9, "{}", found.response);
        }
    }
}
