//! What scans say about each other: where they hit, and through which of these cells the beams of others pass.

use interfaces::Cell;
use nalgebra::{Isometry2, Point2};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// The side of a cell, m.
const CELL_M: f64 = 0.1;
/// A beam passes what is this much nearer than its end, m and as a share of its range: what a slanted surface and an error of the
/// heading explain.
const BEFORE_END_M: f64 = 0.3;
const BEFORE_END: f64 = 0.03;
/// Cells are free if at least this many scans passed them.
const MIN_PASSES: u32 = 3;
/// Hits that follow each other in free space are a surface that is out of place if they reach this far, m: people, and the leaves of
/// doors, are smaller.
const MIN_SURFACE_M: f64 = 1.2;
/// Two hits are on one surface up to this distance, m and as a share of the range.
const ONE_SURFACE_M: f64 = 0.5;
const ONE_SURFACE: f64 = 0.1;
/// The number of scans before and after one that see the same on the same pass.
const SAME_PASS: usize = 15;

/// A hash of the two numbers of a cell, by multiplication (Knuth 1998, section 6.4). They come from the scans of one log, and are looked up
/// at every step of every beam: a hash that withstands chosen keys took most of the time.
#[derive(Clone, Copy, Debug, Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_i32(i32::from(*byte)));
    }

    fn write_i32(&mut self, number: i32) {
        self.0 = (self.0.rotate_left(32) ^ u64::from(number as u32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

/// A scan in the frame of the map.
#[derive(Clone, Debug)]
pub(super) struct PlacedScan {
    laser: Point2<f64>,
    hits: Vec<Point2<f64>>,
}

impl PlacedScan {
    /// From the pose of the robot, and the laser and the hits in its frame.
    pub(super) fn new(pose: &Isometry2<f64>, laser: &Point2<f64>, hits: &[Point2<f64>]) -> Self {
        Self { laser: pose * laser, hits: hits.iter().map(|hit| pose * hit).collect() }
    }

    /// The number of hits in free space that lie on surfaces.
    fn on_surfaces(&self, is_in_free: &[bool]) -> u32 {
        let in_free: Vec<Point2<f64>> = self
            .hits
            .iter()
            .zip(is_in_free)
            .filter(|(_, is_in_free)| **is_in_free)
            .map(|(hit, _)| *hit)
            .collect();
        let is_one_surface = |a: &Point2<f64>, b: &Point2<f64>| {
            (a - b).norm() < ONE_SURFACE_M + ONE_SURFACE * (b - self.laser).norm()
        };
        let is_surface = |run: &&[Point2<f64>]| (run[0] - run[run.len() - 1]).norm() >= MIN_SURFACE_M;
        in_free.chunk_by(is_one_surface).filter(is_surface).map(|run| run.len() as u32).sum()
    }

    fn cells(&self) -> impl Iterator<Item = Cell> {
        self.hits.iter().map(key)
    }

    /// Each cell with a hit once, in order.
    fn distinct_cells(&self) -> Vec<Cell> {
        let mut cells: Vec<Cell> = self.cells().collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }
}

/// A scan against all others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged {
    /// The share of its hits on surfaces where more other scans passed than hit.
    pub(super) in_free: f64,
    /// The share of its hits near hits of the scans before it; 1 for the first scan.
    pub(super) link: f64,
    /// The share of its hits that were seen on this pass only.
    pub(super) seen_once: f64,
}

/// What was seen of a cell that was hit. Scans are numbers, from 1.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    hits: u32,
    passes: u32,
    /// The last scan that hit it, and the last one that passed it.
    hit_by: u32,
    passed_by: u32,
    /// The scans shortly before the present one that hit it, and those shortly after it.
    before: u32,
    after: u32,
}

/// The cells that were hit. They are only looked up, so that their order is without meaning.
#[derive(Debug, Default)]
pub(super) struct Evidence(HashMap<Cell, Seen, BuildHasherDefault<CellHasher>>);

impl Evidence {
    /// Every scan against all others, in their order.
    pub(super) fn judge(scans: &[PlacedScan]) -> Vec<Judged> {
        let mut evidence = Self::default();
        let numbered = || (1..).zip(scans);
        numbered().for_each(|(number, scan)| evidence.hit(number, scan));
        numbered().for_each(|(number, scan)| evidence.pass(number, scan));
        scans.iter().take(SAME_PASS + 1).for_each(|scan| evidence.neighbor(scan, |seen| seen.after += 1));
        let mut judged = Vec::with_capacity(scans.len());
        for (index, scan) in scans.iter().enumerate() {
            evidence.neighbor(scan, |seen| seen.after -= 1);
            let is_first = scans[..index].iter().all(|scan| scan.hits.is_empty());
            judged.push(evidence.judged(scan, is_first));
            evidence.neighbor(scan, |seen| seen.before += 1);
            if let Some(old) = index.checked_sub(SAME_PASS) {
                evidence.neighbor(&scans[old], |seen| seen.before -= 1);
            }
            if let Some(new) = scans.get(index + SAME_PASS + 1) {
                evidence.neighbor(new, |seen| seen.after += 1);
            }
        }
        judged
    }

    /// The shares of the hits of scans that are near hits of other scans.
    pub(super) fn links(others: &[PlacedScan], scans: &[PlacedScan]) -> Vec<f64> {
        let mut evidence = Self::default();
        others.iter().for_each(|scan| evidence.neighbor(scan, |seen| seen.before += 1));
        scans.iter().map(|scan| evidence.linked(scan)).collect()
    }

    fn hit(&mut self, number: u32, scan: &PlacedScan) {
        for cell in scan.cells() {
            let seen = self.0.entry(cell).or_default();
            if seen.hit_by != number {
                (seen.hit_by, seen.hits) = (number, seen.hits + 1);
            }
        }
    }

    /// Counts the cells that a scan passes and does not hit.
    fn pass(&mut self, number: u32, scan: &PlacedScan) {
        for cell in scan.cells() {
            self.0.entry(cell).or_default().passed_by = number;
        }
        for hit in &scan.hits {
            let beam = hit - scan.laser;
            let range_m = beam.norm();
            let free_m = range_m * (1.0 - BEFORE_END) - BEFORE_END_M;
            let steps = (free_m / CELL_M).max(0.0) as usize;
            let mut last = None;
            for step in 1..=steps {
                let at = key(&(scan.laser + beam * (step as f64 * CELL_M / range_m)));
                if last.replace(at) == Some(at) {
                    continue;
                }
                if let Some(seen) = self.0.get_mut(&at).filter(|seen| seen.passed_by != number) {
                    (seen.passed_by, seen.passes) = (number, seen.passes + 1);
                }
            }
        }
    }

    /// Counts a scan in every cell that it hits, as `count` does: once, as in `hits`.
    fn neighbor(&mut self, scan: &PlacedScan, count: impl Fn(&mut Seen)) {
        scan.distinct_cells().into_iter().for_each(|cell| count(self.0.entry(cell).or_default()));
    }

    /// The share of the hits of a scan that are near hits of the scans before it.
    fn linked(&self, scan: &PlacedScan) -> f64 {
        let is_before = |cell: &Cell| self.0.get(cell).is_some_and(|seen| seen.before > 0);
        let linked = scan.cells().filter(|cell| cell.square(1).any(|cell| is_before(&cell))).count();
        linked as f64 / scan.hits.len().max(1) as f64
    }

    fn judged(&self, scan: &PlacedScan, is_first: bool) -> Judged {
        let own = scan.distinct_cells();
        let mut seen_once = 0;
        let mut is_in_free = Vec::with_capacity(scan.hits.len());
        for cell in scan.cells() {
            let around = || cell.square(1).filter_map(|cell| self.0.get(&cell).map(|seen| (cell, *seen)));
            let hits: u32 =
                around().map(|(cell, seen)| seen.hits - u32::from(own.binary_search(&cell).is_ok())).sum();
            let passes = self.0.get(&cell).map_or(0, |seen| seen.passes);
            is_in_free.push(passes >= MIN_PASSES && hits < passes);
            let elsewhere = |(cell, seen): (Cell, Seen)| {
                seen.hits > seen.before + seen.after + u32::from(own.binary_search(&cell).is_ok())
            };
            seen_once += u32::from(!around().any(elsewhere));
        }
        let share = |count: u32| f64::from(count) / scan.hits.len().max(1) as f64;
        let link = if is_first || scan.hits.is_empty() { 1.0 } else { self.linked(scan) };
        let in_free = scan.on_surfaces(&is_in_free);
        Judged { in_free: share(in_free), link, seen_once: share(seen_once) }
    }
}

fn key(at: &Point2<f64>) -> Cell {
    Cell::new((at.x / CELL_M).floor() as i32, (at.y / CELL_M).floor() as i32)
}
