//! Robots that observe a grid world in different ways; their paths do not depend on a map.

use interfaces::{Cell, CellReading, Grid, Step};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use sim::grid::GridSpec;
use std::collections::VecDeque;

/// What a robot does at its goals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Habit {
    /// Continues to the next goal.
    Passes,
    /// Stays until nothing changed in view for some steps.
    Stays,
    /// Goes to the centroid of what changed in the last step, as in the paper's local exploration.
    Follows,
}

impl Habit {
    pub(crate) const ALL: [Self; 3] = [Self::Passes, Self::Stays, Self::Follows];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Passes => "passes by",
            Self::Stays => "stays while something moves",
            Self::Follows => "follows what moves",
        }
    }
}

/// The number of steps without a change after which a robot that stays continues, and the maximum stay.
const PATIENCE: u32 = 10;
const STAY: u32 = 300;
/// The maximum number of steps of following, and of consecutive random steps: the values of the controller.
const FOLLOWING: u32 = 42;
const RANDOM_STEPS: u32 = 1;
/// The number of steps without progress after which a goal is given up.
const STUCK: u32 = 20;

/// A robot that goes from one random goal to the next.
pub(crate) struct Robot {
    habit: Habit,
    walls: Grid<bool>,
    rng: ChaCha8Rng,
    /// The number of steps to the goal from every cell; `None` for walls.
    distance: Vec<Option<u32>>,
    goal: usize,
    /// The number of consecutive steps in which something blocked the way.
    stuck: u32,
    /// The number of steps at the goal, and of consecutive calm or random steps among them.
    at_goal: u32,
    calm: u32,
    seen: Vec<Option<bool>>,
}

impl Robot {
    pub(crate) fn new(spec: &GridSpec, habit: Habit, rng: ChaCha8Rng) -> Self {
        let walls = spec.walls.clone();
        let cells = walls.frame().len();
        let mut robot = Self {
            habit,
            walls,
            rng,
            distance: vec![None; cells],
            goal: 0,
            stuck: 0,
            at_goal: 0,
            calm: 0,
            seen: vec![None; cells],
        };
        robot.choose();
        robot
    }

    /// The next action, after `reading`.
    pub(crate) fn act(&mut self, reading: &CellReading) -> Step {
        let frame = *self.walls.frame();
        let at = |cell: Cell| frame.index(cell);
        let here = frame.cell_at(&reading.pose.translation.vector.into());
        let mut changed = Vec::new();
        for &(cell, blocked) in &reading.cells {
            let Some(index) = at(cell) else { continue };
            if self.seen[index].replace(blocked).is_some_and(|before| before != blocked) {
                changed.push(cell);
            }
        }
        let to_go = at(here).and_then(|index| self.distance[index]);
        if to_go != Some(0) && self.at_goal == 0 && self.stuck < STUCK {
            let nearer = Step::ALL.into_iter().find(|step| {
                let cell = step.target(here);
                at(cell).and_then(|index| self.distance[index]).is_some_and(|steps| Some(steps) < to_go)
                    && self.is_open(cell)
            });
            if let Some(nearer) = nearer {
                self.stuck = 0;
                return nearer;
            }
            // Something blocks the way: go around it.
            self.stuck += 1;
            self.measure();
            return Step::Stay;
        }
        self.at_goal += 1;
        self.calm = if changed.is_empty() { self.calm + 1 } else { 0 };
        match self.habit {
            Habit::Stays if self.calm < PATIENCE && self.at_goal < STAY => Step::Stay,
            Habit::Follows if self.at_goal <= FOLLOWING && self.calm <= RANDOM_STEPS => {
                self.follow(here, &changed)
            }
            _ => {
                self.choose();
                Step::Stay
            }
        }
    }

    /// A step toward the centroid of what changed; a random step if nothing changed.
    fn follow(&mut self, here: Cell, changed: &[Cell]) -> Step {
        let is_open = |step: &&Step| self.is_open(step.target(here));
        let open: Vec<Step> = Step::ALL[1..].iter().filter(is_open).copied().collect();
        if changed.is_empty() {
            let pick = self.rng.random_range(0..open.len().max(1));
            return open.get(pick).copied().unwrap_or(Step::Stay);
        }
        let middle = |of: fn(&Cell) -> i32| {
            changed.iter().map(|cell| f64::from(of(cell))).sum::<f64>() / changed.len() as f64
        };
        let (x, y) = (middle(|cell| cell.x), middle(|cell| cell.y));
        let far = |step: &Step| {
            let cell = step.target(here);
            (f64::from(cell.x) - x).abs() + (f64::from(cell.y) - y).abs()
        };
        let best = open.into_iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        best.filter(|step| far(step) < far(&Step::Stay)).unwrap_or(Step::Stay)
    }

    /// Whether the cell is not known to be blocked.
    fn is_open(&self, cell: Cell) -> bool {
        self.walls.frame().index(cell).is_some_and(|index| self.seen[index] != Some(true))
    }

    /// Draws a goal, and computes the distance to it from every cell.
    fn choose(&mut self) {
        let frame = *self.walls.frame();
        self.goal = loop {
            let index = self.rng.random_range(0..frame.len());
            if !self.walls.cells()[index] {
                break index;
            }
        };
        self.measure();
        (self.stuck, self.at_goal, self.calm) = (0, 0, 0);
    }

    /// Computes the distance to the goal from every cell, around cells that are known to be blocked.
    fn measure(&mut self) {
        let frame = *self.walls.frame();
        self.distance.fill(None);
        self.distance[self.goal] = Some(0);
        let mut open = VecDeque::from([self.goal]);
        while let Some(index) = open.pop_front() {
            let next = self.distance[index].map(|steps| steps + 1);
            for side in frame.cell(index).neighbours4() {
                if let Some(side) = frame.index(side)
                    && !self.walls.cells()[side]
                    && self.seen[side] != Some(true)
                    && self.distance[side].is_none()
                {
                    self.distance[side] = next;
                    open.push_back(side);
                }
            }
        }
    }
}
