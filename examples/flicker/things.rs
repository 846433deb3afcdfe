//! The things that are not static: a box that is removed, and a disc that drives past.

use crate::PERIOD_S;
use crate::house::{CELL_M, House, Thing, rectangle};
use interfaces::CellState;
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};

/// The lower left corners of the two boxes, m: one in the open, one beside a wall.
pub(crate) const BOXES: [(f64, f64); 2] = [(1.5, 3.0), (0.1, 1.0)];
const BOX_M: f64 = 0.4;
/// The time at which the box is removed, s.
const GOES_S: f64 = 30.0;
/// The disc: its radius, speed, and the height of its path above the lower wall.
const DISC_M: f64 = 0.2;
const DISC_MPS: f64 = 0.3;
const DISC_PATH_M: f64 = 0.35;

/// A slow circle in the lower left room.
fn pose(house: &House, time_s: f64) -> Isometry2<f64> {
    let angle = 0.1 * time_s;
    let at = house.turned(Point2::new(3.0 + 0.8 * angle.cos(), 2.0 + 0.8 * angle.sin()));
    interfaces::pose(at.x, at.y, angle)
}

/// The time from the removal of a box until half and nine tenths of its cells are free, s; ∞ if this takes more
/// than 20 s.
pub(crate) fn cleared_after(
    mut house: House,
    settings: &MapperSettings,
    (x, y): (f64, f64),
) -> anyhow::Result<(f64, f64)> {
    house.add(Thing { corners: rectangle(x, y, x + BOX_M, y + BOX_M), from_s: -1.0, until_s: GOES_S });
    let mut mapper = Mapper::new(settings, house.frame)?;
    let (mut cells, mut half_s, mut most_s) = (Vec::new(), f64::INFINITY, f64::INFINITY);
    for scan in 0..((GOES_S + 20.0) / PERIOD_S) as u32 {
        let time_s = f64::from(scan) * PERIOD_S;
        let is_blocked = |mapper: &Mapper, index: usize| mapper.states().cells()[index] == CellState::Blocked;
        if cells.is_empty() && time_s >= GOES_S {
            cells = (0..house.frame.len())
                .filter(|&index| is_blocked(&mapper, index) && house.truth(index, time_s) == CellState::Free)
                .filter(|&index| house.truth(index, 0.0) != CellState::Free)
                .collect();
        }
        mapper.update(&house.reading(time_s, pose(&house, time_s), &[]))?;
        if time_s >= GOES_S {
            let left = cells.iter().filter(|&&index| is_blocked(&mapper, index)).count();
            let since_s = time_s - GOES_S + PERIOD_S;
            if 2 * left <= cells.len() {
                half_s = half_s.min(since_s);
            }
            if 10 * left <= cells.len() {
                most_s = most_s.min(since_s);
            }
        }
    }
    Ok((half_s, most_s))
}

/// The times from the first beam that shows a change to the map's change, s.
#[derive(Default)]
pub(crate) struct Latencies {
    pub(crate) block_s: Vec<f64>,
    pub(crate) free_s: Vec<f64>,
    /// The number of changes that a beam showed and that were over before the map changed.
    missed: usize,
}

impl Latencies {
    pub(crate) fn missed_share(&self) -> f64 {
        self.missed as f64 / (self.missed + self.block_s.len() + self.free_s.len()).max(1) as f64
    }
}

/// Measures the latencies for a disc that drives back and forth along the lower wall. Cells that the disc covers
/// only partly are neither correct nor incorrect.
pub(crate) fn latencies(mut house: House, settings: &MapperSettings) -> anyhow::Result<Latencies> {
    let mut mapper = Mapper::new(settings, house.frame)?;
    let path: Vec<usize> = (0..house.frame.len())
        .filter(|&index| {
            let middle = house.frame.center(house.frame.cell(index));
            let is_near = |tick: i32| (disc_at(&house, f64::from(tick) * 0.1) - middle).norm() < DISC_M;
            (200..340).any(is_near) && house.truth(index, 0.0) == CellState::Free
        })
        .collect();
    let mut found = Latencies::default();
    let mut shown_s = vec![f64::NAN; house.frame.len()];
    for scan in 0..1000 {
        let time_s = f64::from(scan) * PERIOD_S;
        let disc = disc_at(&house, time_s);
        let discs = if time_s < 20.0 { vec![] } else { vec![(disc, DISC_M)] };
        let reading = house.reading(time_s, pose(&house, time_s), &discs);
        let before = mapper.states().clone();
        mapper.update(&reading)?;
        if discs.is_empty() {
            continue;
        }
        let (ended, crossed) = touched(&house, &reading);
        for &index in &path {
            let truth = disc_truth(house.frame.center(house.frame.cell(index)), disc);
            let (was, is) = (before.cells()[index], mapper.states().cells()[index]);
            let shows = match (was, truth) {
                (CellState::Free, CellState::Blocked) => ended[index],
                (CellState::Blocked, CellState::Free) => crossed[index],
                _ => {
                    // The change was over, completely or partly, before the map changed.
                    if !shown_s[index].is_nan() && truth == was {
                        found.missed += 1;
                        shown_s[index] = f64::NAN;
                    }
                    continue;
                }
            };
            if shows && shown_s[index].is_nan() {
                shown_s[index] = time_s;
            }
            if is == truth && !shown_s[index].is_nan() {
                let latency_s = time_s - shown_s[index];
                if truth == CellState::Blocked { &mut found.block_s } else { &mut found.free_s }
                    .push(latency_s);
                shown_s[index] = f64::NAN;
            }
        }
    }
    Ok(found)
}

/// Back and forth over four meters.
fn disc_at(house: &House, time_s: f64) -> Point2<f64> {
    let along_m = (DISC_MPS * (time_s - 20.0)).rem_euclid(8.0);
    house.turned(Point2::new(1.0 + along_m.min(8.0 - along_m), DISC_PATH_M))
}

fn disc_truth(middle: Point2<f64>, disc: Point2<f64>) -> CellState {
    let off = (middle - disc).abs();
    let half = nalgebra::Vector2::repeat(CELL_M / 2.0);
    if (off + half).norm() <= DISC_M {
        CellState::Blocked
    } else if (off - half).map(|side| side.max(0.0)).norm() >= DISC_M {
        CellState::Free
    } else {
        CellState::Unknown
    }
}

/// The cells in which beams ended, and the cells that beams crossed.
fn touched(house: &House, reading: &interfaces::LaserReading) -> (Vec<bool>, Vec<bool>) {
    let (mut ended, mut crossed) = (vec![false; house.frame.len()], vec![false; house.frame.len()]);
    for (beam, &range_m) in reading.scan.ranges_m.iter().enumerate() {
        let range_m = f64::from(range_m).min(reading.scan.range_max_m);
        let at = |along_m: f64| {
            let point = interfaces::rotation(reading.scan.angle_rad(beam)) * Point2::new(along_m, 0.0);
            house.frame.index(house.frame.cell_at(&(reading.pose * point)))
        };
        let end = at(range_m);
        if let Some(end) = end {
            ended[end] = true;
        }
        let steps = (range_m / (CELL_M / 4.0)) as usize;
        for cell in (0..steps).filter_map(|step| at(step as f64 * CELL_M / 4.0)) {
            crossed[cell] |= Some(cell) != end;
        }
    }
    (ended, crossed)
}

/// The median; 0 without values.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
