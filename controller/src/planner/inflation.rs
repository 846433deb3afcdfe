use super::costmap::{Costmap, FREE, LETHAL, MAX_COST};
use interfaces::{Cell, CellState, Grid, Transition};

/// The distance between paths and obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InflationSettings {
    /// A cell is lethal if its center is nearer to a blocked cell than the radius of the robot plus this padding,
    /// m.
    pub footprint_padding_m: f64,
    /// A cell has a higher cost if its center is nearer to a blocked cell than the radius of the robot plus this,
    /// m; at least the padding.
    pub inflation_m: f64,
    /// The cost of such a cell, relative to a free cell, from 1 to [`MAX_COST`].
    pub inflation_cost: u8,
}

/// A row of cells near a blocked cell: from `-reach` to `reach` columns away.
#[derive(Clone, Copy, Debug)]
struct NearRow {
    dy: i32,
    /// The cells that have a higher cost or are lethal.
    reach: i32,
    /// The cells that are lethal; below 0: none.
    lethal_reach: i32,
}

/// For every cell the number of blocked cells that are near enough to make the cell lethal, and to raise its cost.
#[derive(Clone, Debug)]
struct Counts {
    lethal: Vec<i32>,
    inflated: Vec<i32>,
}

impl Counts {
    fn cost(&self, index: usize, inflation_cost: u8) -> u8 {
        match (self.lethal[index], self.inflated[index]) {
            (..=0, ..=0) => FREE,
            (..=0, _) => inflation_cost,
            _ => LETHAL,
        }
    }
}

/// Adds `change` to every count; returns whether a count changed from or to 0.
fn add_to_all(counts: &mut [i32], change: i32) -> bool {
    // No early exit and no check for overflow: several counts at once. A count is at most the size of the stencil.
    let first = if change > 0 { 1 } else { 0 };
    counts.iter_mut().fold(false, |any, count| {
        *count = count.wrapping_add(change);
        any | (*count == first)
    })
}

/// Converts the map into a costmap for the center of a round robot: a cell is lethal if the robot would touch a
/// blocked cell there, and has a higher cost near blocked cells. Cells outside of the grid count as blocked,
/// unknown cells as free.
///
/// The blocked cells around each cell are counted, so that the time of an update is proportional to the number of
/// cells that became blocked or free.
#[derive(Clone, Debug)]
pub struct Inflation {
    costmap: Costmap,
    stencil: Vec<NearRow>,
    counts: Counts,
    cost: u8,
}

impl Inflation {
    /// Inflates `map` for a robot with radius `radius_m`. If the radius and the distances are 0, only the blocked
    /// cells are lethal. The time is proportional to the size of the map.
    pub fn new(settings: &InflationSettings, radius_m: f64, map: &Grid<CellState>) -> Self {
        let frame = *map.frame();
        let cells_of = |distance_m: f64| (radius_m + distance_m) / frame.resolution_m();
        let (lethal, inflated) = (cells_of(settings.footprint_padding_m), cells_of(settings.inflation_m));
        let stencil = stencil(lethal, inflated);
        let mut counts = Counts { lethal: vec![0; frame.len()], inflated: vec![0; frame.len()] };
        for index in 0..frame.len() {
            let Cell { x, y } = frame.cell(index);
            let (right, top) = (frame.width() as i32 - 1 - x, frame.height() as i32 - 1 - y);
            // As if the nearest cell beyond the border were blocked.
            let gap = f64::from(x.min(y).min(right).min(top)) + 0.5;
            counts.lethal[index] = (gap < lethal).into();
            counts.inflated[index] = (gap < inflated).into();
        }
        let cost = settings.inflation_cost.clamp(FREE, MAX_COST);
        let mut inflation = Self { costmap: Costmap::lethal(frame), stencil, counts, cost };
        for (index, state) in map.cells().iter().enumerate() {
            if *state == CellState::Blocked {
                inflation.count_around(frame.cell(index), 1, |_, _, _| {});
            }
        }
        let costs = (0..frame.len()).map(|index| inflation.counts.cost(index, cost));
        inflation.costmap.set_costs(costs);
        inflation
    }

    /// The inflated map.
    pub fn costmap(&self) -> &Costmap {
        &self.costmap
    }

    /// Applies the changes of the map. Calls `blocked` with every cell that becomes lethal, and `cleared` with
    /// every cell that is no longer lethal. The transitions must be all changes since the last update.
    pub fn update(
        &mut self,
        transitions: &[Transition],
        mut blocked: impl FnMut(Cell),
        mut cleared: impl FnMut(Cell),
    ) {
        for transition in transitions {
            let was = transition.before == CellState::Blocked;
            let is = transition.after == CellState::Blocked;
            if was == is {
                continue;
            }
            self.count_around(transition.cell, if is { 1 } else { -1 }, |costmap, cell, cost| {
                match (costmap.cost(cell), cost) {
                    (_, LETHAL) => blocked(cell),
                    (LETHAL, _) => cleared(cell),
                    _ => {}
                }
                costmap.set_cost(cell, cost);
            });
        }
    }

    /// Adds `change` to the count of blocked cells of every cell around `center`; calls `changed` with the new cost
    /// of each cell whose cost may have changed.
    fn count_around(&mut self, center: Cell, change: i32, mut changed: impl FnMut(&mut Costmap, Cell, u8)) {
        let frame = *self.costmap.frame();
        let (width, height) = (frame.width() as i32, frame.height() as i32);
        let Counts { lethal, inflated } = &mut self.counts;
        let mut changed_rows = Vec::new();
        for near in self.stencil.iter().filter(|near| (0..height).contains(&(center.y + near.dy))) {
            let row = (center.y + near.dy) as usize * frame.width();
            let cells = |reach: i32| {
                let (first, last) = ((center.x - reach).max(0), (center.x + reach).min(width - 1));
                row + first as usize..(row + (last + 1).max(first) as usize)
            };
            let mut has_changed = add_to_all(&mut inflated[cells(near.reach)], change);
            if near.lethal_reach >= 0 {
                has_changed |= add_to_all(&mut lethal[cells(near.lethal_reach)], change);
            }
            if has_changed {
                changed_rows.push(cells(near.reach));
            }
        }
        for index in changed_rows.into_iter().flatten() {
            let cell = frame.cell(index);
            let cost = self.counts.cost(index, self.cost);
            if self.costmap.cost(cell) != cost {
                changed(&mut self.costmap, cell, cost);
            }
        }
    }
}

/// The cells whose center is less than `inflated` (at least `lethal`) from the square of a blocked cell, in
/// cells, row by row; the blocked cell is one of them.
fn stencil(lethal: f64, inflated: f64) -> Vec<NearRow> {
    let reach = inflated.max(lethal).max(0.0).ceil() as i32 + 1;
    let gap = |d: i32| (f64::from(d.abs()) - 0.5).max(0.0);
    let rows = (-reach..=reach).map(|dy| {
        let within = |dx: i32, radius: f64| {
            let square = gap(dx) * gap(dx) + gap(dy) * gap(dy);
            (dx, dy) == (0, 0) || radius > 0.0 && square < radius * radius
        };
        let farthest = |radius: f64| (0..=reach).take_while(|&dx| within(dx, radius)).last().unwrap_or(-1);
        NearRow { dy, reach: farthest(lethal.max(inflated)), lethal_reach: farthest(lethal) }
    });
    rows.filter(|row| row.reach >= 0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::states;
    use interfaces::GridFrame;
    use nalgebra::Point2;
    use proptest::prelude::*;

    const RADIUS_M: f64 = 0.2;

    /// The cost by the definition: the distance to every blocked square and to the border.
    fn brute_force(settings: &InflationSettings, map: &Grid<CellState>) -> Vec<u8> {
        let frame = map.frame();
        let (width_m, height_m) =
            (frame.width() as f64 * frame.resolution_m(), frame.height() as f64 * frame.resolution_m());
        let cost = |index: usize| {
            let at = frame.center(frame.cell(index));
            let mut gap_m = at.x.min(at.y).min(width_m - at.x).min(height_m - at.y);
            for (index, state) in map.cells().iter().enumerate() {
                if *state == CellState::Blocked {
                    let blocked = frame.center(frame.cell(index));
                    let side = |d: f64| (d.abs() - frame.resolution_m() / 2.0).max(0.0);
                    gap_m = gap_m.min(side(at.x - blocked.x).hypot(side(at.y - blocked.y)));
                }
            }
            // Only rounding can put a distance of the test on a boundary.
            if gap_m < RADIUS_M + settings.footprint_padding_m - 1e-9 {
                LETHAL
            } else if gap_m < RADIUS_M + settings.inflation_m - 1e-9 {
                settings.inflation_cost
            } else {
                FREE
            }
        };
        (0..frame.len()).map(cost).collect()
    }

    fn costs(inflation: &Inflation) -> Vec<u8> {
        let frame = inflation.costmap().frame();
        (0..frame.len()).map(|index| inflation.costmap().cost(frame.cell(index))).collect()
    }

    proptest! {
        #[test]
        fn updates_equal_brute_force(
            start in prop::collection::vec(0..12_u8, 600),
            updates in prop::collection::vec(prop::collection::vec((0..600_usize, 0..2_u8), 0..20), 1..6),
        ) {
            let frame = GridFrame::new(Point2::origin(), 0.05, 30, 20).unwrap();
            let settings = InflationSettings { footprint_padding_m: 0.07, inflation_m: 0.13, inflation_cost: 4 };
            let state = |n: u8| [CellState::Blocked, CellState::Unknown, CellState::Free][n.min(2) as usize];
            let mut map = Grid::from_cells(frame, start.into_iter().map(state).collect()).unwrap();
            let mut inflation = Inflation::new(&settings, RADIUS_M, &map);
            prop_assert_eq!(costs(&inflation), brute_force(&settings, &map));
            for update in updates {
                let mut free: Vec<_> = costs(&inflation).iter().map(|cost| *cost != LETHAL).collect();
                let transitions: Vec<_> = update.into_iter().filter_map(|(index, blocked)| {
                    let (cell, after) = (frame.cell(index), state(2 * (1 - blocked)));
                    let before = std::mem::replace(map.get_mut(cell)?, after);
                    (before != after).then_some(Transition { cell, before, after })
                }).collect();
                let (mut blocked_cells, mut cleared_cells) = (Vec::new(), Vec::new());
                inflation.update(&transitions, |cell| blocked_cells.push(cell), |cell| cleared_cells.push(cell));
                prop_assert_eq!(costs(&inflation), brute_force(&settings, &map));
                // Every cell that became lethal, or is no longer lethal, must be reported.
                for (index, was) in free.iter_mut().enumerate() {
                    let (cell, is) = (frame.cell(index), inflation.costmap().is_traversable(frame.cell(index)));
                    prop_assert!(is || !*was || blocked_cells.contains(&cell));
                    prop_assert!(!is || *was || cleared_cells.contains(&cell));
                }
            }
        }
    }

    #[test]
    fn a_robot_without_extent_is_stopped_by_blocked_cells_only() {
        let map = states(&["?#.", "..."], 1.0);
        let point = InflationSettings { footprint_padding_m: 0.0, inflation_m: 0.0, inflation_cost: 1 };
        let inflation = Inflation::new(&point, 0.0, &map);
        assert_eq!(costs(&inflation), [FREE, FREE, FREE, FREE, LETHAL, FREE]);
    }
}
