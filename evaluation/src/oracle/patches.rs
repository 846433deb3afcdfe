use interfaces::{Cell, Grid, GridFrame};
use sim::grid::GridSpec;
use sim::physics::{Motion, WorldSpec};

/// The side of a patch in a physics world, m.
const PATCH_M: f64 = 0.25;

/// The patches of a world: the places that the oracle can go to, and what is in view from there if nothing that moves
/// is in between.
#[derive(Clone, Debug)]
pub(super) struct Patches {
    /// The cells of every patch.
    pub(super) cells: Vec<Vec<usize>>,
    /// The cell in the middle of every patch.
    pub(super) middles: Vec<usize>,
    /// The patches in view from every patch; none from inside a wall.
    pub(super) in_view: Vec<Vec<usize>>,
}

impl Patches {
    /// Every cell of a grid world is a patch.
    pub(super) fn of_grid(world: &GridSpec) -> Self {
        let cells = world.frame().len();
        Self {
            cells: (0..cells).map(|cell| vec![cell]).collect(),
            middles: (0..cells).collect(),
            in_view: world.sights(),
        }
    }

    /// Squares of cells of a physics world. A square in which a wall or furniture stands hides what is behind it, also
    /// where a closed door does not: a little less is in view than in the world.
    pub(super) fn of_physics(world: &WorldSpec) -> Self {
        let frame = &world.frame;
        let side = (PATCH_M / frame.resolution_m()).round().max(1.0) as usize;
        let (width, height) = (frame.width().div_ceil(side), frame.height().div_ceil(side));
        let corner = frame.center(Cell::new(0, 0));
        let resolution_m = side as f64 * frame.resolution_m();
        let of_patches = GridFrame::new(corner, resolution_m, width, height);
        let of_patches = of_patches.expect("fewer patches than cells make a frame");
        let fixed = world
            .obstacles
            .iter()
            .filter(|obstacle| obstacle.motion == Motion::Fixed && !obstacle.is_mover());
        let solids: Vec<_> =
            world.walls.iter().copied().chain(fixed.map(|obstacle| obstacle.shape)).collect();
        let mut walls = Grid::filled(of_patches, false);
        let (mut cells, mut middles) = (vec![Vec::new(); of_patches.len()], vec![0; of_patches.len()]);
        for index in 0..frame.len() {
            let Cell { x, y } = frame.cell(index);
            let [column, row] = [x, y].map(|at| at / side as i32);
            let patch = Cell::new(column, row);
            let (Some(number), Some(wall)) = (of_patches.index(patch), walls.get_mut(patch)) else {
                continue;
            };
            let center = frame.center(frame.cell(index));
            *wall |= solids.iter().any(|solid| solid.distance_m(&center) == 0.0);
            cells[number].push(index);
            middles[number] = cells[number][cells[number].len() / 2];
        }
        let range = (world.driven().laser.range_max_m / resolution_m).floor() as u32;
        let in_grid = GridSpec {
            name: world.name.clone(),
            description: String::new(),
            walls,
            blocks: Vec::new(),
            start: Cell::new(0, 0),
            sensor_radius: range.clamp(1, GridSpec::MAX_SENSOR_RADIUS),
            block_probability: 1.0,
            robot_probability: 1.0,
            calendar: None,
        };
        Self { cells, middles, in_view: in_grid.sights() }
    }

    /// The number of patches.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }
}
