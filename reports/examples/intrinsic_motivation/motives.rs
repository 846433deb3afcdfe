//! Intrinsic rewards: what a learner is paid for one reading.

use crate::distillation::Distillation;
use crate::forward_model::ForwardModel;
use crate::view::View;
use interfaces::{GridFrame, RandomStream};
use std::collections::VecDeque;

/// The side of a region of learning progress, cells: a patch of the paper.
pub(crate) const REGION_CELLS: usize = 5;
/// The readings of a region in each of the two windows whose mean errors learning progress compares.
const WINDOW: usize = 25;

/// The names of all motives. The others after the first [`INTRINSIC`] are references: the reward of the paper's learner, a reward
/// that no robot has, no reward, and (without any learning) random choices.
pub(crate) const MOTIVES: [&str; 9] =
    ["visits", "views", "distillation", "surprise", "progress", "updates", "error", "nothing", RANDOM];
/// The number of intrinsic motives.
pub(crate) const INTRINSIC: usize = 5;
/// The learner over goals that chooses at random.
pub(crate) const RANDOM: &str = "random";

/// An intrinsic reward. It begins anew in every world.
pub(crate) trait Motive: std::fmt::Debug + Send {
    /// The reward for a reading; the motive learns from the reading.
    fn reward(&mut self, view: &View) -> f64;
}

/// The motive with a name from [`MOTIVES`], in a world with this frame; none of these: no reward at all.
pub(crate) fn motive(name: &str, frame: GridFrame, rng: &mut RandomStream) -> Box<dyn Motive> {
    match name {
        "visits" => Box::new(Visits(vec![0.0; frame.len()])),
        "views" => Box::new(Views(vec![0.0; frame.len()])),
        "distillation" => Box::new(Distillation::new(rng)),
        "surprise" => Box::new(Surprise(ForwardModel::new(frame.len()))),
        "progress" => Box::new(Progress::new(frame)),
        "updates" => Box::new(Updates),
        "error" => Box::new(ErrorFall(None)),
        _ => Box::new(Nothing),
    }
}

/// 1/√n with n the number of times that the robot was in its cell (count-based exploration).
#[derive(Debug)]
pub(crate) struct Visits(pub(crate) Vec<f64>);

impl Motive for Visits {
    fn reward(&mut self, view: &View) -> f64 {
        view.frame.index(view.robot).map_or(0.0, |cell| count(&mut self.0[cell]))
    }
}

/// The same for all cells in view, summed: n is the number of readings that showed a cell.
#[derive(Debug)]
struct Views(Vec<f64>);

impl Motive for Views {
    fn reward(&mut self, view: &View) -> f64 {
        view.cells.iter().map(|&(cell, _)| count(&mut self.0[cell])).sum()
    }
}

fn count(number: &mut f64) -> f64 {
    *number += 1.0;
    1.0 / number.sqrt()
}

/// The squared error of the forward model, summed over the cells in view: surprise.
#[derive(Debug)]
pub(crate) struct Surprise(pub(crate) ForwardModel);

impl Motive for Surprise {
    fn reward(&mut self, view: &View) -> f64 {
        view.cells.iter().map(|&(cell, is_blocked)| self.0.learn(cell, is_blocked, view.time)).sum()
    }
}

/// Learning progress: per region, the fall of the forward model's error from one window of readings to the next.
#[derive(Debug)]
pub(crate) struct Progress {
    model: ForwardModel,
    columns: usize,
    /// The latest errors of each region: means over its cells in view.
    errors: Vec<VecDeque<f64>>,
    /// The sum of the errors and the number of cells of each region in the present reading.
    now: Vec<(f64, f64)>,
    /// The regions in the present reading.
    seen: Vec<usize>,
}

impl Progress {
    pub(crate) fn new(frame: GridFrame) -> Self {
        let columns = frame.width().div_ceil(REGION_CELLS);
        let count = columns * frame.height().div_ceil(REGION_CELLS);
        let (errors, now) = (vec![VecDeque::new(); count], vec![(0.0, 0.0); count]);
        Self { model: ForwardModel::new(frame.len()), columns, errors, now, seen: Vec::new() }
    }
}

impl Motive for Progress {
    /// The fall, 0 where the error rises, times the region's cells in view, summed over the regions.
    fn reward(&mut self, view: &View) -> f64 {
        let width = view.frame.width();
        for &(cell, is_blocked) in &view.cells {
            let region = cell / width / REGION_CELLS * self.columns + cell % width / REGION_CELLS;
            let now = &mut self.now[region];
            if now.1 == 0.0 {
                self.seen.push(region);
            }
            *now = (now.0 + self.model.learn(cell, is_blocked, view.time), now.1 + 1.0);
        }
        let mut reward = 0.0;
        for region in self.seen.drain(..) {
            let (sum, cells) = std::mem::take(&mut self.now[region]);
            let errors = &mut self.errors[region];
            errors.push_back(sum / cells);
            if errors.len() > 2 * WINDOW {
                errors.pop_front();
            }
            reward += fall(errors).max(0.0) * cells;
        }
        reward
    }
}

/// The mean of the earlier half minus the mean of the later half; 0 of fewer than two errors.
fn fall(errors: &VecDeque<f64>) -> f64 {
    let half = errors.len() / 2;
    if half == 0 {
        return 0.0;
    }
    let mean = |errors: &mut dyn Iterator<Item = &f64>| errors.sum::<f64>() / half as f64;
    mean(&mut errors.iter().take(half)) - mean(&mut errors.iter().rev().take(half))
}

/// Map updates, the reward of the paper's learner: a reference.
#[derive(Debug)]
struct Updates;

impl Motive for Updates {
    fn reward(&mut self, view: &View) -> f64 {
        view.updates as f64
    }
}

/// The fall of the true log error of the rates: a reference, no robot has this reward.
#[derive(Debug)]
struct ErrorFall(Option<f64>);

impl Motive for ErrorFall {
    fn reward(&mut self, view: &View) -> f64 {
        let before = std::mem::replace(&mut self.0, view.true_error);
        before.zip(view.true_error).map_or(0.0, |(before, now)| before - now)
    }
}

/// No reward.
#[derive(Debug)]
struct Nothing;

impl Motive for Nothing {
    fn reward(&mut self, _: &View) -> f64 {
        0.0
    }
}

/// Divides rewards by their root mean square so far, so that one step size fits all motives (Burda et al. 2018 divide by
/// the deviation of returns).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Scale {
    squares: f64,
    count: f64,
}

impl Scale {
    pub(crate) fn scaled(&mut self, reward: f64) -> f64 {
        self.squares += reward * reward;
        self.count += 1.0;
        let mean = self.squares / self.count;
        if mean > 0.0 { reward / mean.sqrt() } else { 0.0 }
    }
}
