//! Trials: every strategy with every estimator in every world, repeated with other seeds, in grid worlds or in
//! physics worlds.
//!
//! Trials with the same world and seed are paired: the random streams of the world do not depend on the robot. A
//! trial depends only on its own settings, so that the results are the same with any number of threads.

mod grid;
mod metric;
mod physics;
mod run;
#[cfg(test)]
mod tests;

pub use grid::GridRobot;
pub use metric::{Metric, Sample, Trial};
pub use physics::PhysicsRobot;
pub use run::run_trial;

use crate::physics_trial::UnsupportedDrive;
use agent::{Agent, Policy};
use controller::{Controller, Drive};
use interfaces::{GroundTruth, Reading, SettingsError, World};
use mapper::{EstimatorChoice, ReadingError};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use results::numbers::thousands;
use robot::{Autonomous, GoalSelector, Robot};
use serde::Serialize;
use sim::physics::PhysicsWorld;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// The trials of a comparison.
#[derive(Clone, Debug)]
pub struct Experiment<W: TrialWorld> {
    /// The worlds.
    pub worlds: Vec<W>,
    /// The estimators of rates.
    pub estimators: Vec<EstimatorChoice>,
    /// The strategies.
    pub strategies: Vec<TrialStrategy>,
    /// The number of trials of each combination.
    pub trials: u64,
    /// The seed of the first trial; each further trial has the next seed.
    pub seed: u64,
    /// The length of each trial: steps in a grid world, s in a physics world; at least one.
    pub length: u64,
    /// The settings of the robot.
    pub robot: W::Robot,
}

/// The error for a trial that cannot run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrialError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The controller cannot drive the robot of a physics world.
    #[error(transparent)]
    Drive(#[from] UnsupportedDrive),
    /// The mapper refuses a reading.
    #[error(transparent)]
    Reading(#[from] ReadingError),
}

impl<W: TrialWorld> Experiment<W> {
    /// All trials. Trials that are compared with each other are consecutive, so that after an interruption the
    /// finished trials can be compared.
    pub fn jobs(&self) -> Vec<TrialSettings<'_, W>> {
        let mut seeds: Vec<u64> = (0..self.trials).map(|trial| self.seed.wrapping_add(trial)).collect();
        seeds.sort_unstable();
        let strategies = |world, estimator| self.strategies.iter().map(move |it| (world, estimator, it));
        let estimators = |world| self.estimators.iter().flat_map(move |it| strategies(world, it));
        let mut jobs = Vec::new();
        for (trial, seed) in (1..).zip(seeds) {
            let groups = (0..).zip(self.worlds.iter().flat_map(estimators));
            jobs.extend(groups.map(|(group, (world, estimator, strategy))| {
                let number = group * self.trials + trial;
                TrialSettings { number, world, estimator, strategy, seed, experiment: self }
            }));
        }
        jobs
    }

    /// Runs trials on the threads of the present rayon pool. The results are in the order of `jobs`. `observe` is
    /// called with every finished trial, from any thread. If `is_canceled` is set, unfinished trials are left out.
    ///
    /// # Errors
    ///
    /// When a trial cannot run.
    pub fn run(
        &self,
        jobs: Vec<TrialSettings<W>>,
        is_canceled: &AtomicBool,
        observe: impl Fn(&Trial) + Sync,
    ) -> Result<Vec<Trial>, TrialError> {
        let goes_on = || !is_canceled.load(Ordering::Relaxed);
        let run = |job: TrialSettings<W>| -> Result<Option<Trial>, TrialError> {
            if !goes_on() {
                return Ok(None);
            }
            let trial = run_trial(&job, goes_on)?;
            Ok(trial.inspect(&observe))
        };
        let trials: Result<Vec<Option<Trial>>, TrialError> = jobs.into_par_iter().map(run).collect();
        Ok(trials?.into_iter().flatten().collect())
    }
}

/// The length of a trial, in the unit of the times of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Length {
    /// In a grid world.
    Grid {
        /// The number of steps.
        steps: u64,
    },
    /// In a physics world.
    Physics {
        /// The simulated time, s.
        duration_s: u64,
    },
}

impl Default for Length {
    fn default() -> Self {
        Self::Grid { steps: 0 }
    }
}

impl Length {
    /// One of two, for grid worlds and for physics worlds.
    pub fn choose<T>(self, grid: T, physics: T) -> T {
        match self {
            Self::Grid { .. } => grid,
            Self::Physics { .. } => physics,
        }
    }

    /// The name of the column of times in `trials.csv`.
    pub fn column(self) -> &'static str {
        self.choose("step", "time_s")
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Grid { steps } => write!(f, "{} steps", thousands(steps)),
            Self::Physics { duration_s: 60 } => f.write_str("1 simulated minute"),
            Self::Physics { duration_s } if duration_s % 60 == 0 => {
                write!(f, "{} simulated minutes", thousands(duration_s / 60))
            }
            Self::Physics { duration_s } => write!(f, "{} simulated seconds", thousands(duration_s)),
        }
    }
}

/// How the robot of a trial selects its goals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TrialStrategy {
    /// By an agent with this policy.
    Agent(Policy),
    /// Not at all: the robot stays where it starts, but observes the true state of every cell at every reading. A
    /// reference: it has the errors of the estimator alone.
    FullObservation,
}

impl TrialStrategy {
    /// All strategies.
    pub fn all() -> impl Iterator<Item = Self> {
        Policy::built_in().iter().cloned().map(Self::Agent).chain([Self::FullObservation])
    }

    /// The name on the command line and in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Agent(policy) => policy.name(),
            Self::FullObservation => "full-observation",
        }
    }

    /// The description in lists: where the robot goes, in one line.
    pub fn description(&self) -> &'static str {
        match self {
            Self::Agent(policy) => policy.description(),
            Self::FullObservation => "nowhere: it sees every cell all the time, the bound of the estimator",
        }
    }
}

/// Everything that determines a trial.
pub struct TrialSettings<'a, W: TrialWorld> {
    /// The number of the trial in the experiment, from 1 on, in the order of a report: by world, estimator, strategy
    /// and seed.
    pub number: u64,
    /// The world.
    pub world: &'a W,
    /// The estimator of rates.
    pub estimator: &'a EstimatorChoice,
    /// The strategy that chooses goals.
    pub strategy: &'a TrialStrategy,
    /// The seed of all random streams.
    pub seed: u64,
    /// The other settings.
    pub experiment: &'a Experiment<W>,
}

/// The specification of a world in which trials run, of one kind.
pub trait TrialWorld: Sized + Sync {
    /// The simulated world.
    type World: World<Reading: Reading + Clone, Command: Clone>;
    /// The ground truth of the simulated world.
    type Truth: GroundTruth;
    /// The settings of the robot that are the same in all worlds.
    type Robot: Sync;
    /// The drive of the robot.
    type Drive: Drive<Command = <Self::World as World>::Command>;

    /// Whether a changing cell is in view is checked once in this number of readings.
    const VIEW_EVERY: usize;
    /// The swept cells are compared with the map once in this number of readings, and at every sample.
    const COMPARE_EVERY: usize;

    /// The name of the world.
    fn name(&self) -> &str;

    /// The length of a trial, from a number of steps or seconds.
    fn length(length: u64) -> Length;

    /// The range of the sensor of a grid world, in cells.
    fn sensor_radius(&self) -> Option<u32> {
        None
    }

    /// The world in the frame of the robot's own map; `None` if the robot knows the frame of the world.
    fn in_own_frame(&self, _: &Self::Robot, _seed: u64) -> Option<Self> {
        None
    }

    /// The world at its start.
    fn start(&self, seed: u64) -> Self::World;

    /// The ground truth of a world.
    fn truth(world: &Self::World) -> &Self::Truth;

    /// The world if it is a physics world: its robots can collide, and its things come and go.
    fn physics(_world: &Self::World) -> Option<&PhysicsWorld> {
        None
    }

    /// The agent that follows `policy`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    fn agent(trial: &TrialSettings<Self>, policy: &Policy) -> Result<Agent, TrialError>;
    /// The robot at its start in a world, whose pilot drives to the goals of `selector`.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    fn robot<G: GoalSelector>(
        trial: &TrialSettings<Self>,
        world: &mut Self::World,
        selector: G,
    ) -> Result<TrialRobot<Self, G>, TrialError>;
}

/// The robot of a trial, with what chooses its goals.
pub type TrialRobot<W, G> =
    Robot<<<W as TrialWorld>::World as World>::Reading, Autonomous<G, Controller<<W as TrialWorld>::Drive>>>;
