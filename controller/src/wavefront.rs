use crate::costmap::{CLOSED, Costmap, DIAGONAL, MAX_PRICE, Moves, STRAIGHT};
use interfaces::{Cell, GridFrame};

/// The cost of a cell that no wave has reached.
const UNREACHED: u32 = u32::MAX;
/// A power of two beyond the cost of the dearest move: more buckets are never in use at once.
const BUCKETS: usize = (DIAGONAL as usize * MAX_PRICE as usize + 1).next_power_of_two();

/// The directions of a move: straight ones, then diagonals, each between its two straight parts.
const EAST: usize = 0;
const NORTH: usize = 1;
const WEST: usize = 2;
const SOUTH: usize = 3;
/// For each diagonal its two straight parts.
const PARTS: [[usize; 2]; 4] = [[EAST, NORTH], [WEST, NORTH], [WEST, SOUTH], [EAST, SOUTH]];

/// A slot to expand, and the direction of the move that led there.
#[derive(Clone, Copy, Debug)]
struct Front {
    slot: u32,
    heading: u32,
}

/// The cost of the way from every cell to a goal, spread from the goal in the order of cost (paper,
/// section 2: a wave front planner). Dijkstra's algorithm with a bucket per cost (Dial 1969): exact
/// integers, and no comparison of floats that could differ between machines.
///
/// Where all nine prices around a cell are equal, a way can be reordered without a change of its
/// cost, so only one order is followed: diagonal moves before straight ones (without diagonals:
/// moves along a row before those along a column), as jump point search does (Harabor & Grastien
/// 2011). In the open each cell is then offered a cost once, not eight times.
///
/// Buffers are reused: a wave allocates nothing once the first has run, and clearing costs what the
/// last waves covered, not what the map holds.
#[derive(Clone, Debug)]
pub struct Wavefront {
    moves: Moves,
    frame: GridFrame,
    /// What each heading adds to a slot.
    steps: [isize; 8],
    /// Cost per slot of the [`Costmap`].
    costs: Vec<u32>,
    /// Slots to expand, by cost modulo the number of buckets. A slot whose cost has since sunk
    /// stays in its old bucket and is skipped there.
    buckets: [Vec<Front>; BUCKETS],
    /// The number of slots in all buckets.
    waiting: usize,
    /// The first and the last slot that a wave expanded since the field was cleared.
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

    /// Forgets all waves.
    pub fn clear(&mut self) {
        if let Some((first, last)) = self.expanded.take() {
            // The slots around an expanded one were reached, too.
            let margin = self.frame.width() + 3;
            self.costs[first - margin..=last + margin].fill(UNREACHED);
        }
    }

    /// Spreads a wave from `source` until it has settled `target` (whether it has is returned), or,
    /// without a target, over all that can be reached. The cost of a way is what the robot pays on
    /// it *towards* the source: the length of each move times the price of the cell it enters.
    ///
    /// Waves since the last [`clear`](Self::clear) stay: start one only where no other has been.
    /// A frame other than the map's, or a closed source, is a wave that goes nowhere.
    pub fn spread(&mut self, map: &Costmap, source: Cell, target: Option<Cell>) -> bool {
        if *map.frame() != self.frame || !map.is_open(source) {
            return false;
        }
        // Without a target no slot is it.
        let target = target.filter(|cell| map.is_open(*cell)).map_or(usize::MAX, |cell| map.slot(cell));
        let source = map.slot(source);
        self.costs[source] = 0;
        let (mut first, mut last) = self.expanded.unwrap_or((source, source));
        let (mut found, mut cost) = (source == target, 0);
        self.expand_all(map.slots(), source, 0);
        (first, last) = (first.min(source), last.max(source));
        while self.waiting > 0 {
            let place = cost as usize % BUCKETS;
            // No move costs nothing, so nothing is added to the bucket that is taken out here.
            let mut bucket = std::mem::take(&mut self.buckets[place]);
            self.waiting -= bucket.len();
            for &Front { slot, heading } in &bucket {
                let slot = slot as usize;
                if found || self.costs[slot] != cost {
                    continue;
                }
                (first, last) = (first.min(slot), last.max(slot));
                found = slot == target;
                if map.is_even(slot) {
                    self.expand(slot, heading as usize, cost, u32::from(map.slots()[slot]));
                } else {
                    self.expand_all(map.slots(), slot, cost);
                }
            }
            bucket.clear();
            self.buckets[place] = bucket;
            cost += 1;
        }
        self.expanded = Some((first, last));
        found
    }

    /// Goes on from a slot amid equal prices that was reached along `heading`.
    fn expand(&mut self, slot: usize, heading: usize, cost: u32, price: u32) {
        let straight = cost + price * STRAIGHT;
        if let Some(parts) = heading.checked_sub(4).map(|diagonal| PARTS[diagonal]) {
            self.offer(slot, heading, cost + price * DIAGONAL);
            parts.into_iter().for_each(|part| self.offer(slot, part, straight));
        } else {
            self.offer(slot, heading, straight);
            if self.moves == Moves::Four && (heading == EAST || heading == WEST) {
                self.offer(slot, NORTH, straight);
                self.offer(slot, SOUTH, straight);
            }
        }
    }

    /// Goes on from a slot in all directions that the map allows.
    fn expand_all(&mut self, prices: &[u8], slot: usize, cost: u32) {
        let price = u32::from(prices[slot]);
        let open = |heading: usize| prices[slot.wrapping_add_signed(self.steps[heading])] != CLOSED;
        let sides = [open(EAST), open(NORTH), open(WEST), open(SOUTH)];
        let corners = std::array::from_fn::<_, 4, _>(|diagonal| {
            let [across, up] = PARTS[diagonal];
            self.moves == Moves::Eight && sides[across] && sides[up] && open(4 + diagonal)
        });
        for heading in 0..4 {
            if sides[heading] {
                self.offer(slot, heading, cost + price * STRAIGHT);
            }
            if corners[heading] {
                self.offer(slot, 4 + heading, cost + price * DIAGONAL);
            }
        }
    }

    /// Offers the open slot that lies along `heading` a cost.
    fn offer(&mut self, from: usize, heading: usize, cost: u32) {
        let slot = from.wrapping_add_signed(self.steps[heading]);
        if cost < self.costs[slot] {
            self.costs[slot] = cost;
            self.buckets[cost as usize % BUCKETS].push(Front { slot: slot as u32, heading: heading as u32 });
            self.waiting += 1;
        }
    }

    /// The cost from `cell` to the source of the wave that reached it; `None` where none has. After
    /// a wave with a target, costs above the target's are upper bounds.
    pub fn cost(&self, cell: Cell) -> Option<u32> {
        if !self.frame.contains(cell) {
            return None;
        }
        let cost = self.costs[(cell.y + 1) as usize * (self.frame.width() + 2) + (cell.x + 1) as usize];
        (cost != UNREACHED).then_some(cost)
    }

    /// Writes the cells of a cheapest way from `from` to the source into `way`, both included: the
    /// descent of the field (paper: hill climbing). Nothing where no wave has been.
    pub fn descend(&self, map: &Costmap, from: Cell, way: &mut Vec<Cell>) {
        way.clear();
        let Some(mut cost) = self.cost(from) else { return };
        let mut at = from;
        way.push(at);
        while cost > 0 {
            let step = at.neighbours8().into_iter().find_map(|next| {
                let diagonal = next.x != at.x && next.y != at.y;
                let allowed = !diagonal
                    || self.moves == Moves::Eight
                        && map.is_open(Cell::new(next.x, at.y))
                        && map.is_open(Cell::new(at.x, next.y));
                let length = if diagonal { DIAGONAL } else { STRAIGHT };
                let here = self.cost(next)?.checked_add(u32::from(map.price(next)) * length)?;
                (allowed && here == cost).then_some(next)
            });
            let Some(next) = step else { return way.clear() };
            at = next;
            cost = self.cost(at).unwrap_or(0);
            way.push(at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::OPEN;
    use crate::drawing::{costmap, find};
    use nalgebra::Point2;
    use proptest::prelude::*;
    use std::cmp::Reverse;
    use std::collections::BinaryHeap;

    /// Dijkstra as in the textbook, without anything clever: the oracle.
    fn dijkstra(map: &Costmap, source: Cell, moves: Moves) -> Vec<Option<u32>> {
        let frame = map.frame();
        let mut costs = vec![None; frame.len()];
        let mut heap = BinaryHeap::from([Reverse((0, source))]);
        while let Some(Reverse((cost, cell))) = heap.pop() {
            let Some(index) = frame.index(cell).filter(|_| map.is_open(cell)) else { continue };
            if costs[index].is_some() {
                continue;
            }
            costs[index] = Some(cost);
            for next in cell.neighbours8() {
                let straight = next.x == cell.x || next.y == cell.y;
                let past_corners =
                    map.is_open(Cell::new(next.x, cell.y)) && map.is_open(Cell::new(cell.x, next.y));
                if straight || moves == Moves::Eight && past_corners {
                    let length = if straight { STRAIGHT } else { DIAGONAL };
                    heap.push(Reverse((cost + length * u32::from(map.price(cell)), next)));
                }
            }
        }
        costs
    }

    fn all_costs(wave: &Wavefront, frame: &GridFrame) -> Vec<Option<u32>> {
        (0..frame.len()).map(|index| wave.cost(frame.cell(index))).collect()
    }

    /// A map of random rectangles of random prices: open halls, walls, and rings of dearer cells.
    fn random_map() -> impl Strategy<Value = (Costmap, Cell, Cell)> {
        (3..30_i32, 3..30_i32).prop_flat_map(|(width, height)| {
            let place = move || (0..width, 0..height);
            let price = prop_oneof![3 => Just(CLOSED), 2 => Just(OPEN), 1 => 2..=MAX_PRICE];
            let blocks = prop::collection::vec((place(), (1..8_i32, 1..8_i32), price), 0..30);
            (blocks, place(), place()).prop_map(move |(blocks, source, target)| {
                let frame = GridFrame::new(Point2::origin(), 1.0, width as usize, height as usize).unwrap();
                let mut map = Costmap::closed(frame);
                (0..frame.len()).for_each(|index| map.set_price(frame.cell(index), OPEN));
                for ((left, bottom), (across, up), price) in blocks {
                    for y in bottom..bottom + up {
                        (left..left + across).for_each(|x| map.set_price(Cell::new(x, y), price));
                    }
                }
                (map, Cell::new(source.0, source.1), Cell::new(target.0, target.1))
            })
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn every_cost_is_dijkstras((map, source, _) in random_map(), four in any::<bool>()) {
            let moves = if four { Moves::Four } else { Moves::Eight };
            let mut wave = Wavefront::new(*map.frame(), moves);
            wave.spread(&map, source, None);
            prop_assert_eq!(all_costs(&wave, map.frame()), dijkstra(&map, source, moves));
        }

        #[test]
        fn a_wave_that_stops_early_is_right_up_to_its_target((map, source, target) in random_map()) {
            let mut wave = Wavefront::new(*map.frame(), Moves::Eight);
            // The traces of an earlier wave must not show.
            wave.spread(&map, target, Some(source));
            wave.clear();
            prop_assert!(all_costs(&wave, map.frame()).iter().all(Option::is_none));
            let found = wave.spread(&map, source, Some(target));
            let oracle = dijkstra(&map, source, Moves::Eight);
            let cost = oracle[map.frame().index(target).unwrap()];
            prop_assert_eq!(found, cost.is_some());
            for (index, mine) in all_costs(&wave, map.frame()).into_iter().enumerate() {
                if oracle[index].is_some_and(|theirs| cost.is_none_or(|cost| theirs <= cost)) {
                    prop_assert_eq!(mine, oracle[index]);
                }
            }
        }

        #[test]
        fn the_descent_pays_what_the_field_says((map, source, target) in random_map(), four in any::<bool>()) {
            let moves = if four { Moves::Four } else { Moves::Eight };
            let mut wave = Wavefront::new(*map.frame(), moves);
            let mut way = Vec::new();
            if wave.spread(&map, source, Some(target)) {
                wave.descend(&map, target, &mut way);
                prop_assert_eq!((way[0], way[way.len() - 1]), (target, source));
                let paid: Option<u32> = way.windows(2).map(|step| map.line_cost(step[0], step[1])).sum();
                prop_assert_eq!(paid, wave.cost(target));
                let diagonal = |step: &[Cell]| step[0].x != step[1].x && step[0].y != step[1].y;
                prop_assert!(moves == Moves::Eight || !way.windows(2).any(diagonal));
            }
        }
    }

    #[test]
    fn the_way_leads_through_the_door() {
        let rows = ["....#....", "....#....", "R...D....", "....#....", "....#...G"];
        let map = costmap(&rows);
        let mut wave = Wavefront::new(*map.frame(), Moves::Eight);
        assert!(wave.spread(&map, find(&rows, 'G'), Some(find(&rows, 'R'))));
        let mut way = Vec::new();
        wave.descend(&map, find(&rows, 'R'), &mut way);
        assert!(way.contains(&find(&rows, 'D')));
    }

    #[test]
    fn nothing_leads_through_a_wall_or_between_two_corners() {
        let rows = ["R.#..", "..#.G", "###..", "....."];
        let map = costmap(&rows);
        let mut wave = Wavefront::new(*map.frame(), Moves::Eight);
        assert!(!wave.spread(&map, find(&rows, 'G'), Some(find(&rows, 'R'))));
        let mut way = vec![Cell::new(0, 0)];
        wave.descend(&map, find(&rows, 'R'), &mut way);
        assert_eq!(way, []);
    }

    #[test]
    fn a_wave_from_a_wall_or_from_outside_goes_nowhere() {
        let map = costmap(&["#.", ".."]);
        let mut wave = Wavefront::new(*map.frame(), Moves::Eight);
        for source in [Cell::new(0, 1), Cell::new(-1, 0), Cell::new(2, 0), Cell::new(0, 9)] {
            assert!(!wave.spread(&map, source, Some(Cell::new(1, 1))));
            assert_eq!(wave.cost(Cell::new(1, 1)), None);
        }
    }
}
