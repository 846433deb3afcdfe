use super::lasting::Change;
use super::segment::{self, Segment};
use interfaces::GridFrame;

/// Two lines change together within this time, s.
const TOGETHER_S: f64 = 5.0;

/// A straight line of cells that changed together.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct Line {
    pub(super) segment: Segment,
    pub(super) cells: Vec<u32>,
    /// Whether the cells became blocked; otherwise they became free.
    pub(super) is_blocked: bool,
    pub(super) time_s: f64,
}

impl Line {
    /// The line in changes of the same kind, if there is one.
    pub(super) fn of(changes: &[Change], time_s: f64, frame: &GridFrame) -> Option<Self> {
        let center = |change: &Change| frame.center(frame.cell(change.cell as usize));
        let points: Vec<_> = changes.iter().map(center).collect();
        let (segment, on) = segment::fit(&points, frame.resolution_m())?;
        let cells = on.into_iter().map(|index| changes[index].cell).collect();
        Some(Self { segment, cells, is_blocked: changes[0].is_blocked, time_s })
    }

    /// Whether another line changed at the same time the other way.
    pub(super) fn is_counterpart(&self, other: &Self) -> bool {
        self.is_blocked != other.is_blocked && (self.time_s - other.time_s).abs() < TOGETHER_S
    }

    pub(super) fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.cells.iter_mut().for_each(f);
    }
}
