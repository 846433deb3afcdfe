//! The program of trials, for worlds of every kind. `grid_world` and `house_trials` are its two names.

mod grid;
mod houses;
mod run;

pub use grid::GridWorlds;
pub use houses::Houses;
pub use run::main;

use crate::shards::Shard;
use anyhow::bail;
use calendar::Kind;
use clap::builder::TypedValueParser;
use clap::{Args, Parser};
use cli::flags::{folder, value_of};
use cli::program::one_of;
use cli::terminal::tell;
use evaluation::scenes::Displayed;
use evaluation::trials::{Experiment, TrialStrategy, TrialWorld};
use mapper::EstimatorChoice;
use run::ShardCommand;
use std::collections::BTreeSet;
use std::fmt::Debug;
use std::path::PathBuf;

/// The groups of options that do not change the results of an experiment.
const OUTPUT: &str = "Output";
const EXECUTION: &str = "Execution";

/// A kind of worlds: what is the default there, and the options that no other kind has.
pub trait TrialKind: Args + Clone + Debug {
    /// The worlds.
    type Spec: TrialWorld<Robot: Debug> + Displayed + Debug;

    /// The name of the program.
    const NAME: &str;
    /// The folder for all results.
    const OUT: &str;
    /// The explanation of `--world`.
    const WORLD: &str;
    /// The named worlds without `--world` and `--generate`.
    const NAMED: &[&str];
    /// The number of generated worlds without `--world` and `--generate`.
    const GENERATED: u64;
    /// The strategies.
    const STRATEGIES: [&str; 5];
    /// The estimators.
    const ESTIMATORS: &[&str];
    /// Commands, for the help.
    const EXAMPLES: &[&str];
    /// The trials of each combination.
    const TRIALS: &str;
    /// The maximum number of steps of local exploration.
    const MAX_STEPS: &str;

    /// Prints the shipped worlds.
    ///
    /// # Errors
    ///
    /// When the standard output cannot be written.
    fn list_worlds() -> anyhow::Result<()>;

    /// The world with a name, and warnings about it.
    ///
    /// # Errors
    ///
    /// When it cannot be loaded, or no trial can run in it.
    fn load(&self, name: &str) -> anyhow::Result<(Self::Spec, Vec<String>)>;

    /// An option that was given, and that changes only generated worlds.
    fn of_generated(&self) -> Option<&'static str> {
        None
    }

    /// The random world of a seed.
    fn generate(&self, seed: u64) -> Self::Spec;

    /// The length of a trial.
    fn length(&self) -> u64;

    /// The robot of all trials.
    fn robot(&self, max_steps: u32) -> <Self::Spec as TrialWorld>::Robot;

    /// The text of the file of a generated world.
    fn to_toml(world: &Self::Spec) -> Option<String>;
}

// The command line. A doc comment would be the first line of --help, instead of that of the kind.
#[expect(missing_docs)]
#[derive(Clone, Debug, Parser)]
#[command(name = K::NAME, version, max_term_width = 100, args_conflicts_with_subcommands = true, after_help = after_help::<K>())]
pub struct TrialArgs<K: TrialKind> {
    #[command(subcommand)]
    command: Option<ShardCommand>,

    #[arg(long, help = K::WORLD, value_name = "NAME|FILE", help_heading = "World")]
    world: Vec<String>,

    /// List the shipped worlds and exit
    #[arg(long, help_heading = "World")]
    list_worlds: bool,

    /// Generate N random worlds, from --seed on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000), allow_negative_numbers = true, help_heading = "World")]
    generate: Option<u64>,

    /// The strategy of the robot. Can be repeated
    #[arg(long, default_values = K::STRATEGIES, value_parser = strategies(), help_heading = "Comparison")]
    strategy: Vec<TrialStrategy>,

    /// The estimator of the rates of change: two-state-gaps is best for blocks, shared-prior for doors, people and robots. Can be
    /// repeated
    #[arg(long, default_values = K::ESTIMATORS.iter().copied(), value_parser = one_of(EstimatorChoice::all(), |it| (it.name(), None)), help_heading = "Comparison")]
    estimator: Vec<EstimatorChoice>,

    /// Trials of each combination, with seeds that count up from --seed
    #[arg(long, visible_alias = "seeds", default_value = K::TRIALS, value_parser = clap::value_parser!(u64).range(1..=100_000), allow_negative_numbers = true, help_heading = "Comparison")]
    trials: u64,

    #[command(flatten)]
    kind: K,

    /// The maximum number of steps of local exploration at a goal; 42 in the paper
    #[arg(long, value_name = "STEPS", default_value = K::MAX_STEPS, allow_negative_numbers = true, help_heading = "Comparison")]
    max_steps: u32,

    /// The seed of all random streams: equal seeds give equal results, on any number of threads
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, help_heading = "Comparison")]
    seed: u64,

    /// The number of threads [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true, help_heading = EXECUTION)]
    threads: Option<u16>,

    /// Run shard I of N: every N-th trial, into a file of its own in --out. Run shards 1/N to N/N on any machines, then
    /// `merge`. The file is there when the shard is complete
    #[arg(long, value_name = "I/N", conflicts_with = "save_worlds", help_heading = EXECUTION)]
    shard: Option<Shard>,

    /// The folder for all results
    #[arg(long, value_name = "DIR", default_value = K::OUT, value_parser = folder(), help_heading = OUTPUT)]
    out: PathBuf,

    /// Save the generated worlds as TOML files in the output folder
    #[arg(long, requires = "generate", help_heading = OUTPUT)]
    save_worlds: bool,

    /// Print only errors
    #[arg(long, short, help_heading = OUTPUT)]
    quiet: bool,
}

impl<K: TrialKind> TrialArgs<K> {
    /// The experiment that the arguments describe.
    fn experiment(&self) -> anyhow::Result<Experiment<K::Spec>> {
        Ok(Experiment {
            worlds: self.worlds()?,
            estimators: distinct(&self.estimator),
            strategies: distinct(&self.strategy),
            trials: self.trials,
            seed: self.seed,
            length: self.kind.length(),
            robot: self.kind.robot(self.max_steps),
        })
    }

    /// The named worlds, and after them the generated worlds.
    fn worlds(&self) -> anyhow::Result<Vec<K::Spec>> {
        let names: Vec<&str> = self.world.iter().map(String::as_str).collect();
        let (names, generated) = match (&names[..], self.generate) {
            ([], None) => (K::NAMED, K::GENERATED),
            (names, generated) => (names, generated.unwrap_or(0)),
        };
        if let Some(option) = self.kind.of_generated().filter(|_| generated == 0) {
            bail!(
                "{option} changes only generated worlds, and there is none: add --generate, or leave out {option}"
            );
        }
        let load = |name: &&str| self.load(name).map_err(|error| value_of("--world", error));
        let mut worlds = distinct(names).iter().map(load).collect::<anyhow::Result<Vec<_>>>()?;
        let seeds = (0..generated).map(|number| self.seed.wrapping_add(number));
        worlds.extend(seeds.map(|seed| self.kind.generate(seed)));
        let mut names = BTreeSet::new();
        if let Some(twin) = worlds.iter().map(K::Spec::name).find(|name| !names.insert(*name)) {
            bail!(
                "two worlds have the name `{twin}`: results are listed by name, so give each world its own name"
            );
        }
        Ok(worlds)
    }

    fn load(&self, name: &str) -> anyhow::Result<K::Spec> {
        let (world, warnings) = self.kind.load(name)?;
        warnings.iter().for_each(tell);
        Ok(world)
    }
}

fn after_help<K: TrialKind>() -> String {
    format!(
        "Examples:\n  {}\n\n\
         Large experiments run in shards, on one machine or on many (docs/clusters.md):\n  \
         {name} --trials 1000 --shard 1/3 --out big     # and 2/3 and 3/3, anywhere, at any time\n  \
         {name} merge big                               # the same files as without shards\n\n\
         Exit codes: 0 success, 1 the run failed, 2 invalid arguments or input, 130 interrupted (Ctrl-C; the \
         finished trials are reported).",
        K::EXAMPLES.join("\n  "),
        name = K::NAME,
    )
}

/// A parser of the name of a strategy, or of a reference.
fn strategies() -> impl TypedValueParser<Value = TrialStrategy> {
    one_of(TrialStrategy::all().collect(), |strategy| (strategy.name(), Some(strategy.description())))
}

/// Every value once, in the order of first occurrence.
fn distinct<T: PartialEq + Clone>(values: &[T]) -> Vec<T> {
    let mut distinct = Vec::new();
    for value in values {
        if !distinct.contains(value) {
            distinct.push(value.clone());
        }
    }
    distinct
}

/// The kinds of calendars.
fn one_of_kinds() -> impl TypedValueParser<Value = Kind> {
    one_of(Kind::ALL.map(|(_, kind)| kind).to_vec(), |kind| (kind.name(), None))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use evaluation::trials::PhysicsRobot;

    #[test]
    fn the_command_lines_are_sound() {
        TrialArgs::<GridWorlds>::command().debug_assert();
        TrialArgs::<Houses>::command().debug_assert();
        let args = TrialArgs::<Houses>::parse_from(["house_trials"]);
        assert_eq!(args.max_steps, PhysicsRobot::default().max_steps);
        assert_eq!(args.estimator, [robot::default_mapper().estimator]);
    }
}
