use super::block::Block;
use super::luck::{Luck, Whose};
use super::sight::{BlockedCells, Sight};
use super::spec::GridSpec;
use super::truth::GridTruth;
use interfaces::{Cell, CellReading, Step, World};
use nalgebra::Isometry2;

/// A grid in which a robot steps and looks around.
///
/// The same spec, seed and commands give the same bits, on every machine.
#[derive(Clone, Debug)]
pub struct GridWorld {
    spec: GridSpec,
    /// Steps since the start.
    step: u64,
    robot: Cell,
    robot_luck: Luck,
    blocks: Vec<Block>,
    /// Walls and blocks as they are now, also in the middle of a step.
    blocked: BlockedCells,
    sight: Sight,
    truth: GridTruth,
    /// The moves of the last step.
    moved: Vec<(Cell, Cell)>,
}

impl GridWorld {
    /// The world of `spec` at its start. `seed` starts all chance, in a stream for every block
    /// and one for the robot.
    pub fn new(spec: &GridSpec, seed: u64) -> Self {
        let block = |(index, block)| Block::new(block, index, spec.block_probability, seed);
        let blocks: Vec<Block> = spec.blocks.iter().enumerate().map(block).collect();
        let mut blocked = BlockedCells::new(&spec.walls, spec.sensor_radius);
        for block in &blocks {
            blocked.set(block.cell(), true);
        }
        Self {
            step: 0,
            robot: spec.start,
            robot_luck: Luck::new(seed, Whose::Robot, spec.robot_probability),
            moved: Vec::with_capacity(blocks.len()),
            blocks,
            blocked,
            sight: Sight::new(spec.sensor_radius),
            truth: GridTruth::new(spec),
            spec: spec.clone(),
        }
    }

    /// The time since the start, steps.
    pub fn time(&self) -> f64 {
        self.step as f64
    }

    /// What the world was made from.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// Where the robot is.
    pub fn robot(&self) -> Cell {
        self.robot
    }

    /// The name and the cell of every block, in the order of the file.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = (&str, Cell)> {
        self.spec.blocks.iter().zip(&self.blocks).map(|(spec, block)| (spec.name.as_str(), block.cell()))
    }

    /// The truth about every cell, for metrics only.
    pub fn truth(&self) -> &GridTruth {
        &self.truth
    }
}

impl World for GridWorld {
    type Reading = CellReading;
    type Command = Step;

    /// Every cell of the map within the sensor's radius and in line of sight: the robot's own, then
    /// the others by direction counter-clockwise from the right and from near to far. The robot's
    /// heading is always 0. No reading depends on chance.
    fn sense(&mut self) -> CellReading {
        let middle = self.spec.frame().center(self.robot);
        CellReading {
            time: self.step as f64,
            pose: Isometry2::translation(middle.x, middle.y),
            cells: self.sight.look(&self.blocked, self.robot),
        }
    }

    fn act(&mut self, command: &Step) {
        let target = command.target(self.robot);
        let is_obeyed = self.robot_luck.happens();
        if is_obeyed && self.spec.frame().contains(target) && !self.blocked.get(target) {
            self.robot = target;
        }
        self.moved.clear();
        for block in &mut self.blocks {
            let is_free = |cell: Cell| cell != self.robot && !self.blocked.get(cell);
            if let Some((from, to)) = block.step(is_free) {
                self.blocked.set(from, false);
                self.blocked.set(to, true);
                self.moved.push((from, to));
            }
        }
        self.step += 1;
        self.truth.settle(&self.moved, |cell| self.blocked.get(cell));
    }
}
