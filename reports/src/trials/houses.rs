//! Trials in houses and other physics worlds: `house_trials`.

use super::{TrialKind, one_of_kinds};
use anyhow::Context;
use calendar::Kind;
use clap::Args;
use cli::program::{duration_s, one_of, pose_in_world};
use curious::worlds::{Loaded, list_physics_worlds, load};
use evaluation::physics_trial;
use evaluation::trials::PhysicsRobot;
use interfaces::PoseMode;
use sim::physics::WorldSpec;

/// Compares exploration strategies in houses with doors, people and furniture: physics worlds, with statistics.
///
/// Without options, five strategies are compared in eight generated houses, for 20 simulated minutes each: about four
/// minutes on two cores. The folder house_trials_out contains the results: the curves of all worlds together (curves.svg, curves.png)
/// and of each (curves-house-0.svg, ...; at most eight), every number (report.json), and every trial (trials.csv). The
/// table at the end shows which strategy learned the rates of change best, and whether the difference is significant. With
/// one trial per house, the houses are the sample: over 200 of them, the 95 % interval of a difference was ± 2 % of the error, so
/// that it is about ± 3 % over 100, and ± 12 % over eight.
///
/// The reference full-observation sees every cell all the time: it shows how far a strategy can get.
///
/// --generate makes houses, or with `--kind office` offices: larger, with more rooms, more people, and doors that stay for
/// minutes; or with `--kind rooms` rooms in which things come and go (`rooms-day`: with stays of up to 12 h, for runs of a day). One
/// of them alone is a world by its name: `--world house-7`, `--world office-7`, `--world rooms-7`.
///
/// Options that can be repeated multiply: 2 worlds, 2 estimators, 3 strategies and 10 trials are 120 trials in
/// total.
#[derive(Clone, Debug, Args)]
pub struct Houses {
    /// The simulated time of each trial: whole seconds, or with a unit as in 90s, 20m, 1h
    #[arg(long, value_name = "TIME", default_value = "20m", value_parser = whole_s, allow_negative_numbers = true, help_heading = "Comparison")]
    duration: u64,

    /// The kind of the buildings of --generate
    #[arg(long, value_name = "KIND", default_value = "house", value_parser = ["house", "office", "rooms", "rooms-day"], help_heading = "World")]
    kind: String,

    /// Give the buildings of --generate a calendar of this kind: doors and boxes by hours and weekdays, from Monday 0:00 on.
    /// One of them alone is a world by its name: `--world calendar-office-7`. In trials the robot has no battery: it drives all the
    /// time
    #[arg(long, value_name = "KIND", value_parser = one_of_kinds(), conflicts_with = "kind", help_heading = "World")]
    calendar: Option<Kind>,

    /// How the robot knows its pose [default: exact where the world's odometry is exact, otherwise localized]
    #[arg(long, value_parser = one_of(PoseMode::LIVE.to_vec(), pose_in_world), help_heading = "Comparison")]
    pose: Option<PoseMode>,

    /// Look into unseen space before asking the strategy, as the robot of four_rooms does; else the strategy chooses every goal
    #[arg(long, help_heading = "Comparison")]
    unseen_first: bool,
}

impl TrialKind for Houses {
    type Spec = WorldSpec;

    const NAME: &str = "house_trials";
    const OUT: &str = "house_trials_out";
    const WORLD: &str = "A world: the name of a shipped world (see --list-worlds), a TOML file, or a Stage file \
                         (.world). Can be repeated [default: eight generated houses, unless --generate is given]";
    const NAMED: &[&str] = &[];
    const GENERATED: u64 = 8;
    const STRATEGIES: [&str; 5] = ["curious", "recency", "poisson", "random", "information-gain"];
    const ESTIMATORS: &[&str] = &["shared-prior"];
    const EXAMPLES: &[&str] = &[
        "house_trials --generate 20 --strategy curious --strategy information-gain",
        "house_trials --world house --world office --trials 3 --duration 1h",
        "house_trials --generate 2 --seed 7 --duration 60s --save-worlds",
    ];
    const TRIALS: &str = "1";
    const MAX_STEPS: &str = "15";

    fn list_worlds() -> anyhow::Result<()> {
        list_physics_worlds()
    }

    fn load(&self, name: &str) -> anyhow::Result<(WorldSpec, Vec<String>)> {
        let Loaded { spec, warnings } = load(name)?;
        physics_trial::source(&spec).with_context(|| format!("cannot run `{name}`"))?;
        let patrol = spec.driven().patrol.is_some().then(|| {
            format!(
                "note: the robot of `{}` has a battery and a dock, which trials leave out: it drives all the time. `four_rooms` keeps them",
                spec.name
            )
        });
        Ok((spec, warnings.into_iter().chain(patrol).map(|warning| warning + "\n").collect()))
    }

    fn of_generated(&self) -> Option<&'static str> {
        let is_other = self.kind != "house";
        self.calendar.map(|_| "--calendar").or(is_other.then_some("--kind"))
    }

    fn generate(&self, seed: u64) -> WorldSpec {
        if let Some(kind) = self.calendar {
            return WorldSpec::generate_calendar(kind, seed);
        }
        let named = WorldSpec::generated(&format!("{}-{seed}", self.kind));
        named.unwrap_or_else(|| WorldSpec::generate_house(seed))
    }

    fn length(&self) -> u64 {
        self.duration
    }

    fn robot(&self, max_steps: u32) -> PhysicsRobot {
        PhysicsRobot { max_steps, pose: self.pose, unseen_first: self.unseen_first }
    }

    fn to_toml(world: &WorldSpec) -> Option<String> {
        worldfile::physics::to_toml(world.fleet())
    }
}

/// A time in whole seconds.
fn whole_s(text: &str) -> Result<u64, String> {
    let time_s = duration_s(text)?;
    if time_s >= 1.0 && time_s.fract() == 0.0 {
        Ok(time_s as u64)
    } else {
        Err("must be whole seconds".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_whole_seconds() {
        assert_eq!([whole_s("20m"), whole_s("1"), whole_s("0.5h")], [Ok(1200), Ok(1), Ok(1800)]);
        assert!(["0.5", "1.25s", "-1", "nan", "x"].iter().all(|wrong| whole_s(wrong).is_err()));
    }
}
