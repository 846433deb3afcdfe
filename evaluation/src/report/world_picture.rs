//! A grid world as it is drawn beside its curves.

use interfaces::Cell;
use sim::grid::{BlockSpec, GridSpec};

/// The plan of a grid world. Cells are (column, row), rows counted from the bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorldPicture {
    /// The world's name, as in [`super::Trial::world`].
    pub name: String,
    /// Which cells are walls; rows from the bottom, all of one length.
    pub walls: Vec<Vec<bool>>,
    /// What moves: a name and every cell that it is ever on.
    pub things: Vec<(String, Vec<(usize, usize)>)>,
    /// Where the robot starts.
    pub start: (usize, usize),
    /// How far its sensor reaches, in cells.
    pub sensor_radius: u32,
}

impl WorldPicture {
    /// What `world` looks like.
    pub fn of(world: &GridSpec) -> Self {
        let at = |cell: &Cell| (cell.x as usize, cell.y as usize);
        let block = |block: &BlockSpec| (block.name.clone(), block.path.iter().map(at).collect());
        Self {
            name: world.name().to_owned(),
            walls: world.walls().cells().chunks(world.frame().width()).map(<[bool]>::to_vec).collect(),
            things: world.blocks().iter().map(block).collect(),
            start: at(&world.start()),
            sensor_radius: world.sensor_radius(),
        }
    }

    /// Width and height in cells.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.walls.first().map_or(0, Vec::len), self.walls.len()]
    }
}
