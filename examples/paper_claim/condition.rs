//! The conditions: each differs from the paper's condition in one setting.

use curious::worlds::{SHIPPED_GRID, load_grid};
use evaluation::trials::{Experiment, GridRobot, TrialSettings, TrialStrategy};
use mapper::{EstimatorChoice, Paper, PaperAll};
use reports::{Report, ReportSettings};
use sim::grid::{GenerateSettings, GridSpec};
use std::sync::atomic::AtomicBool;

/// The name of the condition from which the others differ in one setting.
pub(crate) const BASE: &str = "the paper's";

/// The strategies of the claim, and two baselines.
const STRATEGIES: [&str; 5] = ["curious", "recency", "poisson", "random", "coin"];

/// All settings that conditions can change.
#[derive(Clone, Debug)]
pub(crate) struct Condition {
    pub(crate) name: String,
    sensor_radius: u32,
    steps: u64,
    estimator: EstimatorChoice,
    /// The probability of a move of a block or of the robot.
    chance: f64,
    /// The maximum number of steps of local exploration.
    max_steps: u32,
}

/// The base, then the conditions that differ from it in one setting.
pub(crate) fn conditions() -> Vec<Condition> {
    let base = Condition {
        name: BASE.to_owned(),
        sensor_radius: 4,
        steps: 20_000,
        estimator: Paper.into(),
        chance: 1.0,
        max_steps: 42,
    };
    let change = |name: String, what: &dyn Fn(&mut Condition)| {
        let mut condition = Condition { name, ..base.clone() };
        what(&mut condition);
        condition
    };
    let mut conditions = vec![base.clone()];
    for radius in [3, 5, 6, 7, 8] {
        conditions.push(change(format!("sensor radius {radius}"), &|other| other.sensor_radius = radius));
    }
    for (steps, name) in [(2_000, "2,000 steps"), (5_000, "5,000 steps"), (50_000, "50,000 steps")] {
        conditions.push(change(name.to_owned(), &|other| other.steps = steps));
    }
    conditions.push(change("estimator paper-all".to_owned(), &|other| other.estimator = PaperAll.into()));
    let best = EstimatorChoice::default();
    conditions.push(change(format!("estimator {}", best.name()), &|other| other.estimator = best.clone()));
    conditions.push(change("stochastic moves (0.8)".to_owned(), &|other| other.chance = 0.8));
    for bound in [1, 10, 100] {
        conditions.push(change(format!("max_steps {bound}"), &|other| other.max_steps = bound));
    }
    conditions
}

/// The shipped worlds.
pub(crate) fn shipped() -> Vec<GridSpec> {
    let load = |(name, _): &(&str, &str)| load_grid(name).expect("a shipped world is valid");
    SHIPPED_GRID.iter().map(load).collect()
}

impl Condition {
    /// Runs all trials: `seeds` in each shipped world, and one in each of `seeds` generated worlds.
    pub(crate) fn run(&self, seeds: u64) -> anyhow::Result<(Report, Report)> {
        let generate = |number| GridSpec::generate(&GenerateSettings::default(), number);
        let generated = self.experiment((0..seeds).map(generate).collect(), 1);
        // Every generated world has its own seed.
        let mut jobs = generated.jobs();
        for (jobs, seed) in jobs.chunks_mut(STRATEGIES.len()).zip(0..) {
            jobs.iter_mut().for_each(|job| job.seed = seed);
        }
        let shipped = self.experiment(shipped(), seeds);
        Ok((report(&shipped, shipped.jobs())?, report(&generated, jobs)?))
    }

    fn experiment(&self, worlds: Vec<GridSpec>, trials: u64) -> Experiment<GridSpec> {
        let set = |world: GridSpec| {
            world.with_sensor_radius(self.sensor_radius).with_probabilities(self.chance, self.chance)
        };
        Experiment {
            worlds: worlds.into_iter().map(set).collect(),
            estimators: vec![self.estimator.clone()],
            strategies: STRATEGIES
                .map(|name| TrialStrategy::Agent(name.parse().expect("a built-in policy")))
                .to_vec(),
            trials,
            seed: 0,
            length: self.steps,
            robot: GridRobot { max_steps: self.max_steps },
        }
    }
}

fn report(experiment: &Experiment<GridSpec>, jobs: Vec<TrialSettings<GridSpec>>) -> anyhow::Result<Report> {
    let trials = experiment.run(jobs, &AtomicBool::new(false), |_| ())?;
    let version = env!("CARGO_PKG_VERSION").to_owned();
    let settings = ReportSettings { version, ..ReportSettings::of(experiment) };
    Ok(Report::new(settings, trials))
}
