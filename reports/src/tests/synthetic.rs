//! Synthetic trials for tests: errors that fall and qualities that rise, with noise.

use crate::ReportSettings;
use evaluation::trials::{Length, Sample, Trial};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sim::grid::GridSpec;

pub(crate) const HORIZON: u64 = 20_000;

/// How fast a strategy learns, where its error of the rates ends, and its map quality.
const CHARACTERS: [(&str, f64, f64, f64); 9] = [
    ("curious", 1.0, 0.35, 0.985),
    ("recency", 0.7, 0.38, 0.99),
    ("poisson", 1.3, 0.36, 0.82),
    ("random", 0.4, 0.6, 0.95),
    ("coin", 1.0, 0.36, 0.984),
    ("information-gain", 2.2, 0.2, 0.98),
    ("optimal-revisiting", 1.5, 0.3, 0.97),
    ("frontier", 0.3, 0.8, 0.96),
    ("full-observation", 2.0, 0.22, 0.985),
];

/// Uniform in [0, 1).
pub(crate) fn uniform(chance: &mut ChaCha8Rng) -> f64 {
    f64::from(chance.next_u32()) / 4_294_967_296.0
}

/// The mean 0, the variance 1.
pub(crate) fn normal(chance: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| uniform(chance)).sum::<f64>() - 6.0
}

/// One trial; `world` makes it harder.
pub(crate) fn trial(world: usize, estimator: &str, strategy: &str, seed: u64) -> Trial {
    let &(_, speed, floor, quality) = CHARACTERS.iter().find(|(name, ..)| *name == strategy).unwrap();
    let mut chance = ChaCha8Rng::seed_from_u64(seed + 1000 * world as u64 + 77 * (speed * 10.0) as u64);
    let own = 0.1 * normal(&mut chance);
    let samples = (0..=80).map(|index| {
        let step = (HORIZON as f64 * libm::pow(f64::from(index) / 80.0, 2.0)).round() as u64;
        let learned = 1.0 - libm::exp(-speed * step as f64 / (1500.0 * (1.0 + 0.3 * world as f64)));
        let noise = 0.02 * normal(&mut chance);
        let log_error = 2.303 * (1.0 - learned) + floor * learned * (1.0 + own) + noise * learned;
        let later = |value: f64| if step < 30 { f64::NAN } else { value };
        Sample {
            time: step,
            rate_error: 1.0 - learned + learned * floor * 1.3 + 3.0 * noise * learned,
            log_error,
            log_error_of_range: 0.8 * log_error,
            map_quality: (quality - (1.0 - learned) * 0.7 + 0.2 * noise).clamp(0.0, 1.0),
            map_quality_changing: later(0.9 * quality + noise),
            coverage: learned,
            false_rate: 0.0,
            changing_share: 0.1 * speed,
            brier: later(0.2 + noise),
            brier_of_all: later(0.1 + noise),
            brier_last_seen: later(0.3 + noise),
            brier_mean: later(0.24 + noise),
            rate_auc: later(0.9 * quality),
            predictive_deviance: later(learned - 0.2),
            predictive_deviance_known: later(learned - 0.1),
            passages_log_error: later(0.7 * log_error),
            busiest_tenth_hit: later(learned),
            things_by_nominal: later(1.0 + log_error),
            things_by_floor: later(1.0 + log_error),
        }
    });
    Trial {
        world: world_name(world),
        estimator: estimator.into(),
        strategy: strategy.into(),
        seed,
        samples: samples.collect(),
        strategy_share: vec![("recency".into(), 0.4), ("poisson".into(), 0.6)],
        false_change_events: 0,
        false_map_changes: 0,
        collisions: None,
        map_hash: format!("{seed:032x}"),
    }
}

fn world_name(world: usize) -> String {
    if world == 0 { "two_blocks".into() } else { format!("generated {world}") }
}

/// The settings and the trials of an experiment.
pub(crate) fn experiment(
    worlds: usize,
    estimators: &[&str],
    strategies: &[&str],
    seeds: u64,
) -> (ReportSettings, Vec<Trial>) {
    let mut trials = Vec::new();
    for world in 0..worlds {
        for estimator in estimators {
            for strategy in strategies {
                trials.extend((0..seeds).map(|seed| trial(world, estimator, strategy, seed)));
            }
        }
    }
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    let settings = ReportSettings {
        version: "0.1.0".into(),
        arguments: vec!["--trials".into(), seeds.to_string()],
        length: Length::Grid { steps: HORIZON },
        trials: seeds,
        sensor_radius: Some(4),
        interrupted: false,
        worlds: (0..worlds).map(world_name).collect(),
        estimators: owned(estimators),
        strategies: owned(strategies),
    };
    (settings, trials)
}

/// The paper's world, under another name.
pub(crate) fn world(world: usize) -> GridSpec {
    let text = include_str!("../../../worlds/two_blocks.toml");
    let spec = worldfile::grid::parse("two_blocks.toml", text).unwrap();
    GridSpec { name: world_name(world), ..spec }
}
