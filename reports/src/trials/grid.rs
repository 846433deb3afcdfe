//! Trials in grid worlds: `grid_world`.

use super::{TrialKind, one_of_kinds};
use calendar::Kind;
use clap::Args;
use cli::program::list;
use curious::worlds::{SHIPPED_GRID, load_grid};
use evaluation::trials::GridRobot;
use sim::grid::{GenerateSettings, GridSpec};

/// Compares exploration strategies in grid worlds with moving blocks: the paper's Figure 3, with statistics.
///
/// Without options, the paper's learner (curious) is compared in the paper's world with each of its strategies
/// alone (recency, poisson) and with two baselines (random, coin), in five trials of 20,000 steps each. The
/// folder grid_world_out contains the results: the curves (figure3.svg, figure3.png), every number
/// (report.json), and every trial (trials.csv). The table at the end shows which strategy learned the rates of
/// change best, and whether the difference is significant.
///
/// Options that can be repeated multiply: 2 worlds, 2 estimators, 3 strategies and 10 trials are 120 trials in
/// total.
#[derive(Clone, Debug, Args)]
pub struct GridWorlds {
    /// Give the worlds of --generate a calendar of this kind: doors, boxes and people by hours and weekdays, from Monday 0:00 on. A step
    /// is 10 s: a week has 60,480 steps
    #[arg(long, value_name = "KIND", value_parser = one_of_kinds(), requires = "generate", help_heading = "World")]
    calendar: Option<Kind>,

    /// The range of the sensor, in cells, instead of the range in the world file
    #[arg(long, value_name = "CELLS", value_parser = clap::value_parser!(u32).range(1..=100), allow_negative_numbers = true, help_heading = "World")]
    sensor_radius: Option<u32>,

    /// The probability of every move of the robot and of a block without a schedule, instead of the
    /// probabilities in the world file; 0.8 without a number
    #[arg(long, value_name = "PROBABILITY", num_args = 0..=1, default_missing_value = "0.8", value_parser = probability, help_heading = "World")]
    stochastic: Option<f64>,

    /// Steps of each trial
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000), allow_negative_numbers = true, help_heading = "Comparison")]
    steps: u64,
}

impl TrialKind for GridWorlds {
    type Spec = GridSpec;

    const NAME: &str = "grid_world";
    const OUT: &str = "grid_world_out";
    const WORLD: &str = "A world: the name of a shipped world (see --list-worlds), or a TOML file. Can be repeated \
                         [default: two_blocks, unless --generate is given]";
    const NAMED: &[&str] = &["two_blocks"];
    const GENERATED: u64 = 0;
    const STRATEGIES: [&str; 5] = ["curious", "recency", "poisson", "random", "coin"];
    const ESTIMATORS: &[&str] = &["paper", "two-state-gaps"];
    const EXAMPLES: &[&str] = &[
        "grid_world --trials 100                                  more trials, smaller intervals",
        "grid_world --generate 50 --trials 2 --strategy curious --strategy information-gain",
        "grid_world --generate 10 --calendar office --steps 60480 --strategy curious --strategy fresh-map",
        "grid_world --world my_world.toml --sensor-radius 6",
    ];
    const TRIALS: &str = "5";
    const MAX_STEPS: &str = "42";

    fn list_worlds() -> anyhow::Result<()> {
        list(&SHIPPED_GRID, 20, |name| load_grid(name).map(|spec| spec.description))
    }

    fn load(&self, name: &str) -> anyhow::Result<(GridSpec, Vec<String>)> {
        let world = load_grid(name)?;
        let warning = |warning| format!("warning: {}: {warning}", world.name);
        let warnings = world.warnings().into_iter().map(warning).collect();
        Ok((self.changed(world), warnings))
    }

    fn generate(&self, seed: u64) -> GridSpec {
        self.changed(match self.calendar {
            Some(kind) => GridSpec::generate_calendar(kind, seed),
            None => GridSpec::generate(&GenerateSettings::default(), seed),
        })
    }

    fn length(&self) -> u64 {
        self.steps
    }

    fn robot(&self, max_steps: u32) -> GridRobot {
        GridRobot { max_steps }
    }

    fn to_toml(world: &GridSpec) -> Option<String> {
        Some(worldfile::grid::to_toml(world))
    }
}

impl GridWorlds {
    /// The world with the changes that the arguments ask for.
    fn changed(&self, mut world: GridSpec) -> GridSpec {
        if let Some(radius) = self.sensor_radius {
            world = world.with_sensor_radius(radius);
        }
        if let Some(probability) = self.stochastic {
            world = world.with_probabilities(probability, probability);
        }
        world
    }
}

fn probability(text: &str) -> Result<f64, String> {
    let probability = text.parse::<f64>().unwrap_or(f64::NAN);
    if probability > 0.0 && probability <= 1.0 {
        Ok(probability)
    } else {
        Err("must be above 0, and at most 1".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_checked() {
        assert_eq!(probability("0.5"), Ok(0.5));
        for wrong in ["", "0", "-1", "1.1", "nan", "inf", "often"] {
            assert!(probability(wrong).is_err(), "{wrong}");
        }
    }
}
