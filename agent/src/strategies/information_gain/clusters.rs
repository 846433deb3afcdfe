//! Clusters of cells that changed. A cluster is mostly the path of one moving thing. Cells beside a cluster are
//! more likely to change, too.

use interfaces::GridFrame;
use mapper::Mapper;

/// The pseudocounts of the rate of a cluster: half a cycle in fifty units of time.
const PRIOR_CYCLES: f64 = 0.5;
const PRIOR_TIME: f64 = 50.0;

/// No cluster.
const NONE: u32 = u32::MAX;

/// The position of a cell relative to the cells that changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Position {
    /// No cell beside this cell ever changed.
    Far,
    /// A cell beside this cell changed, and that cell lies between other changed cells: the path goes on elsewhere.
    Middle,
    /// A cell beside this cell changed, and that cell has at most one changed neighbor: the known end of a path.
    End,
}

/// The cells that ever changed, in clusters of cells that share sides.
#[derive(Clone, Debug, Default)]
pub(super) struct Clusters {
    /// The cluster of each cell.
    of: Vec<u32>,
    /// The number of changed cells beside each changed cell.
    degrees: Vec<u8>,
    /// The mean number of cycles per unit of time in view, for each cluster.
    rates: Vec<f64>,
}

impl Clusters {
    /// The clusters of a map. One pass over the changed cells; the vectors are as large as the map.
    pub(super) fn new(mapper: &Mapper) -> Self {
        let frame = mapper.frame();
        let mut clusters =
            Self { of: vec![NONE; frame.len()], degrees: vec![0; frame.len()], rates: Vec::new() };
        let mut is_changed = vec![false; frame.len()];
        mapper.changed().for_each(|cell| is_changed[cell] = true);
        let mut open = Vec::new();
        for start in mapper.changed() {
            if clusters.of[start] != NONE {
                continue;
            }
            let cluster = clusters.rates.len() as u32;
            clusters.of[start] = cluster;
            open.push(start);
            let (mut cycles, mut time) = (PRIOR_CYCLES, PRIOR_TIME);
            while let Some(cell) = open.pop() {
                let seen = mapper.statistics(cell);
                cycles += 0.5 * f64::from(seen.block_events + seen.free_events);
                time += seen.watched_free + seen.watched_blocked;
                for near in frame.beside(cell).filter(|&near| is_changed[near]) {
                    clusters.degrees[cell] += 1;
                    if clusters.of[near] == NONE {
                        clusters.of[near] = cluster;
                        open.push(near);
                    }
                }
            }
            clusters.rates.push(cycles / time);
        }
        clusters
    }

    /// Whether the cell ever changed.
    #[inline]
    pub(super) fn has(&self, cell: usize) -> bool {
        self.of[cell] != NONE
    }

    /// The position of a cell relative to the cells that changed, and the lowest rate of the clusters beside it (∞
    /// far from all clusters).
    pub(super) fn position(&self, frame: &GridFrame, cell: usize) -> (Position, f64) {
        let (mut position, mut rate) = (Position::Far, f64::INFINITY);
        for near in frame.beside(cell).filter(|&near| self.has(near)) {
            let others = self.degrees[near] - u8::from(self.has(cell));
            position = position.max(if others <= 1 { Position::End } else { Position::Middle });
            rate = rate.min(self.rates[self.of[near] as usize]);
        }
        (position, rate)
    }
}

/// Occlusion by moving things, in a grid whose cells are as large as the things.
///
/// A cell that changed is hidden while a cell between it and the robot is blocked. In addition, a thing that enters
/// the cell from the side of the robot comes out of its own shadow: the robot does not see the cell free and then
/// blocked, finds both changes too late, and estimates too low a rate. If a cell with k changing neighbors is
/// entered from such a neighbor, the visible share of the events falls by 2 / k: once for the event, and once for
/// the time that is counted without the event.
#[derive(Clone, Debug)]
pub(super) struct Occlusion<'a> {
    clusters: &'a Clusters,
    mapper: &'a Mapper,
    /// The probability that a cell is blocked, for each cell that changed.
    blocked: Vec<f64>,
}

impl<'a> Occlusion<'a> {
    pub(super) fn new(mapper: &'a Mapper, clusters: &'a Clusters) -> Self {
        let mut blocked = vec![0.0; mapper.frame().len()];
        for cell in mapper.changed() {
            blocked[cell] = mapper.blocked_probability(cell);
        }
        Self { clusters, mapper, blocked }
    }

    /// The share of the events of a changed cell that is seen from another cell, from 1 down to −1. A negative
    /// share means that an observation from there makes the estimate worse.
    pub(super) fn visible_share(&self, from: usize, to: usize) -> f64 {
        let frame = self.mapper.frame();
        let (start, end) = (frame.cell(from), frame.cell(to));
        let (dx, dy) = (end.x - start.x, end.y - start.y);
        let length = dx.abs().max(dy.abs());
        if length <= 1 {
            return 1.0;
        }
        // Rounded to the nearest cell; halves are rounded away from the robot.
        let part = |d: i32, step: i32| d.signum() * ((2 * d.abs() * step + length) / (2 * length));
        let index = |x: i32, y: i32| (start.y + y) as usize * frame.width() + (start.x + x) as usize;
        let mut share = 1.0;
        for step in 1..length {
            share *= 1.0 - self.blocked[index(part(dx, step), part(dy, step))];
        }
        let towards = match dx.abs().cmp(&dy.abs()) {
            std::cmp::Ordering::Greater => index(dx - dx.signum(), dy),
            std::cmp::Ordering::Less => index(dx, dy - dy.signum()),
            std::cmp::Ordering::Equal => return share,
        };
        if self.clusters.has(towards) {
            share *= 1.0 - 2.0 / f64::from(self.clusters.degrees[to].max(1));
        }
        share
    }
}
