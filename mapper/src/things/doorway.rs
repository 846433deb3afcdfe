//! Places where a door can be: a line between two walls that was blocked and became free, or the other way round.

use super::line::Line;
use super::segment::{self, LENGTHS_M, Segment};
use crate::change::CellMap;
use interfaces::CellState;
use nalgebra::{Point2, Vector2};

/// A line is a part of a leaf if its walls are at most this far from its ends, m.
const MAX_HIDDEN_M: f64 = 0.5;
/// Two lines are the same one if they differ by at most this angle, rad, and this distance, m.
const SAME_RAD: f64 = 0.2;
const SAME_M: f64 = 0.1;
/// An end of a leaf is at most this far from its hinge, m.
const HINGE_M: f64 = 0.2;
/// A leaf opens by at least this angle, rad.
const MIN_OPEN_RAD: f64 = 0.7;
/// The weight of a line as evidence of the open leaf: if the closed leaf changed the other way at that time, and if not.
const TOGETHER: f64 = 2.0;
const ALONE: f64 = 0.5;
/// Evidence that makes a door, and its open leaf.
const MIN_COVERAGE: f64 = 0.7;
const MIN_PART: f64 = 0.45;
const MIN_LINES: u32 = 2;
const MIN_OPEN_WEIGHT: f64 = 2.0;

/// How often each cell was on a line.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
struct CellCounts(Vec<(u32, u16)>);

impl CellCounts {
    fn add(&mut self, cells: &[u32]) {
        for &cell in cells {
            match self.0.binary_search_by_key(&cell, |(cell, _)| *cell) {
                Ok(at) => self.0[at].1 = self.0[at].1.saturating_add(1),
                Err(at) => self.0.insert(at, (cell, 1)),
            }
        }
    }

    /// The cells that are on the line often.
    fn often(&self, share: f64) -> impl Iterator<Item = u32> {
        let most = self.0.iter().map(|(_, count)| *count).max().unwrap_or(0);
        let min = (share * f64::from(most)).max(1.0);
        self.0.iter().filter(move |(_, count)| f64::from(*count) >= min).map(|(cell, _)| *cell)
    }

    fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.0.iter_mut().for_each(|(cell, _)| f(cell));
        self.0.sort_unstable();
    }
}

/// Where the leaf of a doorway may stand when it is open: at one of the ends, to one of the sides.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
struct OpenLeaf {
    cells: CellCounts,
    weight: f64,
}

/// A place where a door can be.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct Doorway {
    cells: CellCounts,
    /// From wall to wall.
    pub(super) closed: Segment,
    /// The number of lines that were freed, and that were blocked.
    pub(super) lines: [u32; 2],
    /// The largest share of the line that changed at once.
    coverage: f64,
    pub(super) last_s: f64,
    open: [OpenLeaf; 4],
    /// The thing that it has become.
    pub(super) thing: Option<u32>,
}

impl Doorway {
    /// The doorway in which a line is, if it is between walls.
    pub(super) fn of(line: &Line, map: &CellMap) -> Option<Self> {
        let mut cells = CellCounts::default();
        cells.add(&line.cells);
        let (closed, coverage) = between_walls(&line.segment, map)?;
        Some(Self {
            cells,
            closed,
            lines: [0, 1].map(|blocked| u32::from(blocked == u8::from(line.is_blocked))),
            coverage,
            last_s: line.time_s,
            open: Default::default(),
            thing: None,
        })
    }

    /// Adds a line that is a part of the closed leaf.
    pub(super) fn add(&mut self, line: &Line, map: &CellMap) -> bool {
        if !is_same(&self.closed, &line.segment) {
            return false;
        }
        self.last_s = line.time_s;
        self.cells.add(&line.cells);
        let frame = map.frame();
        let points: Vec<_> =
            self.cells.often(0.3).map(|cell| frame.center(frame.cell(cell as usize))).collect();
        let all: Vec<usize> = (0..points.len()).collect();
        if let Some(pooled) = segment::span(&points, &all, frame.resolution_m())
            && is_same(&self.closed, &pooled)
            && let Some((closed, _)) = between_walls(&pooled, map)
        {
            self.closed = closed;
        }
        let share = line.segment.length_m() / self.closed.length_m();
        if share >= MIN_PART {
            self.lines[usize::from(line.is_blocked)] += 1;
            self.coverage = self.coverage.max(share);
        }
        true
    }

    /// Takes over what is known of the same doorway. Returns the thing that is one too many then.
    pub(super) fn join(&mut self, other: Self) -> Option<u32> {
        (0..2).for_each(|way| self.lines[way] += other.lines[way]);
        self.coverage = self.coverage.max(other.coverage);
        self.last_s = self.last_s.max(other.last_s);
        if self.thing.is_none() {
            self.thing = other.thing;
            return None;
        }
        other.thing
    }

    pub(super) fn is_door(&self) -> bool {
        self.coverage >= MIN_COVERAGE && self.lines.iter().sum::<u32>() >= MIN_LINES
    }

    /// Adds a line that may be the open leaf; `lines` may have changed at the same time. Returns whether it may be.
    pub(super) fn add_open(&mut self, line: &Line, lines: &[Line]) -> bool {
        let Some(place) = self.open_place(&line.segment) else { return false };
        let is_together =
            lines.iter().any(|other| line.is_counterpart(other) && is_same(&self.closed, &other.segment));
        let open = &mut self.open[place];
        open.cells.add(&line.cells);
        open.weight += if is_together { TOGETHER } else { ALONE };
        true
    }

    /// The closed leaf has changed: a line that may be the open leaf has changed before, the other way.
    pub(super) fn confirm_open(&mut self, line: &Line, closed: &Line) {
        if line.is_counterpart(closed)
            && let Some(place) = self.open_place(&line.segment)
        {
            self.open[place].weight += TOGETHER - ALONE;
        }
    }

    /// The number of the hinge and the side of an open leaf.
    fn open_place(&self, line: &Segment) -> Option<usize> {
        let length_m = self.closed.length_m();
        if line.length_m() > length_m + 0.15 {
            return None;
        }
        for hinge in 0..2 {
            let (at, other) = (self.closed.ends[hinge], self.closed.ends[1 - hinge]);
            let (_, off_m) = line.position(&at);
            let [near, far] = {
                let [a, b] = line.ends;
                if (a - at).norm() < (b - at).norm() { [a, b] } else { [b, a] }
            };
            let (leaf, along) = (far - near, (other - at).normalize());
            let angle = libm::acos(leaf.normalize().dot(&along).clamp(-1.0, 1.0));
            let is_at_hinge = off_m.abs() < 0.15
                && (near - at).norm() < HINGE_M.max(0.4 * length_m)
                && (far - at).norm() < length_m + 0.15;
            if is_at_hinge && angle > MIN_OPEN_RAD {
                return Some(2 * hinge + usize::from(along.perp(&leaf) > 0.0));
            }
        }
        None
    }

    /// The hinge and the open leaf from it, if it is known.
    pub(super) fn open_leaf(&self, map: &CellMap) -> Option<(usize, Segment)> {
        let best = (0..4).max_by(|&a, &b| self.open[a].weight.total_cmp(&self.open[b].weight))?;
        let open = &self.open[best];
        if open.weight < MIN_OPEN_WEIGHT {
            return None;
        }
        let frame = map.frame();
        let points: Vec<_> =
            open.cells.often(0.5).map(|cell| frame.center(frame.cell(cell as usize))).collect();
        let all: Vec<usize> = (0..points.len()).collect();
        let line = segment::span(&points, &all, frame.resolution_m())?;
        let hinge = self.closed.ends[best / 2];
        let middle = Point2::from((line.ends[0].coords + line.ends[1].coords) / 2.0);
        let along = line.along();
        let along = if along.dot(&(middle - hinge)) < 0.0 { -along } else { along };
        let foot = line.ends[0] + along * along.dot(&(hinge - line.ends[0]));
        Some((best / 2, Segment { ends: [foot, foot + along * self.closed.length_m()] }))
    }

    pub(super) fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.cells.each_cell(f);
        self.open.iter_mut().for_each(|open| open.cells.each_cell(f));
    }
}

/// Whether two lines are parts of the same one.
fn is_same(whole: &Segment, part: &Segment) -> bool {
    let length_m = whole.length_m();
    let turn = whole.along().perp(&part.along()).abs();
    let on = part.ends.map(|end| whole.position(&end));
    let [low, high] = [on[0].0.min(on[1].0), on[0].0.max(on[1].0)];
    turn < SAME_RAD && 0.5 * (on[0].1 + on[1].1).abs() < SAME_M && low > -0.15 && high < length_m + 0.15
}

/// Extends a line to the walls at both its ends; with the share of it that the line is.
fn between_walls(line: &Segment, map: &CellMap) -> Option<(Segment, f64)> {
    let cell_m = map.frame().resolution_m();
    let along = line.along();
    let mut ends = line.ends;
    for (end, along) in ends.iter_mut().zip([-along, along]) {
        *end = wall(*end, along, map, cell_m)?;
    }
    let closed = Segment { ends };
    let length_m = closed.length_m();
    (LENGTHS_M[0]..LENGTHS_M[1]).contains(&length_m).then(|| (closed, line.length_m() / length_m))
}

/// Where a ray meets a wall: cells that are blocked and never changed.
fn wall(from: Point2<f64>, along: Vector2<f64>, map: &CellMap, cell_m: f64) -> Option<Point2<f64>> {
    let side = Vector2::new(-along.y, along.x) * cell_m;
    let mut at_m = -1.5 * cell_m;
    while at_m < MAX_HIDDEN_M {
        let at = from + along * at_m;
        let is_wall = [0.0, 1.0, -1.0].into_iter().any(|off| {
            let index = map.frame().index(map.frame().cell_at(&(at + side * off)));
            index.is_some_and(|index| map.state(index) == CellState::Blocked && map.slot(index).is_none())
        });
        if is_wall {
            return Some(at);
        }
        at_m += 0.25 * cell_m;
    }
    None
}
