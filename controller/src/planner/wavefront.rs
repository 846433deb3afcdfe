#[cfg(test)]
mod tests;

use super::costmap::{Costmap, DIAGONAL, LETHAL, MAX_COST, Moves, STRAIGHT};
use interfaces::{Cell, GridFrame};

/// The path cost of a cell that no wave has reached.
const UNREACHED: u32 = u32::MAX;
/// A power of two above the largest cost of a move: the number of buckets that are in use at the same time.
const BUCKETS: usize = (DIAGONAL as usize * MAX_COST as usize + 1).next_power_of_two();

/// The directions of a move: four straight ones, then four diagonals.
const EAST: usize = 0;
const NORTH: usize = 1;
const WEST: usize = 2;
const SOUTH: usize = 3;
/// The two straight directions of each diagonal.
const PARTS: [[usize; 2]; 4] = [[EAST, NORTH], [WEST, NORTH], [WEST, SOUTH], [EAST, SOUTH]];

/// A slot to expand, and the direction of the move that reached it.
#[derive(Clone, Copy, Debug)]
struct Entry {
    slot: u32,
    direction: u32,
}

/// The cost of the cheapest path from every cell to a goal, in the order of cost from the goal (paper,
/// section 2: a wave front planner). Dijkstra's algorithm with a bucket per cost (Dial 1969): costs are exact
/// integers, so no comparison of floats can differ between machines.
///
/// Where a cell and the eight around it cost the same, the moves of a path can be reordered without a change
/// of its cost, so only one order is followed: diagonal moves before straight ones (without diagonals: moves
/// along a row before those along a column), as in jump point search (Harabor & Grastien 2011). A cell in
/// free space is then offered a cost once, not eight times.
///
/// Buffers are reused. The time of [`clear`](Self::clear) is proportional to the number of cells that the last
/// waves covered.
#[derive(Clone, Debug)]
pub struct Wavefront {
    pub(super) moves: Moves,
    frame: GridFrame,
    /// The difference between slot indices for each direction.
    steps: [isize; 8],
    /// The path cost of every slot of the [`Costmap`].
    costs: Vec<u32>,
    /// Slots to expand, by path cost modulo the number of buckets. If a lower cost was found for a slot later, the
    /// slot is skipped in its old bucket.
    buckets: [Vec<Entry>; BUCKETS],
    /// The number of slots in all buckets.
    waiting: usize,
    /// The first and the last slot expanded since the field was cleared.
    expanded: Option<(usize, usize)>,
}

impl Wavefront {
    /// A field over the cells of `frame` that no wave has reached.
    pub fn new(frame: GridFrame, moves: Moves) -> Self {
        let stride = frame.width() as isize + 2;
        Self {
            moves,
            frame,
            steps: [1, stride, -1, -stride, stride + 1, stride - 1, -stride - 1, -stride + 1],
            costs: vec![UNREACHED; (frame.width() + 2) * (frame.height() + 2)],
            buckets: std::array::from_fn(|_| Vec::new()),
            waiting: 0,
            expanded: None,
        }
    }

    /// Removes all waves.
    pub fn clear(&mut self) {
        if let Some((first, last)) = self.expanded.take() {
            // The slots around an expanded slot were reached, too.
            let margin = self.frame.width() + 3;
            self.costs[first - margin..=last + margin].fill(UNREACHED);
        }
    }

    /// Spreads a wave from `source` until the cost of `target` is final (returns whether it is), or, without
    /// a target, over all cells that can be reached. The path cost is the cost of a path *toward* the
    /// source: the sum of the length of each move times the cost of the cell that it enters.
    ///
    /// Waves since the last [`clear`](Self::clear) stay: start a wave only where no other wave was. Nothing
    /// spreads from a lethal source, or over a map of another frame.
    pub fn spread(&mut self, map: &Costmap, source: Cell, target: Option<Cell>) -> bool {
        if *map.frame() != self.frame || !map.is_traversable(source) {
            return false;
        }
        // Without a target, a number that no slot has.
        let target =
            target.filter(|cell| map.is_traversable(*cell)).map_or(usize::MAX, |cell| map.slot(cell));
        let source = map.slot(source);
        self.costs[source] = 0;
        let (mut first, mut last) = self.expanded.unwrap_or((source, source));
        let (mut found, mut cost) = (source == target, 0);
        self.expand_all(map.slots(), source, 0);
        (first, last) = (first.min(source), last.max(source));
        while self.waiting > 0 {
            let index = cost as usize % BUCKETS;
            // Every move costs something, so nothing is added to the bucket that is taken out here.
            let mut bucket = std::mem::take(&mut self.buckets[index]);
            self.waiting -= bucket.len();
            for &Entry { slot, direction } in &bucket {
                let slot = slot as usize;
                if found || self.costs[slot] != cost {
                    continue;
                }
                (first, last) = (first.min(slot), last.max(slot));
                found = slot == target;
                if map.is_uniform(slot) {
                    self.expand(slot, direction as usize, cost, u32::from(map.slots()[slot]));
                } else {
                    self.expand_all(map.slots(), slot, cost);
                }
            }
            bucket.clear();
            self.buckets[index] = bucket;
            cost += 1;
        }
        self.expanded = Some((first, last));
        found
    }

    /// Expands a slot among equal cell costs that was reached along `direction`.
    fn expand(&mut self, slot: usize, direction: usize, cost: u32, cell_cost: u32) {
        let straight = cost + cell_cost * STRAIGHT;
        if let Some(parts) = direction.checked_sub(4).map(|diagonal| PARTS[diagonal]) {
            self.offer(slot, direction, cost + cell_cost * DIAGONAL);
            parts.into_iter().for_each(|part| self.offer(slot, part, straight));
        } else {
            self.offer(slot, direction, straight);
            if self.moves == Moves::Four && (direction == EAST || direction == WEST) {
                self.offer(slot, NORTH, straight);
                self.offer(slot, SOUTH, straight);
            }
        }
    }

    /// Expands a slot in all directions that the map allows.
    fn expand_all(&mut self, cell_costs: &[u8], slot: usize, cost: u32) {
        let cell_cost = u32::from(cell_costs[slot]);
        let passes = |direction: usize| cell_costs[slot.wrapping_add_signed(self.steps[direction])] != LETHAL;
        let sides = [passes(EAST), passes(NORTH), passes(WEST), passes(SOUTH)];
        let corners = std::array::from_fn::<_, 4, _>(|diagonal| {
            let [across, up] = PARTS[diagonal];
            self.moves == Moves::Eight && sides[across] && sides[up] && passes(4 + diagonal)
        });
        for direction in 0..4 {
            if sides[direction] {
                self.offer(slot, direction, cost + cell_cost * STRAIGHT);
            }
            if corners[direction] {
                self.offer(slot, 4 + direction, cost + cell_cost * DIAGONAL);
            }
        }
    }

    /// Offers a path cost to the slot in `direction`, if the slot is traversable.
    fn offer(&mut self, from: usize, direction: usize, cost: u32) {
        let slot = from.wrapping_add_signed(self.steps[direction]);
        if cost < self.costs[slot] {
            self.costs[slot] = cost;
            let entry = Entry { slot: slot as u32, direction: direction as u32 };
            self.buckets[cost as usize % BUCKETS].push(entry);
            self.waiting += 1;
        }
    }

    /// The cost of the path from `cell` to the source of the wave that reached it; `None` where no wave
    /// was. After a wave with a target, costs above that of the target are upper bounds.
    pub fn path_cost(&self, cell: Cell) -> Option<u32> {
        if !self.frame.contains(cell) {
            return None;
        }
        let cost = self.costs[(cell.y + 1) as usize * (self.frame.width() + 2) + (cell.x + 1) as usize];
        (cost != UNREACHED).then_some(cost)
    }

    /// The [path costs](Self::path_cost) of all cells, in row-major order.
    pub fn path_costs(&self) -> impl Iterator<Item = Option<u32>> {
        let width = self.frame.width();
        let rows = self.costs.chunks_exact(width + 2).skip(1).take(self.frame.height());
        rows.flat_map(move |row| &row[1..=width]).map(|&cost| (cost != UNREACHED).then_some(cost))
    }

    /// The cells of a cheapest path from `from` to the source, both included: the descent
    /// of the field (paper: hill climbing). None where no wave was.
    pub fn descend(&self, map: &Costmap, from: Cell) -> Vec<Cell> {
        let Some(mut cost) = self.path_cost(from) else { return Vec::new() };
        let (mut at, mut path) = (from, vec![from]);
        while cost > 0 {
            let step = at.neighbours8().into_iter().find_map(|next| {
                let allowed = self.moves == Moves::Eight || next.x == at.x || next.y == at.y;
                let here = self.path_cost(next)?.checked_add(map.line_cost(at, next)?)?;
                (allowed && here == cost).then_some(next)
            });
            let Some(next) = step else { return Vec::new() };
            at = next;
            cost = self.path_cost(at).unwrap_or(0);
            path.push(at);
        }
        path
    }
}
