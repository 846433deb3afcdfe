//! The plan of a grid world, as drawn beside the curves.

use interfaces::Cell;
use sim::grid::{BlockSpec, GridSpec};

/// The plan of a grid world. Cells are (column, row), rows counted from the bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorldPicture {
    /// The name of the world, as in [`super::Trial::world`].
    pub name: String,
    /// Whether each cell is a wall; rows from the bottom.
    pub walls: Vec<Vec<bool>>,
    /// The moving things: the name, and every cell of the path.
    pub things: Vec<(String, Vec<(usize, usize)>)>,
    /// The start of the robot.
    pub start: (usize, usize),
    /// The range of the sensor, in cells.
    pub sensor_radius: u32,
}

impl WorldPicture {
    /// The plan of `world`.
    pub fn of(world: &GridSpec) -> Self {
        let at = |cell: &Cell| (cell.x as usize, cell.y as usize);
        let block = |block: &BlockSpec| (block.name.clone(), block.path.iter().map(at).collect());
        Self {
            name: world.name.to_owned(),
            walls: world.walls.cells().chunks(world.frame().width()).map(<[bool]>::to_vec).collect(),
            things: world.blocks.iter().map(block).collect(),
            start: at(&world.start),
            sensor_radius: world.sensor_radius,
        }
    }

    /// Width and height in cells.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.walls.first().map_or(0, Vec::len), self.walls.len()]
    }
}
