//! Which cells are visible from which cells, according to the map.
//!
//! A strategy that looks ahead needs the view from every possible goal. Views are therefore stored, and computed
//! again only where a wall appeared or disappeared. If the grid is fine and the range of the sensor is long, the
//! map is divided into regions of several cells, since neighboring cells have the same view.

mod shadow_casting;

pub(crate) use shadow_casting::Regions;

use interfaces::CellState;
use mapper::Mapper;
use shadow_casting::cast;
use std::ops::Range;

/// The view from every region, within the radius of the robot's sensor.
///
/// A cell hides what lies behind it if it is blocked and never changed. A cell that changed is likely to change
/// again and counts as transparent; unknown cells count as transparent, too.
#[derive(Clone, Debug)]
pub(crate) struct Visibility {
    /// The range of the sensor, m.
    pub(crate) radius_m: f64,
    /// Those of the last map.
    pub(crate) regions: Option<Regions>,
    opaque: Vec<bool>,
    /// For each region the regions in view, as runs: in a row of the map they are mostly beside each other. `None` until they are
    /// needed.
    views: Vec<Option<Vec<Range<u32>>>>,
}

impl Visibility {
    /// For a robot whose sensor has the range `radius_m`, before any map.
    pub(crate) fn new(radius_m: f64) -> Self {
        Self { radius_m, regions: None, opaque: Vec::new(), views: Vec::new() }
    }

    /// Applies the present map and returns its regions. Call it before views are computed. One pass over the map.
    pub(crate) fn update(&mut self, mapper: &Mapper) -> Regions {
        let regions = Regions::of_sensor(*mapper.frame(), self.radius_m);
        if self.regions != Some(regions) {
            self.regions = Some(regions);
            self.opaque = vec![false; regions.count()];
            self.views = vec![None; regions.count()];
        }
        let mut walls = vec![0u32; regions.count()];
        for (index, state) in mapper.states().cells().iter().enumerate() {
            if *state == CellState::Blocked {
                walls[regions.of(index)] += 1;
            }
        }
        for index in mapper.changed() {
            if mapper.states().cells()[index] == CellState::Blocked {
                walls[regions.of(index)] -= 1;
            }
        }
        for (region, &walls) in walls.iter().enumerate() {
            // The number of cells of a wall across the region.
            let is_opaque = walls as usize >= regions.side;
            if is_opaque != self.opaque[region] {
                self.opaque[region] = is_opaque;
                self.drop_views_of(&regions, region);
            }
        }
        regions
    }

    /// The regions in view from a region, in order, including the region itself.
    pub(crate) fn seen_from(&mut self, region: usize) -> impl Iterator<Item = usize> {
        let Self { regions, opaque, views, radius_m } = self;
        let runs = regions.as_ref().map(|regions| {
            let view = &mut views[region];
            &*view.get_or_insert_with(|| runs(&cast(regions, opaque, region, regions.reach(*radius_m))))
        });
        runs.into_iter().flatten().flat_map(|run| run.start as usize..run.end as usize)
    }

    /// Drops the stored views that may contain a region.
    fn drop_views_of(&mut self, regions: &Regions, region: usize) {
        let reach = regions.reach(self.radius_m) as usize;
        let (column, row) = (region % regions.columns, region / regions.columns);
        for row in row.saturating_sub(reach)..(row + reach + 1).min(regions.rows) {
            let columns = column.saturating_sub(reach)..(column + reach + 1).min(regions.columns);
            self.views[row * regions.columns..][columns].fill(None);
        }
    }
}

/// The runs of consecutive numbers in a sorted list.
fn runs(numbers: &[u32]) -> Vec<Range<u32>> {
    numbers.chunk_by(|one, next| one + 1 == *next).map(|run| run[0]..run[run.len() - 1] + 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Cell, CellReading, GridFrame};
    use mapper::MapperSettings;
    use nalgebra::{Isometry2, Point2};
    use proptest::prelude::*;

    /// A map of cells of 1 m: `#` a wall, `.` free, a blank unknown; the top line has the highest y.
    fn map(rows: &[&str]) -> Mapper {
        let frame = GridFrame::new(Point2::origin(), 1.0, rows[0].len(), rows.len()).unwrap();
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        look(&mut mapper, 0.0, rows);
        mapper
    }

    fn look(mapper: &mut Mapper, time: f64, rows: &[&str]) {
        let cells = rows.iter().rev().zip(0..).flat_map(|(row, y)| {
            let known = row.chars().zip(0..).filter(|&(letter, _)| letter != ' ');
            known.map(move |(letter, x)| (Cell::new(x, y), letter == '#'))
        });
        let cells = cells.collect();
        mapper.update(&CellReading { time, pose: Isometry2::identity(), cells }).unwrap();
    }

    /// The view from a cell: `o` in view, `-` not in view.
    fn drawn(visibility: &mut Visibility, mapper: &Mapper, from: Cell) -> Vec<String> {
        let regions = visibility.update(mapper);
        let frame = mapper.frame();
        let seen: Vec<usize> = visibility.seen_from(regions.of(frame.index(from).unwrap())).collect();
        let letter = |index: usize| if seen.contains(&regions.of(index)) { 'o' } else { '-' };
        let row = |y: usize| (0..frame.width()).map(|x| letter(y * frame.width() + x)).collect();
        (0..frame.height()).rev().map(row).collect()
    }

    #[test]
    fn moving_things_do_not_hide_and_walls_found_later_do() {
        let mut mapper = map(&["....."]);
        let mut visibility = Visibility::new(9.0);
        assert_eq!(drawn(&mut visibility, &mapper, Cell::new(0, 0)), ["ooooo"]);
        look(&mut mapper, 1.0, &["..#.."]);
        assert_eq!(drawn(&mut visibility, &mapper, Cell::new(0, 0)), ["ooooo"]);
        let mut mapper = map(&[".. .."]);
        assert_eq!(drawn(&mut visibility, &mapper, Cell::new(0, 0)), ["ooooo"]);
        look(&mut mapper, 1.0, &["..#.."]);
        assert_eq!(drawn(&mut visibility, &mapper, Cell::new(0, 0)), ["ooo--"]);
    }

    #[test]
    fn a_fine_grid_is_cut_into_regions() {
        let frame = GridFrame::new(Point2::origin(), 0.05, 243, 100).unwrap();
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let wall = (0..100).map(|y| (Cell::new(122, y), true)).collect();
        mapper.update(&CellReading { time: 0.0, pose: Isometry2::identity(), cells: wall }).unwrap();
        let mut visibility = Visibility::new(10.0);
        let regions = visibility.update(&mapper);
        assert_eq!((regions.side, regions.columns, regions.rows), (5, 49, 20));
        let mut cells: Vec<usize> = (0..regions.count()).flat_map(|region| regions.cells(region)).collect();
        assert!(
            (0..regions.count()).all(|region| regions.cells(region).all(|cell| regions.of(cell) == region))
        );
        cells.sort_unstable();
        assert_eq!(cells, (0..frame.len()).collect::<Vec<_>>());
        assert_eq!(visibility.seen_from(0).count(), 25 * 20, "up to the wall, the wall included");
    }

    /// Whether the line from the center of `from` to that of `to` passes through the inside of the
    /// unit square around `cell`: cut by the square's sides, some of it is left.
    fn crosses(from: Cell, to: Cell, cell: Cell) -> bool {
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        for (from, to, at) in [(from.x, to.x, cell.x), (from.y, to.y, cell.y)] {
            let (way, gap) = (f64::from(to - from), f64::from(at - from));
            if way == 0.0 {
                if gap != 0.0 {
                    return false;
                }
            } else {
                let (one, other) = ((gap - 0.5) / way, (gap + 0.5) / way);
                enter = enter.max(one.min(other));
                leave = leave.min(one.max(other));
            }
        }
        leave - enter > 1e-9
    }

    proptest! {
        #[test]
        fn in_view_is_what_no_wall_parts_from_the_origin(
            walls in prop::collection::vec(prop::bool::weighted(0.3), 99),
            reach in 0.0..12.0,
        ) {
            let rows: Vec<String> = walls
                .chunks(11)
                .map(|row| row.iter().map(|&wall| if wall { '#' } else { '.' }).collect())
                .collect();
            let mapper = map(&rows.iter().map(String::as_str).collect::<Vec<_>>());
            let frame = *mapper.frame();
            let mut visibility = Visibility::new(reach);
            let regions = visibility.update(&mapper);
            for origin in 0..regions.count() {
                let from = frame.cell(origin);
                let expected: Vec<usize> = (0..regions.count())
                    .filter(|&index| {
                        let to = frame.cell(index);
                        let is_between = |&wall: &usize| {
                            let cell = frame.cell(wall);
                            visibility.opaque[wall] && cell != from && cell != to && crosses(from, to, cell)
                        };
                        f64::from((to.x - from.x).pow(2) + (to.y - from.y).pow(2)) <= reach * reach
                            && !(0..regions.count()).any(|wall| is_between(&wall))
                    })
                    .collect();
                let seen: Vec<usize> = visibility.seen_from(origin).collect();
                prop_assert_eq!(seen, expected, "from {:?}", from);
            }
        }
    }
}
