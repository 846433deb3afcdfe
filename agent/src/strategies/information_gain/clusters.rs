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
        let is_changed = {
            let mut is_changed = vec![false; frame.len()];
            mapper.changed().for_each(|cell| is_changed[cell] = true);
            is_changed
        };
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

    /// The number of changed cells beside a changed cell.
    #[inline]
    pub(super) fn degree(&self, cell: usize) -> u8 {
        self.degrees[cell]
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
