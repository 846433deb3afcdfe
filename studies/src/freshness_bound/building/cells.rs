use super::access::Access;
use crate::STEP_S;
use crate::calendar::Hours;
use std::collections::BTreeMap;

/// Time as the bound sees it: cells of steps, and blocks of 2ⁿ cells. In a cell and in a block a look costs the smallest
/// price in it, and shows the thing from then until its end.
pub(super) struct Cells {
    /// The first step of each cell, and the end of the last one.
    pub(super) begins: Vec<usize>,
    /// Whether the place is active during each cell.
    pub(super) is_active: Vec<bool>,
    /// The different stretches of time that occur in blocks.
    pub(super) runs: Vec<Run>,
    /// By level, then by index: block `b` of level `n` begins with cell `b` 2ⁿ.
    pub(super) blocks: Vec<Vec<Block>>,
    /// The run of each cell without its first step.
    pub(super) rests: Vec<usize>,
}

/// Steps in a row during which the place is active, or quiet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Run {
    pub(super) is_active: bool,
    pub(super) steps: usize,
}

pub(super) struct Block {
    /// Its runs in the order of time, as indices.
    pub(super) runs: Vec<usize>,
    /// Whether it has quiet and active cells.
    pub(super) has: [bool; 2],
}

/// A window in which a thing is looked at next, or cannot be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) cell: usize,
    pub(super) level: usize,
    pub(super) has_look: bool,
}

impl Window {
    pub(super) fn block(self) -> usize {
        self.cell >> self.level
    }
}

impl Cells {
    /// Cells of `sizes` steps in quiet and in active hours, which never contain the end of such hours.
    pub(super) fn new(hours: &Hours, steps: usize, sizes: [usize; 2]) -> Self {
        let (mut begins, mut is_active) = (vec![0], Vec::new());
        let mut begin = 0;
        while begin < steps {
            let active = hours.is_active(begin as f64 * STEP_S);
            let switch_s = hours.next_switch_s(begin as f64 * STEP_S);
            let switch = if switch_s.is_finite() { (switch_s / STEP_S).round() as usize } else { steps };
            begin = (begin + sizes[usize::from(active)]).min(switch.max(begin + 1)).min(steps);
            begins.push(begin);
            is_active.push(active);
        }
        let mut cells = Self { begins, is_active, runs: Vec::new(), blocks: Vec::new(), rests: Vec::new() };
        cells.add_blocks();
        cells
    }

    fn add_blocks(&mut self) {
        let mut known: BTreeMap<Run, usize> = BTreeMap::new();
        let mut runs = Vec::new();
        let mut index = |run: Run| {
            *known.entry(run).or_insert_with(|| {
                runs.push(run);
                runs.len() - 1
            })
        };
        let count = self.count();
        for level in (0..usize::BITS as usize).take_while(|level| count >> level > 0) {
            let blocks = (0..count >> level).map(|block| {
                let cells = block << level..(block + 1) << level;
                let has =
                    [false, true].map(|active| cells.clone().any(|cell| self.is_active[cell] == active));
                Block { runs: self.runs_of(cells).into_iter().map(&mut index).collect(), has }
            });
            self.blocks.push(blocks.collect());
        }
        let rests = (0..count).map(|cell| Run { is_active: self.is_active[cell], steps: self.len(cell) - 1 });
        self.rests = rests.map(&mut index).collect();
        self.runs = runs;
    }

    fn runs_of(&self, cells: std::ops::Range<usize>) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for cell in cells {
            let run = Run { is_active: self.is_active[cell], steps: self.len(cell) };
            match runs.last_mut().filter(|last| last.is_active == run.is_active) {
                Some(last) => last.steps += run.steps,
                None => runs.push(run),
            }
        }
        runs
    }

    pub(super) fn count(&self) -> usize {
        self.is_active.len()
    }

    fn len(&self, cell: usize) -> usize {
        self.begins[cell + 1] - self.begins[cell]
    }

    /// The cell of each step.
    pub(super) fn cell_of_step(&self) -> Vec<usize> {
        (0..self.count()).flat_map(|cell| std::iter::repeat_n(cell, self.len(cell))).collect()
    }

    /// Windows that cover all cells from `cell` on: single cells at first, then blocks that begin at least `fineness` times
    /// their length later. Windows with a look begin and end with cells in which the thing can be seen; only the first
    /// one need not, if it is the cell after a look.
    pub(super) fn windows(
        &self,
        cell: usize,
        fineness: usize,
        access: &Access,
        is_after_look: bool,
    ) -> impl Iterator<Item = Window> {
        let (count, levels) = (self.count(), self.blocks.len());
        let mut next = cell;
        std::iter::from_fn(move || {
            if next >= count {
                return None;
            }
            let has_look = access.is_open(next) || (is_after_look && next == cell);
            let end = access.next_open(next);
            let fits = |level: &usize| {
                let length = 1 << level;
                let is_old = !has_look || length * fineness <= next - cell;
                next.is_multiple_of(length) && is_old && next + length <= if has_look { count } else { end }
            };
            let largest = (1..levels).take_while(fits).last().unwrap_or(0);
            let closes = |level: &usize| !has_look || *level == 0 || access.is_open(next + (1 << level) - 1);
            let level = (0..=largest).rev().find(closes).unwrap_or(0);
            let window = Window { cell: next, level, has_look };
            next += 1 << level;
            Some(window)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_end_where_hours_do_and_windows_cover_all() {
        let hours = Hours::daily(&[0, 1], 8.0, 18.5);
        let cells = Cells::new(&hours, 2 * 8640 + 7, [100, 7]);
        assert_eq!(cells.cell_of_step().len(), 2 * 8640 + 7);
        for (cell, begin) in cells.begins.iter().take(cells.count()).enumerate() {
            let last = cells.begins[cell + 1] - 1;
            for step in [*begin, last] {
                assert_eq!(cells.is_active[cell], hours.is_active(step as f64 * STEP_S), "{step}");
            }
        }
        // Seen in all cells, and not in some hundreds of them.
        let count = cells.count();
        let some = (0..count).map(|cell| cell % 500 < 230).collect();
        for (access, first) in [Access::of(vec![true; count]), Access::of(some)]
            .iter()
            .flat_map(|access| [0, 5, 700, count - 1].map(|first| (access, first)))
        {
            let mut next = first;
            for window in cells.windows(first, 8, access, true) {
                assert_eq!((window.cell, window.block() << window.level), (next, next));
                let block = &cells.blocks[window.level][window.block()];
                let steps: usize = block.runs.iter().map(|run| cells.runs[*run].steps).sum();
                next += 1 << window.level;
                assert_eq!(steps, cells.begins[next] - cells.begins[window.cell]);
                if window.has_look {
                    assert!(window.level == 0 || 8 << window.level <= window.cell - first);
                    let ends = [window.cell, next - 1];
                    assert!(window.cell == first || ends.iter().all(|cell| access.is_open(*cell)));
                } else {
                    assert!((window.cell..next).all(|cell| !access.is_open(cell)));
                }
            }
            assert_eq!(next, count);
        }
    }
}
