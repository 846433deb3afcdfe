//! `trials.csv`: one row per trial and sample.

use super::metric::Metric;
use super::trial::Trial;
use std::io::{self, Write};

/// Writes all samples of all trials; an undefined value is an empty field.
pub(super) fn write(trials: &[Trial], to: impl Write) -> io::Result<()> {
    let mut file = csv::Writer::from_writer(to);
    let names = Metric::ALL.map(Metric::name);
    file.write_record(["world", "estimator", "strategy", "seed", "step"].iter().chain(&names))?;
    for trial in trials {
        let seed = trial.seed.to_string();
        for sample in &trial.samples {
            for field in [&trial.world, &trial.estimator, &trial.strategy, &seed, &sample.step.to_string()] {
                file.write_field(field)?;
            }
            for value in Metric::ALL.map(|metric| metric.of(sample)) {
                file.write_field(if value.is_nan() { String::new() } else { value.to_string() })?;
            }
            file.write_record(None::<&[u8]>)?;
        }
    }
    file.flush()
}
