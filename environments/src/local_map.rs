//! The map around the robot, in the robot's own frame: an egocentric map for learners.

use crate::task::Part;
use interfaces::CellState;
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};

/// The layers, each from 0 to 1: means over the points that are read in a cell. Beyond the map all are 0.
pub(crate) const LAYERS: [(&str, usize); 7] = [
    // The share that is free, blocked and unknown.
    ("free", 1),
    ("blocked", 1),
    ("unknown", 1),
    // The share that is unknown beside a free cell of the map (Yamauchi, 1997).
    ("frontier", 1),
    // How long ago it was seen: 1 − e^(−time / 60 s); 1 where it was never seen.
    ("age", 1),
    // The probability of a change since it was seen.
    ("changed", 1),
    // The learned rate of change: r / (r + 0.01 Hz). Rates differ by orders of magnitude.
    ("rate", 1),
];
/// The points that are read in a cell, along each side.
const SAMPLES: usize = 2;
/// The time after which the age of a cell is 1 − 1/e, s.
const AGE_S: f64 = 60.0;
/// The rate of change that is shown as ½, Hz.
const RATE_HZ: f64 = 0.01;

/// A square of cells around the robot. Columns go ahead, rows go to the left: row 0 is at the right, column 0 is behind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalMap {
    /// The cells along each side; the robot is in the middle.
    pub(crate) cells: usize,
    /// The side of a cell, m.
    pub(crate) cell_m: f64,
}

impl LocalMap {
    /// The part of the observation.
    pub(crate) fn part(&self) -> Part {
        let shape = vec![LAYERS.len(), self.cells, self.cells];
        Part { slices: LAYERS.to_vec(), ..Part::new("local_map", shape) }
    }

    /// Writes all layers around a pose.
    pub(crate) fn write(&self, mapper: &Mapper, pose: &Isometry2<f64>, layers: &mut [f32]) {
        layers.fill(0.0);
        let size = self.cells * self.cells;
        let weight = 1.0 / (SAMPLES * SAMPLES) as f32;
        let along_m = |cell: usize, sample: usize| {
            (cell as f64 + (sample as f64 + 0.5) / SAMPLES as f64 - self.cells as f64 / 2.0) * self.cell_m
        };
        for at in 0..size {
            let (row, column) = (at / self.cells, at % self.cells);
            for sample in 0..SAMPLES * SAMPLES {
                let (ahead_m, left_m) = (along_m(column, sample % SAMPLES), along_m(row, sample / SAMPLES));
                let point = pose * Point2::new(ahead_m, left_m);
                let Some(index) = mapper.frame().index(mapper.frame().cell_at(&point)) else { continue };
                for (layer, value) in values(mapper, index).into_iter().enumerate() {
                    layers[layer * size + at] += weight * value;
                }
            }
        }
    }
}

/// The values of a cell of the map, by layer.
fn values(mapper: &Mapper, index: usize) -> [f32; LAYERS.len()] {
    let state = mapper.states().cells()[index];
    let is = |is: bool| f32::from(u8::from(is));
    let is_unknown = state == CellState::Unknown;
    let [mut age, mut changed, mut rate] = [1.0, 0.0, 0.0];
    if mapper.was_ever_seen(index) {
        age = 1.0 - libm::exp(-mapper.recency(index) / AGE_S);
        changed = mapper.change_probability(index);
        rate = mapper.acting_rate(index);
    }
    [
        is(state == CellState::Free),
        is(state == CellState::Blocked),
        is(is_unknown),
        is(is_unknown && mapper.is_candidate(index)),
        age as f32,
        changed as f32,
        (rate / (rate + RATE_HZ)) as f32,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Grid, GridFrame, pose};
    use mapper::MapperSettings;
    use std::f64::consts::FRAC_PI_2;

    /// Row 0 at the lowest y, as in the map. A wall with a gap, and unknown space behind it.
    const MAP: [&str; 6] = ["??????", "?#..##", "?#..??", ".....#", "######", "??????"];

    fn map() -> Mapper {
        let frame = GridFrame::new(Point2::new(-0.3, -0.3), 0.1, 6, 6).unwrap();
        let state = |cell: char| match cell {
            '.' => CellState::Free,
            '#' => CellState::Blocked,
            _ => CellState::Unknown,
        };
        let cells = MAP.iter().flat_map(|row| row.chars()).map(state).collect();
        let prior = Grid::from_cells(frame, cells).unwrap();
        Mapper::with_prior(&MapperSettings::default(), prior).unwrap()
    }

    /// The layers around the middle of the map.
    fn layers(heading_rad: f64) -> Vec<Vec<f32>> {
        let local = LocalMap { cells: 6, cell_m: 0.1 };
        let mut layers = vec![0.0; local.part().values()];
        local.write(&map(), &pose(0.0, 0.0, heading_rad), &mut layers);
        layers.chunks(36).map(<[f32]>::to_vec).collect()
    }

    #[test]
    fn a_robot_along_the_x_axis_sees_the_map_as_it_is_drawn() {
        let layers = layers(0.0);
        let drawn = |wanted: char| -> Vec<f32> {
            let cells = MAP.iter().flat_map(|row| row.chars());
            cells.map(|cell| f32::from(u8::from(cell == wanted))).collect()
        };
        assert_eq!(layers[0], drawn('.'));
        assert_eq!(layers[1], drawn('#'));
        assert_eq!(layers[2], drawn('?'));
        // Unknown cells that share a side with a free cell: below the gap, beside the corridor, above its left end.
        let frontier: Vec<usize> = (0..36).filter(|cell| layers[3][*cell] > 0.0).collect();
        assert_eq!(frontier, [2, 3, 12, 16]);
    }

    #[test]
    fn the_map_turns_with_the_robot() {
        let along_x = layers(0.0);
        for turn in 1..4 {
            let turned = layers(f64::from(turn) * FRAC_PI_2);
            for (layer, (of_x, of_turn)) in along_x.iter().zip(&turned).enumerate() {
                for (row, column) in (0..6).flat_map(|row| (0..6).map(move |column| (row, column))) {
                    // A quarter turn to the left: ahead becomes +y, left becomes −x.
                    let (at_row, at_column) = match turn {
                        1 => (column, 5 - row),
                        2 => (5 - row, 5 - column),
                        _ => (5 - column, row),
                    };
                    assert_eq!(of_turn[row * 6 + column], of_x[at_row * 6 + at_column], "{layer}, {turn}");
                }
            }
        }
    }

    #[test]
    fn beyond_the_map_everything_is_zero() {
        let local = LocalMap { cells: 4, cell_m: 0.1 };
        let mut layers = vec![1.0; local.part().values()];
        // The right half of the square is beyond the border at the highest x.
        local.write(&map(), &pose(0.3, 0.0, 0.0), &mut layers);
        for (at, value) in layers.iter().enumerate().filter(|(at, _)| at % 4 >= 2) {
            assert_eq!(*value, 0.0, "{at}");
        }
        let sums: Vec<f32> = (0..16).map(|at| (0..3).map(|layer| layers[layer * 16 + at]).sum()).collect();
        assert!(sums.iter().enumerate().all(|(at, sum)| *sum == f32::from(u8::from(at % 4 < 2))), "{sums:?}");
    }
}
