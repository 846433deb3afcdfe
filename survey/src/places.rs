//! Places: neighbouring cells that change, as a person would point at them.

use crate::ChangeLog;
use crate::permanent::share_blocked;
use interfaces::{Cell, GridFrame};
use mapper::Mapper;
use nalgebra::Point2;
use serde::Serialize;
use std::collections::BTreeSet;

/// Cells that change belong to one place if they are at most this far apart, m.
const APART_M: f64 = 0.3;
/// A place has at least this area, m²: less is noise of the laser at an edge.
const MIN_M2: f64 = 0.02;
/// A larger place is divided, m: in a room full of people all changes are connected.
const MAX_M: f64 = 3.0;
/// The probability with which the interval contains the rate.
const MASS: f64 = 0.9;
const HOUR_S: f64 = 3600.0;

/// A place where something changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// The middle of the cells, m.
    pub x_m: f64,
    /// The middle of the cells, m.
    pub y_m: f64,
    /// The lower left corner of the rectangle around the cells, m.
    pub low_m: [f64; 2],
    /// The upper right corner of this rectangle, m.
    pub high_m: [f64; 2],
    /// The area of the cells that changed, m².
    pub area_m2: f64,
    /// The number of changes that were seen in the cell with the most changes.
    pub changes: u32,
    /// How often it changes; `None` where the times of the log are unusable.
    #[serde(flatten)]
    pub rates: Option<PlaceRates>,
}

/// How often a place changes, and when: it follows from the times of the readings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceRates {
    /// The cycles per hour (blocked, free, blocked again) of the cell with the median rate.
    pub cycles_per_hour: f64,
    /// The ends of the 90 % credible interval of this rate, 1/h; the upper one is `null` without an upper bound.
    pub cycles_per_hour_90: [Option<f64>; 2],
    /// The mean share of the time that the cells are blocked, from 0 to 1.
    pub share_blocked: f64,
    /// The time in view of the cells, mean, s.
    pub observed_s: f64,
    /// The time of the last change, s.
    pub last_change_s: f64,
}

/// The places where something changes, those with the most cycles first: the area times the lower end of the interval of
/// the rate, so that places that were seen for seconds do not come first.
pub fn places(mapper: &Mapper, log: &ChangeLog) -> Vec<Place> {
    let mut left: BTreeSet<usize> = mapper.changed().collect();
    let mut found = Vec::new();
    while let Some(first) = left.pop_first() {
        for cells in divided(mapper.frame(), connected_cells(mapper, first, &mut left)) {
            let area_m2 = cells.len() as f64 * mapper.frame().resolution_m().powi(2);
            if area_m2 >= MIN_M2 {
                found.extend(place(mapper, log, &cells, area_m2));
            }
        }
    }
    let activity = |place: &Place| {
        let least_per_hour = place.rates.as_ref().and_then(|rates| rates.cycles_per_hour_90[0]);
        place.area_m2 * least_per_hour.unwrap_or_default()
    };
    found.sort_by(|a, b| activity(b).total_cmp(&activity(a)));
    found
}

/// The cells of `left` that are connected with `first`; they are removed from `left`.
fn connected_cells(mapper: &Mapper, first: usize, left: &mut BTreeSet<usize>) -> Vec<usize> {
    let frame = mapper.frame();
    let reach = (APART_M / frame.resolution_m()).round().max(1.0) as i32;
    let (mut cells, mut next) = (vec![first], 0);
    while let Some(cell) = cells.get(next).map(|index| frame.cell(*index)) {
        next += 1;
        for y in -reach..=reach {
            for x in -reach..=reach {
                let beside = Cell { x: cell.x + x, y: cell.y + y };
                cells.extend(frame.index(beside).filter(|index| left.remove(index)));
            }
        }
    }
    cells
}

/// Cells in groups that are at most [`MAX_M`] long: a longer group is cut across its longer side, in the middle half of it,
/// where the fewest cells are.
fn divided(frame: &GridFrame, cells: Vec<usize>) -> Vec<Vec<usize>> {
    let most = (MAX_M / frame.resolution_m()).round().max(1.0) as i32;
    let at = |index: usize| frame.cell(index);
    let span = |of: &dyn Fn(Cell) -> i32| {
        let places = || cells.iter().map(|index| of(at(*index)));
        (places().min().unwrap_or_default(), places().max().unwrap_or_default())
    };
    let [x, y]: [&dyn Fn(Cell) -> i32; 2] = [&|cell| cell.x, &|cell| cell.y];
    let length = |(low, high): (i32, i32)| high - low + 1;
    let along = if length(span(x)) >= length(span(y)) { x } else { y };
    let (low, high) = span(along);
    if length((low, high)) <= most {
        return vec![cells];
    }
    let mut counts = vec![0_usize; length((low, high)) as usize];
    cells.iter().for_each(|index| counts[(along(at(*index)) - low) as usize] += 1);
    let quarter = counts.len() / 4;
    let middle = quarter.max(1)..(counts.len() - quarter);
    let half = counts.len() / 2;
    // Of two equal ones, the one nearer to the middle.
    let cut = middle.min_by_key(|line| (counts[*line], line.abs_diff(half))).unwrap_or(half) as i32 + low;
    let (before, after): (Vec<usize>, Vec<usize>) =
        cells.iter().copied().partition(|index| along(at(*index)) < cut);
    [before, after].into_iter().flat_map(|part| divided(frame, part)).collect()
}

fn place(mapper: &Mapper, log: &ChangeLog, cells: &[usize], area_m2: f64) -> Option<Place> {
    let frame = mapper.frame();
    let mean =
        |of: &dyn Fn(usize) -> f64| cells.iter().map(|index| of(*index)).sum::<f64>() / cells.len() as f64;
    let centers: Vec<Point2<f64>> = cells.iter().map(|index| frame.center(frame.cell(*index))).collect();
    let half_m = frame.resolution_m() / 2.0;
    let spans = centers.iter().map(|at| (*at, *at));
    let (low, high) = spans.reduce(|(low, high), (at, _)| (low.inf(&at), high.sup(&at)))?;
    let mut by_rate = cells.to_vec();
    by_rate.sort_by(|a, b| mapper.rate(*a).total_cmp(&mapper.rate(*b)));
    let median = by_rate[by_rate.len() / 2];
    let interval = mapper.credible_interval(median, MASS);
    let bound = |rate_hz: f64| Some(rate_hz * HOUR_S).filter(|rate| rate.is_finite());
    let rates = PlaceRates {
        cycles_per_hour: mapper.rate(median) * HOUR_S,
        cycles_per_hour_90: [bound(interval.0), bound(interval.1)],
        share_blocked: mean(&|index| share_blocked(mapper, index)),
        observed_s: mean(&|index| mapper.statistics(index).observed()),
        last_change_s: cells.iter().filter_map(|index| log.last_s(*index)).reduce(f64::max)?,
    };
    Some(Place {
        x_m: centers.iter().map(|at| at.x).sum::<f64>() / centers.len() as f64,
        y_m: centers.iter().map(|at| at.y).sum::<f64>() / centers.len() as f64,
        low_m: [low.x - half_m, low.y - half_m],
        high_m: [high.x + half_m, high.y + half_m],
        area_m2,
        changes: cells.iter().map(|index| mapper.statistics(*index).events()).max()?,
        rates: Some(rates),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_place_is_cut_where_little_changes() {
        let frame = GridFrame::new(Point2::origin(), 0.1, 80, 10).unwrap();
        // Two areas, and a line between them.
        let is_in = |cell: Cell| !(35..40).contains(&cell.x) || cell.y == 4;
        let cells: Vec<usize> = (0..frame.len()).filter(|index| is_in(frame.cell(*index))).collect();
        let groups = divided(&frame, cells.clone());
        assert_eq!(groups.iter().map(Vec::len).sum::<usize>(), cells.len());
        for group in &groups {
            let columns: BTreeSet<i32> = group.iter().map(|index| frame.cell(*index).x).collect();
            let (first, last) = (*columns.first().unwrap(), *columns.last().unwrap());
            assert!(last - first < 30 && (last < 40 || first >= 35), "{first} to {last}");
        }
        let small: Vec<usize> = cells.into_iter().filter(|index| frame.cell(*index).x < 30).collect();
        assert_eq!(divided(&frame, small.clone()), [small]);
    }
}
