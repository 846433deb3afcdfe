//! How well rates predict: explained Poisson deviance of the events after the map was frozen.
//!
//! The map of a curious robot is frozen at the given time, and compared with the true events up to three times this time.
//! Columns: explained deviance of the estimator; the same against the constant known at the freeze; a full view until then.
//! Then, at the freeze: log error, the same of range, AUC, the share of the true rates inside the 50 % and the 90 % interval;
//! of tiles, the log error of passages per hour and the hits of the busiest tenth. Then the predicted map 1 and 10 minutes ahead:
//! Brier score, that of the state last seen, of the share of time blocked, of true chains, calibration error.
//!
//! ```text
//! cargo run -p curious-evaluation --example predicted_rates -- MINUTES ESTIMATOR [WORLD:]SEED..
//! cargo run -p curious-evaluation --example predicted_rates -- 20 shared-prior 4000 4001 office-7:7 worlds/office.toml:100
//! ```

use agent::Policy;
use evaluation::metrics::{FrozenRates, StateScores, interval_scores, passage_scores, rate_scores};
use evaluation::physics_trial::{self, PhysicsTrial};
use mapper::EstimatorChoice;
use sim::physics::WorldSpec;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [minutes, estimator, worlds @ ..] = &arguments[..] else {
        return Err("usage: predicted_rates MINUTES ESTIMATOR [WORLD:]SEED..".into());
    };
    let (freeze_s, estimator) = (60.0 * minutes.parse::<f64>()?, estimator.parse::<EstimatorChoice>()?);
    let mut rows = Vec::new();
    for world in worlds {
        let (spec, seed) = match world.split_once(':') {
            Some((path, seed)) => (worldfile::shipped::load(path)?, seed.parse()?),
            None => (WorldSpec::generate_house(world.parse()?), world.parse()?),
        };
        let row = scores(&spec, seed, freeze_s, &estimator)?;
        print_row(world, &row);
        rows.push(row);
    }
    let mean =
        |column: usize| rows.iter().filter_map(|row| row[column]).sum::<f64>() / rows.len().max(1) as f64;
    let means: Vec<Option<f64>> =
        (0..rows.first().map_or(0, Vec::len)).map(|column| Some(mean(column))).collect();
    print_row("mean", &means);
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

fn print_row(name: &str, row: &[Option<f64>]) {
    print!("{name:<24}");
    row.iter()
        .for_each(|value| print!(" {:>7}", value.map_or("–".to_owned(), |value| format!("{value:.4}"))));
    println!();
}
