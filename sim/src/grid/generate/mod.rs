//! Random worlds, each from a seed.

mod calendar;
mod paths;
mod rooms;
#[cfg(test)]
mod tests;

use super::spec::{BlockSpec, GridSpec};
use interfaces::{Cell, Grid, GridFrame, Purpose, RandomStream};
use nalgebra::Point2;
use paths::BlockPath;
use rand::RngExt;

/// The maximum number of maps that are drawn until a map has room for all blocks.
const MAX_MAPS: usize = 20;

/// Settings of random worlds. A pair is the smallest and the largest value, both included and within the given range; each world
/// draws its own value between them.
#[derive(Clone, Debug, PartialEq)]
pub struct GenerateSettings {
    /// Columns, outer walls included; 9 to 1000.
    pub width: [u32; 2],
    /// Rows, outer walls included; 9 to 1000.
    pub height: [u32; 2],
    /// Inner walls from wall to wall, each with one or two openings; 0 to 1000. There are fewer where no room is
    /// large enough to be divided.
    pub walls: [u32; 2],
    /// The width of an opening, cells; 1 to 100.
    pub opening: [u32; 2],
    /// Short walls that touch no other wall; 0 to 1000.
    pub pillars: [u32; 2],
    /// Moving blocks; 0 to 1000. There are fewer where there is no room.
    pub blocks: [u32; 2],
    /// The number of cells of the path of a block; 2 to 1000.
    pub path_cells: [u32; 2],
    /// The steps that a block stays on a cell, 1 to 1 000 000. All orders of magnitude are equally likely.
    pub dwell: [u32; 2],
    /// The range of the sensor of the robot, cells; 1 to 100.
    pub sensor_radius: u32,
}

impl Default for GenerateSettings {
    /// Worlds similar to the shipped worlds.
    fn default() -> Self {
        Self {
            width: [21, 31],
            height: [21, 27],
            walls: [2, 5],
            opening: [1, 3],
            pillars: [0, 4],
            blocks: [2, 6],
            path_cells: [3, 20],
            dwell: [1, 60],
            sensor_radius: 4,
        }
    }
}

impl GridSpec {
    /// A random world, named `generated-` and the seed: an outer wall, inner walls with openings, free-standing
    /// walls, blocks with paths that do not touch each other, the robot in the center. All free cells are
    /// connected. The same settings and seed give the same world, on every machine.
    ///
    /// # Panics
    ///
    /// When a pair is in the wrong order.
    pub fn generate(settings: &GenerateSettings, seed: u64) -> Self {
        let mut rng = RandomStream::new(seed, Purpose::WorldGenerator);
        let wanted = between(&mut rng, settings.blocks) as usize;
        let mut best = draw(settings, wanted, seed, &mut rng);
        for _ in 1..MAX_MAPS {
            if best.blocks.len() == wanted {
                break;
            }
            let other = draw(settings, wanted, seed, &mut rng);
            if other.blocks.len() > best.blocks.len() {
                best = other;
            }
        }
        best
    }
}

/// A world with the `wanted` number of blocks, or with as many as there is room for.
fn draw(settings: &GenerateSettings, wanted: usize, seed: u64, rng: &mut RandomStream) -> GridSpec {
    let (width, height) = (between(rng, settings.width), between(rng, settings.height));
    let frame = frame(width, height);
    let start = Cell::new(width / 2, height / 2);
    let walls = rooms::walls(settings, frame, start, rng);
    let paths = paths::paths(settings, &walls, start, wanted, rng);
    let blocks: Vec<BlockSpec> =
        (1..).zip(paths).map(|(number, path)| block(settings, number, path, rng)).collect();
    GridSpec {
        name: format!("generated-{seed}"),
        description: format!("{width} × {height} cells made at random from the seed {seed}."),
        walls,
        blocks,
        start,
        sensor_radius: settings.sensor_radius,
        block_probability: 1.0,
        robot_probability: 1.0,
        calendar: None,
    }
}

fn block(settings: &GenerateSettings, number: usize, path: BlockPath, rng: &mut RandomStream) -> BlockSpec {
    let [low, high] = settings.dwell;
    let (log_low, log_high) = (libm::log(f64::from(low)), libm::log(f64::from(high) + 1.0));
    let log_dwell = log_low + rng.random::<f64>() * (log_high - log_low);
    let dwell = (libm::exp(log_dwell) as u32).clamp(low, high);
    let name = format!("block {number}");
    let stood = rng.random_range(0..dwell);
    BlockSpec { name, dwell, stood, course: path.course, path: path.cells, schedule: None }
}

/// The frame of at most 1000 × 1000 cells of 1 m.
fn frame(width: i32, height: i32) -> GridFrame {
    let frame = GridFrame::new(Point2::origin(), 1.0, width as usize, height as usize);
    frame.expect("at most a million cells of 1 m make a frame")
}

/// A random number between the two of a setting.
fn between(rng: &mut RandomStream, [low, high]: [u32; 2]) -> i32 {
    rng.random_range(low..=high) as i32
}

/// Whether a cell and the eight around it are all free of walls.
fn stands_free(walls: &Grid<bool>, cell: Cell) -> bool {
    cell.neighbours8().into_iter().chain([cell]).all(|near| walls.get(near) == Some(&false))
}
