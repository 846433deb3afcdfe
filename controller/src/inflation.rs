use crate::costmap::{CLOSED, Costmap, MAX_PRICE, OPEN};
use interfaces::{Cell, CellState, Grid, Transition};
use serde::{Deserialize, Serialize};

/// How far paths keep from what is blocked.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct InflationSettings {
    /// A cell is closed where its centre is nearer to a blocked cell than the robot's radius and
    /// this, m. Room for half a cell of rounding and for the error of path following.
    pub margin_m: f64,
    /// A cell is dear where its centre is nearer to a blocked cell than the robot's radius and
    /// this, m. Keeps paths to the middle of doors, and out of the way along walls.
    pub comfort_m: f64,
    /// How many times dearer than others such a cell is, 1 to [`MAX_PRICE`].
    pub comfort_price: u8,
}

impl Default for InflationSettings {
    fn default() -> Self {
        Self { margin_m: 0.08, comfort_m: 0.25, comfort_price: 3 }
    }
}

/// A cell near a blocked one, relative to it.
#[derive(Clone, Copy, Debug)]
struct Near {
    dx: i32,
    dy: i32,
    closed: bool,
}

/// How many blocked cells are near a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    closing: u32,
    nearing: u32,
}

impl Count {
    /// What of it matters for the price.
    fn is_zero(self) -> [bool; 2] {
        [self.closing == 0, self.nearing == 0]
    }
}

/// The map as the centre of a round robot meets it: closed where its body would touch something
/// blocked, dear near it. Cells outside of the grid are blocked, unknown ones are not: what was
/// never seen is hoped to be free.
///
/// Kept by counting the blocked cells around each cell, so that an update costs in proportion to
/// the cells that turned blocked or ceased to be.
#[derive(Clone, Debug)]
pub struct Inflation {
    costmap: Costmap,
    near: Vec<Near>,
    counts: Vec<Count>,
    comfort_price: u8,
}

impl Inflation {
    /// Inflates `map` for a robot of `radius_m`; with a radius and distances of 0 a cell is closed
    /// only where it is blocked itself. Costs time in proportion to the map.
    pub fn new(settings: &InflationSettings, radius_m: f64, map: &Grid<CellState>) -> Self {
        let frame = *map.frame();
        let cells_of = |distance_m: f64| (radius_m + distance_m) / frame.resolution_m();
        let (closed, comfort) = (cells_of(settings.margin_m), cells_of(settings.comfort_m));
        let near = stencil(closed, comfort);
        let mut counts = vec![Count::default(); frame.len()];
        for (index, count) in counts.iter_mut().enumerate() {
            let Cell { x, y } = frame.cell(index);
            let (right, top) = (frame.width() as i32 - 1 - x, frame.height() as i32 - 1 - y);
            // As if the nearest cell beyond the border were blocked.
            let gap = f64::from(x.min(y).min(right).min(top)) + 0.5;
            *count = Count { closing: (gap < closed).into(), nearing: (gap < comfort).into() };
        }
        let comfort_price = settings.comfort_price.clamp(OPEN, MAX_PRICE);
        let mut inflation = Self { costmap: Costmap::closed(frame), near, counts, comfort_price };
        for (index, state) in map.cells().iter().enumerate() {
            if *state == CellState::Blocked {
                inflation.count_around(frame.cell(index), 1, |_, _| {});
            }
        }
        let prices: Vec<_> = inflation.counts.iter().map(|count| inflation.price(*count)).collect();
        inflation.costmap.set_prices(prices);
        inflation
    }

    /// The inflated map.
    pub fn costmap(&self) -> &Costmap {
        &self.costmap
    }

    /// Follows the map's changes; calls `closed` with every cell that closed and `opened` with
    /// every cell that opened on the way. The transitions must be all that the map made since the
    /// last update.
    pub fn update(
        &mut self,
        transitions: &[Transition],
        mut closed: impl FnMut(Cell),
        mut opened: impl FnMut(Cell),
    ) {
        for transition in transitions {
            let was = transition.before == CellState::Blocked;
            let is = transition.after == CellState::Blocked;
            if was == is {
                continue;
            }
            let mut repriced = |costmap: &mut Costmap, (cell, price): (Cell, u8)| {
                match (costmap.price(cell), price) {
                    (before, after) if before == after => return,
                    (_, CLOSED) => closed(cell),
                    (CLOSED, _) => opened(cell),
                    _ => {}
                }
                costmap.set_price(cell, price);
            };
            self.count_around(transition.cell, if is { 1 } else { -1 }, &mut repriced);
        }
    }

    /// Counts one blocked cell more or less in the cells around it, and tells their prices.
    fn count_around(&mut self, blocked: Cell, change: i32, mut priced: impl FnMut(&mut Costmap, (Cell, u8))) {
        let frame = *self.costmap.frame();
        for near in &self.near {
            let cell = Cell::new(blocked.x + near.dx, blocked.y + near.dy);
            let Some(index) = frame.index(cell) else { continue };
            let count = &mut self.counts[index];
            let before = *count;
            count.nearing = count.nearing.saturating_add_signed(change);
            if near.closed {
                count.closing = count.closing.saturating_add_signed(change);
            }
            if before.is_zero() != count.is_zero() {
                let price = price(*count, self.comfort_price);
                priced(&mut self.costmap, (cell, price));
            }
        }
    }

    fn price(&self, count: Count) -> u8 {
        price(count, self.comfort_price)
    }
}

fn price(count: Count, comfort_price: u8) -> u8 {
    match count {
        Count { closing: 0, nearing: 0 } => OPEN,
        Count { closing: 0, .. } => comfort_price,
        _ => CLOSED,
    }
}

/// The cells whose centre is less than `comfort` (at least `closed`) from a blocked cell's square,
/// in cells; the blocked cell is one of them.
fn stencil(closed: f64, comfort: f64) -> Vec<Near> {
    let reach = comfort.max(closed).max(0.0).ceil() as i32 + 1;
    let mut near = Vec::new();
    for dy in -reach..=reach {
        for dx in -reach..=reach {
            let gap = |d: i32| (f64::from(d.abs()) - 0.5).max(0.0);
            let square = gap(dx) * gap(dx) + gap(dy) * gap(dy);
            let within = |radius: f64| (dx, dy) == (0, 0) || radius > 0.0 && square < radius * radius;
            if within(closed.max(comfort)) {
                near.push(Near { dx, dy, closed: within(closed) });
            }
        }
    }
    near
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::states;
    use interfaces::GridFrame;
    use nalgebra::Point2;
    use proptest::prelude::*;

    const RADIUS_M: f64 = 0.2;

    /// The price by the definition: the distance to every blocked square and to the border.
    fn brute_force(settings: &InflationSettings, map: &Grid<CellState>) -> Vec<u8> {
        let frame = map.frame();
        let (width_m, height_m) =
            (frame.width() as f64 * frame.resolution_m(), frame.height() as f64 * frame.resolution_m());
        let price = |index: usize| {
            let at = frame.center(frame.cell(index));
            let mut gap_m = at.x.min(at.y).min(width_m - at.x).min(height_m - at.y);
            for (index, state) in map.cells().iter().enumerate() {
                if *state == CellState::Blocked {
                    let blocked = frame.center(frame.cell(index));
                    let side = |d: f64| (d.abs() - frame.resolution_m() / 2.0).max(0.0);
                    gap_m = gap_m.min(side(at.x - blocked.x).hypot(side(at.y - blocked.y)));
                }
            }
            // The distances of the test never lie on a boundary but by rounding.
            if gap_m < RADIUS_M + settings.margin_m - 1e-9 {
                CLOSED
            } else if gap_m < RADIUS_M + settings.comfort_m - 1e-9 {
                settings.comfort_price
            } else {
                OPEN
            }
        };
        (0..frame.len()).map(price).collect()
    }

    fn prices(inflation: &Inflation) -> Vec<u8> {
        let frame = inflation.costmap().frame();
        (0..frame.len()).map(|index| inflation.costmap().price(frame.cell(index))).collect()
    }

    proptest! {
        #[test]
        fn updates_equal_brute_force(
            start in prop::collection::vec(0..12_u8, 600),
            updates in prop::collection::vec(prop::collection::vec((0..600_usize, 0..2_u8), 0..20), 1..6),
        ) {
            let frame = GridFrame::new(Point2::origin(), 0.05, 30, 20).unwrap();
            let settings = InflationSettings { margin_m: 0.07, comfort_m: 0.13, comfort_price: 4 };
            let state = |n: u8| [CellState::Blocked, CellState::Unknown, CellState::Free][n.min(2) as usize];
            let mut map = Grid::from_cells(frame, start.into_iter().map(state).collect()).unwrap();
            let mut inflation = Inflation::new(&settings, RADIUS_M, &map);
            prop_assert_eq!(prices(&inflation), brute_force(&settings, &map));
            for update in updates {
                let mut open: Vec<_> = prices(&inflation).iter().map(|price| *price != CLOSED).collect();
                let transitions: Vec<_> = update.into_iter().filter_map(|(index, blocked)| {
                    let (cell, after) = (frame.cell(index), state(2 * (1 - blocked)));
                    let before = std::mem::replace(map.get_mut(cell)?, after);
                    (before != after).then_some(Transition { cell, before, after })
                }).collect();
                let (mut shut, mut opened) = (Vec::new(), Vec::new());
                inflation.update(&transitions, |cell| shut.push(cell), |cell| opened.push(cell));
                prop_assert_eq!(prices(&inflation), brute_force(&settings, &map));
                // What closed and what opened is told.
                for (index, was) in open.iter_mut().enumerate() {
                    let (cell, is) = (frame.cell(index), inflation.costmap().is_open(frame.cell(index)));
                    prop_assert!(is || !*was || shut.contains(&cell));
                    prop_assert!(!is || *was || opened.contains(&cell));
                }
            }
        }
    }

    #[test]
    fn a_robot_without_extent_is_stopped_by_blocked_cells_only() {
        let map = states(&["?#.", "..."], 1.0);
        let point = InflationSettings { margin_m: 0.0, comfort_m: 0.0, comfort_price: 1 };
        let inflation = Inflation::new(&point, 0.0, &map);
        assert_eq!(prices(&inflation), [OPEN, OPEN, OPEN, OPEN, CLOSED, OPEN]);
    }
}
