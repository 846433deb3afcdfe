use super::access::Access;
use super::cells::{Cells, Window};
use super::chain::{BELIEFS, Chain, POINTS, long_share, seen};
use crate::calendar::Phases;

/// The price of a look in quiet and in active hours.
pub(super) type Prices = [f64; 2];

/// The value of a thing that is planned alone, where looks have prices.
pub(super) struct Planner<'a> {
    pub(super) cells: &'a Cells,
    pub(super) chain: &'a Chain,
    pub(super) access: &'a Access,
    /// The smallest age of a window, in lengths of the window.
    pub(super) fineness: usize,
    /// After this number of steps without a look the next one is free: a lower bound of all later ones.
    pub(super) longest: usize,
    /// The share of the price that a look costs in the cell after one with a look.
    pub(super) again: f64,
}

/// The values of beliefs at the beginning of blocks whose first step shows the state.
struct Values {
    lists: usize,
    /// By level; the values of a block follow each other, those of a belief for all lists of prices too.
    levels: Vec<Vec<f64>>,
    /// The price in windows that are quiet, active, and both, for each list.
    prices: [Vec<f64>; 3],
}

impl Values {
    fn block(&self, window: Window) -> &[f64] {
        let size = BELIEFS * self.lists;
        &self.levels[window.level][window.block() * size..][..size]
    }
}

impl Planner<'_> {
    /// The smallest expected sum of variances and prices, from the beginning on without earlier looks, for each list of prices.
    ///
    /// It is never above what any plan of looks at single steps has: such a plan pays at least the price of each cell
    /// (window) in which it looks, has no less variance before the first look in it, and knows no more at the end of
    /// it.
    pub(super) fn values(&self, lists: &[Prices]) -> Vec<f64> {
        let size = BELIEFS * lists.len();
        let of = |price: fn(&Prices) -> f64| lists.iter().map(price).collect::<Vec<f64>>();
        let mut values = Values {
            lists: lists.len(),
            levels: self.cells.blocks.iter().map(|blocks| vec![0.0; blocks.len() * size]).collect(),
            prices: [of(|prices| prices[0]), of(|prices| prices[1]), of(|prices| prices[0].min(prices[1]))],
        };
        let mut after = vec![0.0; size];
        for cell in (0..self.cells.count()).rev() {
            self.add_blocks(cell, &after, &mut values);
            if cell > 0 {
                let before = usize::from(self.cells.is_active[cell - 1]);
                for (state, after) in after.chunks_exact_mut(size / 2).enumerate() {
                    let laws = [0, 1].map(|long| self.chain.steps[before][2 * state + long]);
                    self.choose(cell, laws, true, &values, after);
                }
            }
        }
        let mut start = vec![0.0; lists.len()];
        self.choose(0, [self.chain.start; 2], false, &values, &mut start);
        start
    }

    /// The values of all blocks that begin with a cell, from those after the cell.
    fn add_blocks(&self, cell: usize, after: &[f64], values: &mut Values) {
        let size = after.len();
        self.chain.runs[self.cells.rests[cell]].watch(after, &mut values.levels[0][cell * size..][..size]);
        for level in 1..self.cells.blocks.len() {
            let block = cell >> level;
            if !cell.is_multiple_of(1 << level) || block >= self.cells.blocks[level].len() {
                break;
            }
            // The first half of the block is watched, then the second one.
            let mut watched = values.levels[level - 1][(2 * block + 1) * size..][..size].to_vec();
            let mut earlier = vec![0.0; size];
            for run in self.cells.blocks[level - 1][2 * block].runs.iter().rev() {
                self.chain.runs[*run].watch(&watched, &mut earlier);
                std::mem::swap(&mut watched, &mut earlier);
            }
            values.levels[level][block * size..][..size].copy_from_slice(&watched);
        }
    }

    /// The values at the beginning of a cell with the best next window, for mixtures of two laws: one value per share of the
    /// second law in `best` and list.
    fn choose(
        &self,
        cell: usize,
        mut laws: [Phases; 2],
        is_after_look: bool,
        values: &Values,
        best: &mut [f64],
    ) {
        best.fill(f64::INFINITY);
        let mut sums = super::chain::Sums::default();
        for window in self.cells.windows(cell, self.fineness, self.access, is_after_look) {
            let block = &self.cells.blocks[window.level][window.block()];
            let class = if block.has[0] && block.has[1] { 2 } else { usize::from(block.has[1]) };
            let is_free = self.cells.begins[window.cell] - self.cells.begins[cell] >= self.longest;
            let due = match () {
                () if is_free => 0.0,
                () if is_after_look && window.cell == cell => self.again,
                () => 1.0,
            };
            let (prices, later) = (&values.prices[class], values.block(window));
            let mixtures = if window.has_look { &mut *best } else { &mut [] };
            for (point, best) in mixtures.chunks_exact_mut(values.lists).enumerate() {
                let long = long_share(point);
                let law = std::array::from_fn(|phase| (1.0 - long) * laws[0][phase] + long * laws[1][phase]);
                Look::new(&law, sums.variance(long), due).improve(best, prices, later);
            }
            if is_free && window.has_look {
                return;
            }
            for run in &block.runs {
                self.chain.runs[*run].pass(&mut laws, &mut sums);
            }
        }
        for (point, best) in best.chunks_exact_mut(values.lists).enumerate() {
            let never = sums.variance(long_share(point));
            best.iter_mut().for_each(|best| *best = best.min(never));
        }
    }
}

/// The next look, for one belief.
struct Look {
    variance: f64,
    /// The share of the price that is due.
    due: f64,
    /// The weights of two points of the grid for each state, and the index of the first of them.
    weights: [[f64; 2]; 2],
    firsts: [usize; 2],
}

impl Look {
    fn new(law: &Phases, variance: f64, due: f64) -> Self {
        let seen = [false, true].map(|is_blocked| seen(law, is_blocked));
        Self {
            variance,
            due,
            weights: seen.map(|(probability, _, share)| [probability * (1.0 - share), probability * share]),
            firsts: [seen[0].1, POINTS + seen[1].1],
        }
    }

    fn improve(&self, best: &mut [f64], prices: &[f64], later: &[f64]) {
        let lists = best.len();
        let [[a, b], [c, d]] = self.weights;
        let [free, blocked] = self.firsts.map(|first| &later[first * lists..][..2 * lists]);
        let (free_low, free_high) = free.split_at(lists);
        let (blocked_low, blocked_high) = blocked.split_at(lists);
        let free = free_low.iter().zip(free_high).map(|(low, high)| a * low + b * high);
        let blocked = blocked_low.iter().zip(blocked_high).map(|(low, high)| c * low + d * high);
        let later = free.zip(blocked).map(|(free, blocked)| self.variance + free + blocked);
        for ((best, price), later) in best.iter_mut().zip(prices).zip(later) {
            *best = best.min(later + self.due * price);
        }
    }
}
