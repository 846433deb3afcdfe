//! Straight lines of cells.

use interfaces::GridFrame;
use nalgebra::{Point2, Vector2};

/// A line of cells.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Segment {
    /// The ends, m.
    pub ends: [Point2<f64>; 2],
}

impl Segment {
    /// The length, m.
    pub fn length_m(&self) -> f64 {
        (self.ends[1] - self.ends[0]).norm()
    }

    /// The distance of a point from the segment, both ends included, m.
    pub fn distance_m(&self, point: &Point2<f64>) -> f64 {
        let (along, to) = (self.ends[1] - self.ends[0], point - self.ends[0]);
        let share = (to.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (to - along * share).norm()
    }

    /// The segment from a point, m.
    pub(super) fn from(start: Point2<f64>, heading_rad: f64, length_m: f64) -> Self {
        Self { ends: [start, start + interfaces::rotation(heading_rad) * Vector2::x() * length_m] }
    }

    /// The cells along the segment.
    pub(super) fn cells(&self, frame: &GridFrame) -> Vec<u32> {
        let steps = (4.0 * self.length_m() / frame.resolution_m()) as usize;
        let point =
            |step: usize| self.ends[0] + (self.ends[1] - self.ends[0]) * ((step as f64 + 0.5) / steps as f64);
        let along = (0..steps).filter_map(|step| frame.index(frame.cell_at(&point(step))));
        let mut cells: Vec<u32> = along.map(|index| index as u32).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// Whether each end is near one of the other segment.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        const NEAR_M: f64 = 0.25;
        let [a, b] = self.ends;
        let is = |[c, d]: [Point2<f64>; 2]| (a - c).norm() < NEAR_M && (b - d).norm() < NEAR_M;
        is(other.ends) || is([other.ends[1], other.ends[0]])
    }

    /// The direction from the first end to the second.
    pub(super) fn along(&self) -> Vector2<f64> {
        (self.ends[1] - self.ends[0]).normalize()
    }

    /// The position of a point along the segment, from the first end, and its distance from the line, m.
    pub(super) fn position(&self, point: &Point2<f64>) -> (f64, f64) {
        let (along, to) = (self.along(), point - self.ends[0]);
        (along.dot(&to), along.perp(&to))
    }
}

/// The shortest and the longest leaf, m, and the shortest part of one that says something.
pub(super) const LENGTHS_M: [f64; 2] = [0.55, 2.0];
const MIN_PART_M: f64 = 0.4;
/// The cells of a leaf are at most this far from its line, in cells.
const OFF: f64 = 1.0;
/// A gap in the cells of a leaf, in cells.
const MAX_GAP: f64 = 3.0;
/// The number of cells that are tried as ends of a line.
const TRIED: usize = 16;

/// The line that most of some points are on, the centers of cells; with the points that are on it.
pub(super) fn fit(points: &[Point2<f64>], cell_m: f64) -> Option<(Segment, Vec<usize>)> {
    let min = (MIN_PART_M / cell_m) as usize;
    if points.len() < min {
        return None;
    }
    let step = points.len().div_ceil(TRIED);
    let tried: Vec<_> = points.iter().step_by(step).collect();
    let on = |a: &Point2<f64>, along: &Vector2<f64>| {
        let off_m = OFF * cell_m;
        points.iter().filter(|point| along.perp(&(*point - a)).abs() <= off_m).count()
    };
    let mut best = (0, points[0], Vector2::x());
    for (number, a) in tried.iter().enumerate() {
        for b in &tried[number + 1..] {
            let to = *b - *a;
            if to.norm() < MIN_PART_M * 0.75 {
                continue;
            }
            let along = to.normalize();
            let count = on(a, &along);
            if count > best.0 {
                best = (count, **a, along);
            }
        }
    }
    let (count, a, along) = best;
    if count < min {
        return None;
    }
    let near = |a: &Point2<f64>, along: &Vector2<f64>| -> Vec<usize> {
        let is_on = |&index: &usize| along.perp(&(points[index] - a)).abs() <= OFF * cell_m;
        (0..points.len()).filter(is_on).collect()
    };
    let first = run(points, near(&a, &along), &a, &along, cell_m);
    let (middle, along) = principal(points, &first)?;
    let on = run(points, near(&middle, &along), &middle, &along, cell_m);
    let segment = span(points, &on, cell_m)?;
    let length_m = segment.length_m();
    if !(MIN_PART_M..LENGTHS_M[1] + 0.3).contains(&length_m) {
        return None;
    }
    // Filled, and nothing beside it.
    let steps = (length_m / cell_m).round();
    let mut filled: Vec<i64> = on.iter().map(|&i| (segment.position(&points[i]).0 / cell_m) as i64).collect();
    filled.sort_unstable();
    filled.dedup();
    let beside = (0..points.len()).filter(|i| !on.contains(i)).filter(|&i| {
        let (position, off) = segment.position(&points[i]);
        (-0.1..length_m + 0.1).contains(&position) && off.abs() < 0.3
    });
    let is_leaf = filled.len() as f64 >= 0.7 * steps && (beside.count() as f64) < 0.5 * on.len() as f64;
    is_leaf.then_some((segment, on))
}

/// The longest run of points without a large gap along a line.
fn run(
    points: &[Point2<f64>],
    mut on: Vec<usize>,
    a: &Point2<f64>,
    along: &Vector2<f64>,
    cell_m: f64,
) -> Vec<usize> {
    let position = |index: usize| along.dot(&(points[index] - a));
    on.sort_by(|a, b| position(*a).total_cmp(&position(*b)));
    let runs = on.chunk_by(|a, b| position(*b) - position(*a) <= MAX_GAP * cell_m);
    runs.max_by(|a, b| {
        let length = |run: &[usize]| position(run[run.len() - 1]) - position(run[0]);
        length(a).total_cmp(&length(b))
    })
    .map(<[usize]>::to_vec)
    .unwrap_or_default()
}

/// The middle and the principal direction of points.
fn principal(points: &[Point2<f64>], on: &[usize]) -> Option<(Point2<f64>, Vector2<f64>)> {
    if on.len() < 3 {
        return None;
    }
    let mean = on.iter().map(|&i| points[i].coords).sum::<Vector2<f64>>() / on.len() as f64;
    let [mut xx, mut xy, mut yy] = [0.0; 3];
    for &i in on {
        let off = points[i].coords - mean;
        xx += off.x * off.x;
        xy += off.x * off.y;
        yy += off.y * off.y;
    }
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    Some((Point2::from(mean), Vector2::new(libm::cos(angle), libm::sin(angle))))
}

/// The segment from one end of points to the other.
pub(super) fn span(points: &[Point2<f64>], on: &[usize], cell_m: f64) -> Option<Segment> {
    let (middle, along) = principal(points, on)?;
    let positions = on.iter().map(|&i| along.dot(&(points[i] - middle)));
    let (low, high) = positions.fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)));
    // Half a cell beyond the centers of the last cells, along an axis of the grid.
    let half_m = 0.5 * cell_m / along.x.abs().max(along.y.abs());
    Some(Segment { ends: [middle + along * (low - half_m), middle + along * (high + half_m)] })
}
