//! The line map: short straight pieces of surface (surfels), found by their cell.
//!
//! A surfel is the mean of the points that hit it, and the mean of their normals. After [`FROZEN_SCANS`] scans it
//! never moves again: a map that follows its robot, which follows its map, drifts.

mod moving;
mod prior;
#[cfg(test)]
mod tests;

pub(crate) use moving::Checker;

use crate::changing_map::ChangingMap;
use crate::constants::{
    CLEARANCE_M, FROZEN_SCANS, MIN_NOISE_M, SAME_NORMAL, SETTLED_SCANS, STDS, SURFEL_M, TRUSTED_SCANS,
};
use crate::scan_points::ScanPoint;
use interfaces::{FARTHEST_M, GridFrame, ValueError, Values, read_value, runs, to_bytes, value};
use nalgebra::{Isometry2, Point2, Vector2};

/// Surfels in a cell: two sides of a thin wall, and a corner.
const PER_CELL: usize = 4;

/// The maximum number of cells of a grid of the localizer: they are stored one by one, seen or not.
const MAX_CELLS: usize = 1 << 26;
/// No surfel at this place in a cell.
const NONE: u32 = u32::MAX;

/// A short piece of a straight surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct Surfel {
    /// A point on the surface, m.
    pub(crate) at: Point2<f64>,
    /// The unit normal, toward the free side.
    pub(crate) normal: Vector2<f64>,
    /// The number of points that made the surfel.
    hits: u32,
    /// The number of scans that hit the surfel, up to [`FROZEN_SCANS`].
    scans: u32,
    /// The number of the last scan that hit the surfel.
    last_scan: u32,
    /// The number of consecutive checks that contradicted the surfel.
    misses: u32,
    /// The number of consecutive scans that saw the surface off its place, and the number of the last one.
    displaced: u32,
    last_displaced: u32,
    /// Whether the surface has moved.
    has_moved: bool,
    /// Whether the surface may have moved, since others have.
    is_doubted: bool,
    /// The weight by the learned rate of change, from 0 (changes often) to 1 (never changed).
    pub(crate) steadiness: f64,
    /// The cell in which the surfel is listed, or `NONE` for a removed surfel.
    cell: u32,
}

impl Surfel {
    fn is_removed(&self) -> bool {
        self.cell == NONE
    }
}

/// The line map.
#[derive(Clone, Debug)]
pub(crate) struct SurfelMap {
    /// The grid of the cells.
    pub(crate) frame: GridFrame,
    cells: Vec<[u32; PER_CELL]>,
    surfels: Vec<Surfel>,
    /// Places in `surfels` that can be used again.
    removed: Vec<u32>,
    /// The number of scans that were learned.
    scan: u32,
}

impl SurfelMap {
    /// A map without a surfel, that covers the rectangle of `frame` and a cell around it.
    pub(crate) fn new(frame: &GridFrame) -> Self {
        let frame = fitted(frame, SURFEL_M, 1);
        let cells = vec![[NONE; PER_CELL]; frame.len()];
        Self { frame, cells, surfels: Vec::new(), removed: Vec::new(), scan: 0 }
    }

    /// Everything that scans have changed.
    pub(crate) fn values(&mut self) -> Values<'_> {
        vec![runs(&mut self.cells), value(&mut self.surfels), value(&mut self.removed), value(&mut self.scan)]
    }

    /// The map as bytes, with the grid of its cells.
    pub(crate) fn saved(&mut self) -> Vec<u8> {
        let mut bytes = to_bytes(&self.frame);
        bytes.extend(interfaces::snapshot(self.values()));
        bytes
    }

    /// The map that [`saved`](Self::saved) has written.
    pub(crate) fn restored(mut bytes: &[u8]) -> Result<Self, ValueError> {
        let frame: GridFrame = read_value(&mut bytes)?;
        // A few bytes must not take gigabytes.
        if frame.len() > MAX_CELLS.min((1 << 25) + 256 * bytes.len()) {
            return Err(ValueError);
        }
        let cells = vec![[NONE; PER_CELL]; frame.len()];
        let mut map = Self { frame, cells, surfels: Vec::new(), removed: Vec::new(), scan: 0 };
        interfaces::restore(map.values(), bytes)?;
        map.check()?;
        Ok(map)
    }

    /// Checks values that were read: a state can hold anything.
    ///
    /// # Errors
    ///
    /// When a surfel does not exist to which others refer, or is nowhere.
    pub(crate) fn check(&self) -> Result<(), ValueError> {
        let (surfels, cells) = (self.surfels.len(), self.cells.len());
        let is_sound = |surfel: &Surfel| {
            let numbers = surfel.at.iter().chain(surfel.normal.iter()).chain([&surfel.steadiness]);
            (surfel.is_removed() || (surfel.cell as usize) < cells)
                && numbers.into_iter().all(|number| number.abs() <= FARTHEST_M)
        };
        let listed = self.cells.iter().flatten().filter(|index| **index != NONE).chain(&self.removed);
        let is_sound = listed.into_iter().all(|index| (*index as usize) < surfels)
            && self.surfels.iter().all(is_sound)
            && self.scan <= u32::MAX / 2;
        if is_sound { Ok(()) } else { Err(ValueError) }
    }

    /// The surfel at an index from [`SurfelMap::nearest`].
    #[inline]
    pub(crate) fn surfel(&self, index: u32) -> &Surfel {
        &self.surfels[index as usize]
    }

    /// All surfels that take part in matching.
    pub(crate) fn usable(&self) -> impl Iterator<Item = &Surfel> {
        self.surfels.iter().filter(|surfel| !surfel.is_removed() && surfel.weight() > 0.0)
    }

    /// Whether no surfel takes part in matching.
    pub(crate) fn is_empty(&self) -> bool {
        self.usable().next().is_none()
    }

    /// The surfel that is nearest along the surface to a point of a surface, and the signed distance of the point from
    /// its line (m); at most `gate_m`. Surfels that do not take part in matching yet are found as well.
    #[inline]
    pub(crate) fn nearest(&self, at: &Point2<f64>, normal: &Vector2<f64>, gate_m: f64) -> Option<(u32, f64)> {
        let mut best: Option<(u32, f64)> = None;
        let mut best_m = SURFEL_M;
        self.around(at, gate_m.max(SURFEL_M / 2.0), |index, surfel| {
            if surfel.normal.dot(normal) < SAME_NORMAL {
                return;
            }
            let to = at - surfel.at;
            let (off_m, along_m) = (surfel.normal.dot(&to), surfel.normal.perp(&to));
            // Of two equally near ones, the first in the order of the cells.
            if off_m.abs() < gate_m && along_m.abs() < best_m {
                best_m = along_m.abs();
                best = Some((index, off_m));
            }
        });
        best
    }

    /// Calls `visit` with every surfel that takes part in matching in the cells of a rectangle.
    pub(crate) fn within(&self, low: &Point2<f64>, high: &Point2<f64>, mut visit: impl FnMut(&Surfel)) {
        self.in_cells(low, high, |_, surfel| {
            if surfel.weight() > 0.0 {
                visit(surfel);
            }
        });
    }

    /// Calls `visit` with every surfel in the cells within `reach_m` of a point.
    #[inline]
    fn around(&self, at: &Point2<f64>, reach_m: f64, visit: impl FnMut(u32, &Surfel)) {
        let reach = Vector2::new(reach_m, reach_m);
        self.in_cells(&(at - reach), &(at + reach), visit);
    }

    #[inline]
    fn in_cells(&self, low: &Point2<f64>, high: &Point2<f64>, mut visit: impl FnMut(u32, &Surfel)) {
        let (low, high) = (self.frame.cell_at(low), self.frame.cell_at(high));
        let (width, height) = (self.frame.width() as i32, self.frame.height() as i32);
        let (left, right) = (low.x.max(0), high.x.min(width - 1));
        if left > right {
            return;
        }
        for y in low.y.max(0)..=high.y.min(height - 1) {
            let row = (y * width) as usize;
            for cell in &self.cells[row + left as usize..=row + right as usize] {
                for &index in cell.iter().take_while(|index| **index != NONE) {
                    visit(index, &self.surfels[index as usize]);
                }
            }
        }
    }

    /// Adds a surfel, unless it is outside of the map or its cell is full.
    fn add(&mut self, at: Point2<f64>, normal: Vector2<f64>, scans: u32) -> Option<u32> {
        let cell = self.frame.index(self.frame.cell_at(&at))?;
        let place = self.cells[cell].iter().position(|&index| index == NONE)?;
        let surfel = Surfel {
            at,
            normal,
            hits: scans,
            scans,
            last_scan: self.scan,
            last_displaced: self.scan,
            steadiness: 1.0,
            cell: cell as u32,
            ..Surfel::default()
        };
        let index = match self.removed.pop() {
            Some(index) => {
                self.surfels[index as usize] = surfel;
                index
            }
            None => {
                self.surfels.push(surfel);
                (self.surfels.len() - 1) as u32
            }
        };
        self.cells[cell][place] = index;
        Some(index)
    }

    fn remove(&mut self, index: u32) {
        let cell = self.surfels[index as usize].cell as usize;
        let list = &mut self.cells[cell];
        if let Some(place) = list.iter().position(|&other| other == index) {
            list.copy_within(place + 1.., place);
            list[PER_CELL - 1] = NONE;
        }
        self.surfels[index as usize].cell = NONE;
        self.removed.push(index);
    }
}

/// The frame of cells of `cell_m` that covers a frame and a border of some cells around it. Where these are more than
/// [`MAX_CELLS`], they are twice as large, four times, and so on: a place of any size is covered as a whole.
pub(crate) fn fitted(frame: &GridFrame, cell_m: f64, border: usize) -> GridFrame {
    let fitted = |doublings: i32| {
        let cell_m = cell_m * 2_f64.powi(doublings);
        let cells = |count: usize| {
            let cells = (count as f64 * frame.resolution_m() / cell_m).ceil() as usize;
            cells.saturating_add(2 * border)
        };
        let beside = Vector2::repeat(cell_m * border as f64);
        let fitted =
            GridFrame::new(frame.origin() - beside, cell_m, cells(frame.width()), cells(frame.height()));
        fitted.filter(|fitted| fitted.len() <= MAX_CELLS)
    };
    (0..64).find_map(fitted).unwrap_or(*frame)
}

// How surfels are learned from scans with a certain pose.

impl SurfelMap {
    /// Updates the map with a scan, whose new surfels count as seen in a number of scans: those of a keyframe, which represents all
    /// scans around it, take part in matching at once. If `follows`, surfels follow surfaces that have moved; else, what seems to
    /// have moved stays where it is.
    pub(crate) fn learn(
        &mut self,
        points: &[ScanPoint],
        pose: &Isometry2<f64>,
        range_noise_std_m: f64,
        scans: u32,
        follows: bool,
    ) {
        let gate_m = STDS * range_noise_std_m.max(MIN_NOISE_M);
        self.scan = self.scan.wrapping_add(1);
        for point in points {
            let (at, normal) = (pose * point.at, pose.rotation * point.normal);
            match self.nearest(&at, &normal, gate_m) {
                Some((index, _)) => self.hit(index, &at, &normal),
                None => match self.nearest(&at, &normal, CLEARANCE_M) {
                    None => {
                        self.add(at, normal, scans);
                    }
                    Some((index, off_m)) if follows => self.displace(index, off_m),
                    Some(_) => {}
                },
            }
        }
    }

    fn hit(&mut self, index: u32, at: &nalgebra::Point2<f64>, normal: &nalgebra::Vector2<f64>) {
        let surfel = &mut self.surfels[index as usize];
        (surfel.misses, surfel.displaced, surfel.is_doubted) = (0, 0, false);
        if surfel.has_moved && surfel.scans >= SETTLED_SCANS {
            surfel.has_moved = false;
        }
        if surfel.scans >= FROZEN_SCANS && !surfel.has_moved {
            return;
        }
        surfel.scans += u32::from(surfel.last_scan != self.scan);
        surfel.last_scan = self.scan;
        surfel.hits += 1;
        let share =
            1.0 / f64::from(if surfel.has_moved { surfel.hits.min(TRUSTED_SCANS) } else { surfel.hits });
        surfel.at += (at - surfel.at) * share;
        let mean = surfel.normal + (normal - surfel.normal) * share;
        let length = mean.norm();
        if length > 0.0 {
            surfel.normal = mean / length;
        }
    }

    /// Takes over the learned rates of change as weights.
    pub(crate) fn weigh_by_rates(&mut self, map: &dyn ChangingMap, horizon_s: f64) {
        let states = map.states();
        for surfel in self.surfels.iter_mut().filter(|surfel| !surfel.is_removed()) {
            // The map counts a hit a little behind the surface.
            let behind = surfel.at - surfel.normal * (0.2 * SURFEL_M);
            let cell = states.frame().index(states.frame().cell_at(&behind));
            let rate = cell.map_or(0.0, |index| map.rate(index));
            surfel.steadiness = libm::exp(-rate * horizon_s).clamp(0.0, 1.0);
        }
    }
}
