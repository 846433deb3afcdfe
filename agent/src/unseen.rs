//! Looks into space that was never seen, before the strategy of the agent decides.
//!
//! A strategy weighs places by what it knows of them, so that space behind furniture or at the far end of a large
//! building can stay unseen for ever. The *frontier* of unseen space is the unknown cells beside free cells (Yamauchi
//! 1997). While some of the frontier can be looked at from a cell that the robot can reach, that cell is the next goal.
//! A look that shows nothing new is repeated after a time that doubles with every such look: what hides the frontier
//! may be a door, or a body that moves away.

use crate::situation::Situation;
use crate::visibility::Regions;
use interfaces::{Cell, CellState, GridFrame, Values, value};
use mapper::Mapper;
use std::cmp::Reverse;
use std::f64::consts::TAU;

/// The maximum duration of a look, in the time unit of the readings. A map can need some readings before it takes a cell
/// beside a surface for free.
const WATCH: f64 = 2.5;
/// The time after which a look that showed nothing new is repeated for the first time, in the time unit of the readings.
const RETRY: f64 = 30.0;
/// The shortest frontier in a region that is worth a goal, m: in a fine grid, single cells at corners and edges often stay unknown from
/// everywhere.
const MIN_FRONTIER_M: f64 = 0.1;
/// The number of directions in which a line of sight is searched. With more directions the search takes longer than the
/// mapper and the controller together.
const DIRECTIONS: u32 = 240;
/// The number of directions on each side of a line of sight that should be free as well, since the robot does not stop
/// exactly at its goal.
const MARGIN: usize = 3;

/// The looks at a region of the map.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
struct Looks {
    /// The looks in a row that showed nothing new.
    failed: u32,
    /// The next look is not before this time.
    not_before: f64,
}

/// The region that the robot goes to look at.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Target {
    region: usize,
    /// A frontier cell in the region.
    cell: usize,
}

/// A look into unseen space that is possible now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnseenLook {
    target: Target,
    /// The cell from which the robot looks.
    pub(crate) from: Cell,
    /// The time to get there and to look.
    pub(crate) time: f64,
    /// The frontier cells that it shows per time.
    cells_per_time: f64,
}

/// Selects goals from which the frontier of unseen space can be seen.
#[derive(Clone, Debug)]
pub(crate) struct UnseenSpace {
    region_cells: usize,
    range_m: f64,
    frame: Option<GridFrame>,
    looks: Vec<Looks>,
    /// The lines of sight from a cell.
    lines: Vec<Vec<Cell>>,
    /// The number of frontier cells of each region.
    frontier: Vec<usize>,
    target: Option<Target>,
}

impl UnseenSpace {
    /// For regions of `region_cells` × `region_cells` cells, and a sensor with the range `range_m`.
    pub(crate) fn new(region_cells: usize, range_m: f64) -> Self {
        let (frame, target) = (None, None);
        let (looks, lines, frontier) = (Vec::new(), Vec::new(), Vec::new());
        Self { region_cells, range_m, frame, looks, lines, frontier, target }
    }

    /// The looks so far, and the present one.
    pub(crate) fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        self.regions(mapper);
        vec![value(&mut self.looks), value(&mut self.target)]
    }

    /// Ends the last look, if there is one, where no other goal follows for a while. A robot that is called away before it is as
    /// near as its sensor reaches has not looked.
    pub(crate) fn end(&mut self, situation: &Situation) {
        let (mapper, frame) = (situation.mapper, situation.mapper.frame());
        let Some(Target { cell, .. }) = self.target else { return };
        let distance_m = (frame.center(situation.cell()) - frame.center(frame.cell(cell))).norm();
        let is_seen = mapper.states().cells()[cell] != CellState::Unknown;
        if is_seen || distance_m <= self.range_m {
            self.update(mapper);
        } else {
            self.target = None;
        }
    }

    /// Ends the last look. Returns whether any frontier is due for a look now.
    pub(crate) fn update(&mut self, mapper: &Mapper) -> bool {
        let regions = self.regions(mapper);
        self.frontier.clear();
        self.frontier.resize(regions.count(), 0);
        for cell in (0..mapper.frame().len()).filter(|&cell| is_frontier(mapper, cell)) {
            self.frontier[regions.of(cell)] += 1;
        }
        if let Some(Target { region, cell }) = self.target.take() {
            let looks = &mut self.looks[region];
            if mapper.states().cells()[cell] != CellState::Unknown {
                looks.failed = 0;
            } else {
                looks.not_before = mapper.time() + RETRY * libm::exp2(f64::from(looks.failed));
                looks.failed += 1;
            }
        }
        (0..regions.count()).any(|region| self.is_due(region, mapper.time()))
    }

    /// The look at the region with most frontier cells per time to get a view of it; `None` if none of the frontier that
    /// is due can be seen from a cell that the robot can reach. The situation must have travel times.
    pub(crate) fn look(&mut self, situation: &Situation) -> Option<UnseenLook> {
        let mapper = situation.mapper;
        let regions = self.regions(mapper);
        let mut due: Vec<usize> =
            (0..regions.count()).filter(|&region| self.is_due(region, mapper.time())).collect();
        due.sort_by_key(|&region| Reverse(self.frontier[region]));
        let mut best: Option<UnseenLook> = None;
        for region in due {
            let worth = |time: f64| self.frontier[region] as f64 / (time + WATCH);
            // The regions that follow have no more frontier. To find a viewpoint takes much longer than all else here.
            if best.is_some_and(|look| worth(0.0) <= look.cells_per_time) {
                break;
            }
            let Some(target) = self.target_in(mapper, &regions, region) else { continue };
            let Some((time, from)) = self.viewpoint(situation, target.cell) else { continue };
            if best.is_none_or(|look| worth(time) > look.cells_per_time) {
                best = Some(UnseenLook { target, from, time: time + WATCH, cells_per_time: worth(time) });
            }
        }
        best
    }

    /// Begins a look. Returns its maximum duration.
    pub(crate) fn begin(&mut self, look: UnseenLook) -> f64 {
        self.target = Some(look.target);
        WATCH
    }

    /// Whether the last goal has shown what the robot went to look at.
    pub(crate) fn is_seen(&self, mapper: &Mapper) -> bool {
        let Some((target, frame)) = self.target.zip(self.frame) else { return false };
        let regions = Regions::with_side(frame, self.region_cells);
        !regions.cells(target.region).any(|cell| is_frontier(mapper, cell))
    }

    fn is_due(&self, region: usize, time: f64) -> bool {
        let cell_m = self.frame.map_or(0.0, |frame| frame.resolution_m());
        let frontier_m = self.frontier[region] as f64 * cell_m;
        frontier_m > MIN_FRONTIER_M - 1e-9 && time >= self.looks[region].not_before
    }

    fn regions(&mut self, mapper: &Mapper) -> Regions {
        let frame = *mapper.frame();
        let regions = Regions::with_side(frame, self.region_cells);
        if self.frame != Some(frame) {
            (self.frame, self.target) = (Some(frame), None);
            self.looks = vec![Looks::default(); regions.count()];
            self.lines = lines_of_sight(&frame, self.range_m, DIRECTIONS);
        }
        regions
    }

    /// A frontier cell of a region; another one after a look that showed nothing new.
    fn target_in(&self, mapper: &Mapper, regions: &Regions, region: usize) -> Option<Target> {
        let nth =
            (self.frontier[region] / 2 + self.looks[region].failed as usize) % self.frontier[region].max(1);
        let cell = regions.cells(region).filter(|&cell| is_frontier(mapper, cell)).nth(nth)?;
        Some(Target { region, cell })
    }

    /// The cell from which `target` can be seen, and the travel time to the cell: a cell with a margin for the view, and
    /// of these the nearest. Unknown cells are taken for transparent.
    fn viewpoint(&self, situation: &Situation, target: usize) -> Option<(f64, Cell)> {
        let (states, frame) = (situation.mapper.states(), situation.mapper.frame());
        let target = frame.cell(target);
        let along = |line: &Vec<Cell>| {
            let cells = line.iter().map_while(|offset| {
                let cell = Cell::new(target.x + offset.x, target.y + offset.y);
                let index = frame.index(cell)?;
                (states.cells()[index] != CellState::Blocked).then_some((index, cell))
            });
            let mut times = cells.map(|(index, cell)| (situation.travel_to(index), cell));
            times.find(|(time, _)| time.is_finite())
        };
        let seen: Vec<Option<(f64, Cell)>> = self.lines.iter().map(along).collect();
        // Whether the directions beside are free as well: in a gap, the middle of the view.
        let margin = |direction: usize| {
            let at = |offset: usize| seen[(direction + offset) % seen.len()].is_some();
            (0..MARGIN).take_while(|&off| at(off) && at(seen.len() - off)).count()
        };
        let order = |(a, from): &(usize, (f64, Cell)), (b, other): &(usize, (f64, Cell))| {
            margin(*b).cmp(&margin(*a)).then(from.0.total_cmp(&other.0))
        };
        let views = seen.iter().enumerate().filter_map(|(direction, view)| Some((direction, (*view)?)));
        views.min_by(order).map(|(_, view)| view)
    }
}

/// Whether a cell is unknown and beside a free cell.
fn is_frontier(mapper: &Mapper, cell: usize) -> bool {
    mapper.is_candidate(cell) && mapper.states().cells()[cell] == CellState::Unknown
}

/// The cells on straight lines in a number of directions from a cell, relative to it, from the cell on. The lines have
/// the length `range_m`; they end where every map of this size ends.
fn lines_of_sight(frame: &GridFrame, range_m: f64, directions: u32) -> Vec<Vec<Cell>> {
    let max_steps = 2 * (frame.width() + frame.height()) as u32;
    let steps = ((2.0 * range_m / frame.resolution_m()) as u32).min(max_steps);
    let line = |direction: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(direction) / f64::from(directions));
        let offset = |slope: f64, step: u32| (slope * f64::from(step) / 2.0).round() as i32;
        let mut line: Vec<Cell> =
            (0..steps).map(|step| Cell::new(offset(cos, step), offset(sin, step))).collect();
        // Steps of half a cell often stay in a cell.
        line.dedup();
        line
    };
    (0..directions).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn lines_are_the_cells_of_half_steps_without_repetitions() {
        let frame = |cells| GridFrame::new(Point2::origin(), 0.05, cells, cells).unwrap();
        let lines = lines_of_sight(&frame(400), 2.0, 240);
        assert_eq!(lines.len(), 240);
        for (direction, line) in lines.iter().enumerate() {
            let (sin, cos) = libm::sincos(TAU * direction as f64 / 240.0);
            let at = |step: i32, slope: f64| (slope * f64::from(step) / 2.0).round() as i32;
            let mut cells: Vec<Cell> = (0..80).map(|step| Cell::new(at(step, cos), at(step, sin))).collect();
            cells.dedup();
            assert_eq!(*line, cells);
        }
        // A long range takes no more memory than the map.
        let longest = lines_of_sight(&frame(10), 1e6, 4).iter().map(Vec::len).max();
        assert_eq!(longest, Some(21));
    }
}
