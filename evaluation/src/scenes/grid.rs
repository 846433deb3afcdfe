//! The scene of a grid world. Cells are 1 m wide, with `[0, 0]` at the origin.

use super::Displayed;
use draw::scene::{Obstacle, Outline, Scene, SceneRobot, Sector};
use interfaces::{Cell, Grid};
use nalgebra::{Isometry2, Point2};
use sim::grid::GridSpec;
use std::f64::consts::TAU;

/// The name of the only robot.
const ROBOT: &str = "robot";
/// The radius that the robot is drawn with, m: a little less than half a cell.
const ROBOT_RADIUS_M: f64 = 0.35;
impl Displayed for GridSpec {
    fn scene(&self) -> Scene {
        let square = |cell: &Cell| rectangle(*cell, *cell);
        let start = self.frame().center(self.start);
        Scene {
            title: self.name.to_owned(),
            is_grid: true,
            frame: *self.frame(),
            walls: rectangles(&self.walls),
            obstacles: self
                .blocks
                .iter()
                .map(|block| Obstacle {
                    name: block.name.clone(),
                    outline: block.path.first().map_or(Vec::new(), square),
                    reach: block.path.iter().map(square).collect(),
                })
                .collect(),
            robots: vec![SceneRobot {
                name: ROBOT.to_owned(),
                pose: Isometry2::translation(start.x, start.y),
                radius_m: ROBOT_RADIUS_M,
                corners: Vec::new(),
                sectors: vec![Sector {
                    mount: Isometry2::identity(),
                    angle_rad: TAU,
                    range_m: f64::from(self.sensor_radius),
                }],
                is_driven: true,
            }],
        }
    }
}

/// The rectangle from one cell to another, both included, m.
fn rectangle(low: Cell, high: Cell) -> Outline {
    let from = Point2::new(f64::from(low.x), f64::from(low.y));
    let to = Point2::new(f64::from(high.x + 1), f64::from(high.y + 1));
    vec![from, Point2::new(to.x, from.y), to, Point2::new(from.x, to.y)]
}

/// Few rectangles that cover the cells: runs along the rows, joined with runs of the same columns above.
fn rectangles(cells: &Grid<bool>) -> Vec<Outline> {
    let mut done: Vec<(Cell, Cell)> = Vec::new();
    let mut open: Vec<(Cell, Cell)> = Vec::new();
    for (row, y) in cells.rows().zip(0..) {
        let row: Vec<bool> = row.copied().collect();
        let mut x = 0;
        let mut still_open = Vec::new();
        for run in row.chunk_by(|a, b| a == b) {
            let (from, to) = (x, x + run.len() as i32 - 1);
            x = to + 1;
            if run[0] {
                let below = open.iter().position(|(low, high)| (low.x, high.x) == (from, to));
                let low = below.map_or(Cell::new(from, y), |below| open.swap_remove(below).0);
                still_open.push((low, Cell::new(to, y)));
            }
        }
        done.append(&mut open);
        open = still_open;
    }
    done.append(&mut open);
    done.sort_unstable();
    done.into_iter().map(|(low, high)| rectangle(low, high)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_cover_the_walls_once_and_nothing_else() {
        let rows = ["#######", "#..#..#", "####R.#", "#..##.#", "#.....#", "##.##.#", "#######"];
        let text = format!("name = 'x'\nsensor_radius = 1\nmap = '''\n{}\n'''", rows.join("\n"));
        let walls = worldfile::grid::parse("x.toml", &text).unwrap().walls;
        let rectangles = rectangles(&walls);
        assert_eq!(rectangles.len(), 10);
        for (index, is_wall) in walls.cells().iter().enumerate() {
            let middle = walls.frame().center(walls.frame().cell(index));
            let is_between = |axis: usize, of: &Outline| (of[0][axis]..of[2][axis]).contains(&middle[axis]);
            let holds = |outline: &&Outline| is_between(0, outline) && is_between(1, outline);
            assert_eq!(rectangles.iter().filter(holds).count(), usize::from(*is_wall), "{middle}");
        }
    }
}
