//! The format of numbers and conditions in the table, the figures and the verdict.

use super::ReportSettings;
use super::run::Run;

/// `12345` as `12,345`.
pub(super) fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}

/// A value with `decimals`; a dash where it is not a number.
pub(super) fn value(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "-".into() }
}

/// A difference, with its sign.
pub(super) fn difference(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:+.decimals$}") } else { "-".into() }
}

/// `p = 0.012`, `p < 0.001`, or `no test` for a single pair.
pub(super) fn p_value(p_value: f64) -> String {
    match p_value {
        p if p.is_nan() => "no test".into(),
        p if p < 0.001 => "p < 0.001".into(),
        p => format!("p = {p:.3}"),
    }
}

/// The conditions of a run: `5 trials of 20,000 steps, estimator two-state, sensor radius 4`; `3 to 5 trials` where
/// strategies have different numbers of trials, as after an interruption.
pub(super) fn conditions(run: &Run, settings: &ReportSettings) -> String {
    let counts = run.strategies.iter().map(|strategy| strategy.trials);
    let trials = match (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0)) {
        (1, 1) => "1 trial".into(),
        (least, most) if least == most => format!("{most} trials"),
        (least, most) => format!("{least} to {most} trials"),
    };
    let ReportSettings { steps, sensor_radius, interrupted, .. } = settings;
    let (steps, short) = (thousands(*steps), if *interrupted { " (interrupted)" } else { "" });
    format!("{trials} of {steps} steps{short}, estimator {}, sensor radius {sensor_radius}", run.estimator)
}
