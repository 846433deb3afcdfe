//! How well rates predict: explained Poisson deviance of the events after the map was frozen.
//!
//! The map of a curious robot is frozen at the given time, and compared with the true events up to three times this time. A line per
//! world and estimator, as CSV: explained deviance; the same against the constant known at the freeze; a full view until then. Then,
//! at the freeze: log error, the same of range, AUC, the share of the true rates inside the 50 % and the 90 % interval; of tiles, the log
//! error of passages per hour and the hits of the busiest tenth. Then the predicted map 1 and 10 minutes ahead: Brier score, that of the
//! state last seen, of the share of time blocked, of true chains, calibration error. The goals do not depend on the estimator.
//!
//! ```text
//! cargo run -p curious-evaluation --example predicted_rates -- MINUTES SET=WORLD,WORLD.. ..
//! (echo "# $(git show -s --format='commit %h of %cs'), cargo run -p curious-evaluation --example predicted_rates (sets: see the top of its source)"
//!  cargo run -p curious-evaluation --example predicted_rates -- 20 "houses 4000–4007=4000,4001,4002,4003,4004,4005,4006,4007" \
//!    "houses 7000–7010=7000,7001,7002,7003,7004,7005,7006,7007,7008,7009,7010" \
//!    "offices 100–105=office-100:100,office-101:101,office-102:102,office-103:103,office-104:104,office-105:105" \
//!    '`warehouse` 100–102=warehouse:100,warehouse:101,warehouse:102' '`office` 100–102=office:100,office:101,office:102' \
//!    '`cave` 100–102=cave:100,cave:101,cave:102' '`house` 100=house:100' '`yard` 100=yard:100') > docs/results/predicted_rates.csv
//! ```
//!
//! A world is the seed of a generated house, or `NAME:SEED` or `FILE:SEED`.

use agent::Policy;
use evaluation::metrics::{FrozenRates, StateScores, interval_scores, passage_scores, rate_scores};
use evaluation::physics_trial::{self, PhysicsTrial};
use mapper::EstimatorChoice;
use sim::physics::WorldSpec;
use std::error::Error;

/// The estimators that are compared.
const ESTIMATORS: [&str; 2] = ["two-state-gaps", "shared-prior"];
const COLUMNS: &str = "set,world,estimator,deviance,known,full_view,log_error,log_error_of_range,rate_auc,inside_50,inside_90,\
                       passages_log_error,busiest_tenth,brier_1min,last_seen_1min,blocked_share_1min,true_chains_1min,\
                       calibration_1min,brier_10min,last_seen_10min,blocked_share_10min,true_chains_10min,calibration_10min";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [minutes, sets @ ..] = &arguments[..] else {
        return Err("usage: predicted_rates MINUTES SET=WORLD,WORLD.. ..".into());
    };
    let freeze_s = 60.0 * minutes.parse::<f64>()?;
    println!("{COLUMNS}");
    for set in sets {
        let (set, worlds) = set.split_once('=').ok_or("expected SET=WORLD,WORLD..")?;
        for world in worlds.split(',') {
            let (spec, seed) = match world.split_once(':') {
                Some((name, seed)) => (worldfile::shipped::load(name)?, seed.parse()?),
                None => (WorldSpec::generate_house(world.parse()?), world.parse()?),
            };
            for estimator in ESTIMATORS {
                let scores = scores(&spec, seed, freeze_s, &estimator.parse()?)?;
                let text = |score: &Option<f64>| score.map_or(String::new(), |score| format!("{score:.4}"));
                let scores: Vec<String> = scores.iter().map(text).collect();
                println!("{set},{world},{estimator},{}", scores.join(","));
            }
        }
    }
    Ok(())
}

fn scores(
    spec: &WorldSpec,
    seed: u64,
    freeze_s: f64,
    estimator: &EstimatorChoice,
) -> Result<Vec<Option<f64>>, Box<dyn Error>> {
    let mut settings = physics_trial::settings(spec)?;
    settings.mapper.estimator = estimator.clone();
    let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
    let mut trial = PhysicsTrial::new(spec, seed, &settings, None, pilot)?;
    trial.run(freeze_s)?;
    let (mapper, truth) = (&trial.robot.mapper, trial.world.truth());
    let frozen = FrozenRates::of(mapper, truth);
    let (rates, intervals) = (rate_scores(mapper, truth), interval_scores(mapper, truth));
    let passages = passage_scores(mapper, truth);
    trial.run(3.0 * freeze_s)?;
    let frozen = frozen.scores(trial.world.truth());
    let forecasts = trial.observer.forecasts.scores();
    let mut row = vec![
        frozen.predictive_deviance,
        frozen.predictive_deviance_known,
        frozen.predictive_deviance_ceiling,
        rates.log_error,
        rates.log_error_of_range,
        rates.rate_auc,
        intervals.inside_50,
        intervals.inside_90,
        passages.log_error_busy,
        passages.busiest_tenth_hit,
    ];
    let states = [forecasts.states_1min, forecasts.states_10min];
    for StateScores { brier, brier_last_seen, brier_mean, brier_true_chains, calibration_error, .. } in states
    {
        row.extend([brier, brier_last_seen, brier_mean, brier_true_chains, calibration_error]);
    }
    Ok(row)
}
