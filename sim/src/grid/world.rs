use super::ground_truth::GridGroundTruth;
use super::spec::{BlockSpec, Course, GridCalendar, GridSpec};
use super::visibility::LineOfSight;
use crate::routine::Routine;
use interfaces::{Cell, CellReading, Grid, Purpose, RandomStream, Step, World};
use nalgebra::Isometry2;

/// A grid world with one robot.
///
/// The same spec, seed and commands give the same bits, on every machine.
#[derive(Clone, Debug)]
pub struct GridWorld {
    spec: GridSpec,
    /// Steps since the start.
    step: u64,
    robot: Cell,
    /// The stream that decides whether an action of the robot happens.
    random: RandomStream,
    blocks: Vec<Block>,
    /// Walls and blocks as they are now, also in the middle of a step.
    blocked: Grid<bool>,
    line_of_sight: LineOfSight,
    truth: GridGroundTruth,
    /// The moves of the last step.
    moved: Vec<(Cell, Cell)>,
}

impl GridWorld {
    /// The world of `spec` at its start. `seed` seeds a random stream for every block and one for the robot.
    pub fn new(spec: &GridSpec, seed: u64) -> Self {
        let block =
            |(index, block)| Block::new(block, index, spec.block_probability, spec.calendar.as_ref(), seed);
        let blocks: Vec<Block> = spec.blocks.iter().enumerate().map(block).collect();
        let mut blocked = spec.walls.clone();
        for block in &blocks {
            blocked.set(block.cell(), true);
        }
        Self {
            step: 0,
            robot: spec.start,
            random: RandomStream::new(seed, Purpose::RobotTransition),
            moved: Vec::with_capacity(blocks.len()),
            blocks,
            blocked,
            line_of_sight: LineOfSight::new(spec.sensor_radius),
            truth: GridGroundTruth::new(spec),
            spec: spec.clone(),
        }
    }

    /// The time since the start, steps.
    pub fn time(&self) -> f64 {
        self.step as f64
    }

    /// The spec of the world.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// The cell of the robot.
    pub fn robot(&self) -> Cell {
        self.robot
    }

    /// The name and the cell of every block, in the order of the spec.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = (&str, Cell)> {
        self.spec.blocks.iter().zip(&self.blocks).map(|(spec, block)| (spec.name.as_str(), block.cell()))
    }

    /// The ground truth of every cell, for metrics only.
    pub fn truth(&self) -> &GridGroundTruth {
        &self.truth
    }
}

impl World for GridWorld {
    type Reading = CellReading;
    type Command = Step;

    /// The states of all cells of the map that are within the range of the sensor and in line of sight: first the
    /// cell of the robot, then the others by direction, counter-clockwise from the right, and from near to far. The
    /// heading is always 0. Readings have no randomness.
    fn sense(&mut self) -> CellReading {
        let center = self.spec.frame().center(self.robot);
        CellReading {
            time: self.step as f64,
            pose: Isometry2::translation(center.x, center.y),
            cells: self.line_of_sight.look(&self.blocked, self.robot),
        }
    }

    fn poses_are_exact(&self) -> bool {
        true
    }

    fn act(&mut self, command: &Step) {
        let target = command.target(self.robot);
        let is_obeyed = self.random.bernoulli(self.spec.robot_probability);
        if is_obeyed && self.blocked.get(target) == Some(&false) {
            self.robot = target;
        }
        self.moved.clear();
        let time_s = self.spec.calendar.map_or(0.0, |calendar| (self.step + 1) as f64 * calendar.step_s);
        for block in &mut self.blocks {
            let is_free = |cell: Cell| cell != self.robot && self.blocked.get(cell) == Some(&false);
            if let Some((from, to)) = block.step(time_s, is_free) {
                self.blocked.set(from, false);
                self.blocked.set(to, true);
                self.moved.push((from, to));
            }
        }
        self.step += 1;
        self.truth.update(&self.moved, |cell| self.blocked.get(cell) == Some(&true));
    }
}

/// A block and its state.
#[derive(Clone, Debug)]
pub(super) struct Block {
    spec: BlockSpec,
    /// The index of its cell in `path`.
    at: usize,
    /// Whether the index counts down. Never on a loop.
    is_returning: bool,
    /// Steps on this cell, up to `dwell`.
    stood: u32,
    /// The probability that a due move happens in a step.
    probability: f64,
    random: RandomStream,
    /// What it does by its schedule, if it has one.
    routine: Option<Box<Routine>>,
}

impl Block {
    pub(super) fn new(
        spec: &BlockSpec,
        index: usize,
        probability: f64,
        calendar: Option<&GridCalendar>,
        seed: u64,
    ) -> Self {
        let starts_s = calendar.map_or(0.0, |calendar| calendar.starts_s);
        let routine = spec.schedule.as_ref().map(|schedule| Routine::new(schedule, starts_s, 1, index, seed));
        Self {
            routine: routine.map(Box::new),
            spec: spec.clone(),
            at: spec.start(),
            is_returning: false,
            stood: spec.stood,
            probability,
            random: RandomStream::new(seed, Purpose::BlockTransition(index)),
        }
    }

    /// The cell of the block now.
    pub(super) fn cell(&self) -> Cell {
        self.spec.path[self.at]
    }

    /// Does one step, which ends at `time_s`, s in a world with a calendar. The block moves on if the move is due, happens and leads to a free cell. Returns the cells
    /// before and after a move.
    #[inline]
    pub(super) fn step(&mut self, time_s: f64, is_free: impl FnOnce(Cell) -> bool) -> Option<(Cell, Cell)> {
        if let Some(routine) = &mut self.routine {
            let last = self.spec.path.len() - 1;
            let next =
                if routine.is_blocked(time_s) { self.at.saturating_sub(1) } else { (self.at + 1).min(last) };
            let (from, to) = (self.cell(), self.spec.path[next]);
            return (to != from && is_free(to)).then(|| {
                self.at = next;
                (from, to)
            });
        }
        self.stood = (self.stood + 1).min(self.spec.dwell);
        if self.stood < self.spec.dwell || !self.random.bernoulli(self.probability) {
            return None;
        }
        let (next, is_returning) = self.next();
        let (from, to) = (self.cell(), self.spec.path[next]);
        is_free(to).then(|| {
            (self.at, self.is_returning, self.stood) = (next, is_returning, 0);
            (from, to)
        })
    }

    /// The index of the next cell, and whether the index counts down from then on.
    fn next(&self) -> (usize, bool) {
        let last = self.spec.path.len() - 1;
        match self.spec.course {
            Course::Loop if self.at == last => (0, false),
            Course::Loop => (self.at + 1, false),
            Course::BackAndForth if self.at == 0 => (1, false),
            Course::BackAndForth if self.at == last => (last - 1, true),
            Course::BackAndForth if self.is_returning => (self.at - 1, true),
            Course::BackAndForth => (self.at + 1, false),
        }
    }
}
