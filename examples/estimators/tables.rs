//! The results as Markdown tables.

use crate::blocks::{Judged, Set};
use crate::chains::Outcome;
use crate::patterns::Pattern;
use crate::robots::Habit;
use crate::room;
use crate::score::{MASS, Mean};
use mapper::EstimatorChoice;
use std::fmt::Write as _;

/// A pattern of observations identifies a rate if the minimum relative standard deviation is at most this value.
const IDENTIFIED: f64 = 0.1;

/// The name of a row.
fn name(estimator: &EstimatorChoice) -> String {
    format!("`{}`", estimator.name())
}

/// A number, or a dash for a missing one.
fn figure(value: f64, digits: usize) -> String {
    if value.is_nan() { "–".to_owned() } else { format!("{value:.digits$}") }
}

/// Worlds of one kind.
pub(crate) fn blocks(set: Set, judged: &Judged) -> String {
    let Judged { worlds, steps, scores, naive, events } = judged;
    let habits: Vec<&str> = Habit::ALL.into_iter().map(Habit::name).collect();
    let mut text = format!(
        "\n## {}\n\n{worlds} lives of {steps} steps per habit of the robot. Log error of the rates at the end; \
         all estimators saw the same.\n\n| estimator | {} | all | part of `paper`'s | bias | cells in dense view | \
         in sparse view | rate of static cells | {MASS} intervals that hold the truth | Brier score |\n\
         |---|{}---|---|---|---|---|---|---|---|\n",
        set.name(),
        habits.join(" | "),
        "---|".repeat(habits.len()),
    );
    let all = |at: usize| scores[at].log_error.iter().map(Mean::mean).sum::<f64>() / habits.len() as f64;
    for (at, (estimator, score)) in EstimatorChoice::all().into_iter().zip(scores).enumerate() {
        let errors: Vec<String> = score.log_error.iter().map(|mean| figure(mean.mean(), 3)).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {:.3} | {:.3} | {:+.2} | {} | {} | {} | {:.2} | {:.4} |",
            name(&estimator),
            errors.join(" | "),
            all(at),
            all(at) / all(0),
            score.bias.mean(),
            figure(score.dense.mean(), 3),
            figure(score.sparse.mean(), 3),
            static_rate(score.false_rate.mean()),
            score.covered.mean(),
            score.brier.mean(),
        );
    }
    let _ = writeln!(
        text,
        "\nBrier score of \"as last seen\" {:.4}, of \"always the mean\" {:.4}. In view {} block events and {} free \
         events of changing cells.",
        naive.last_seen.mean(),
        naive.always_mean.mean(),
        events[0],
        events[1],
    );
    text
}

/// The dummy robot of the physics world.
pub(crate) fn room(scores: &[Vec<room::Score>]) -> String {
    let mut text = format!(
        "\n## The physics world\n\nThe dummy robot of `four_rooms`, watched for half an hour by a laser that stands \
         in its room.\n\n| scans seen | estimator | log error | bias | rate of static cells | {MASS} intervals \
         that hold the truth |\n|---|---|---|---|---|---|\n"
    );
    for ((seen, of), scores) in room::VISITS.into_iter().zip(scores) {
        for (estimator, score) in EstimatorChoice::all().into_iter().zip(scores) {
            let _ = writeln!(
                text,
                "| {seen} of {of} | {} | {:.3} | {:+.2} | {} | {:.2} |",
                name(&estimator),
                score.log_error.mean(),
                score.bias.mean(),
                static_rate(score.false_rate.mean()),
                score.covered.mean(),
            );
        }
    }
    text
}

/// The scores of one estimator for all kinds of chains under one pattern of observations.
#[derive(Default)]
struct Row {
    identified: u32,
    /// The largest bias among the identified rates, with its sign.
    bias: f64,
    /// Root mean square error over the least possible.
    over_least: Mean,
    log_error: Mean,
    covered: Mean,
    elsewhere: Mean,
    /// The most by which the log error is above that of `paper`.
    worse: f64,
}

impl Row {
    fn of(outcomes: &[Outcome], pattern: Pattern, at: usize) -> Self {
        let mut row = Self { worse: f64::NEG_INFINITY, ..Self::default() };
        for outcome in outcomes.iter().filter(|outcome| outcome.pattern == pattern) {
            let (score, paper) = (outcome.scores[at], outcome.scores[0]);
            if outcome.least <= IDENTIFIED {
                row.identified += 1;
                row.bias = if score.bias.abs() > row.bias.abs() { score.bias } else { row.bias };
                row.over_least.add(score.rms / outcome.least);
                row.log_error.add(score.log_error);
                row.covered.add(score.covered);
            } else {
                row.elsewhere.add(score.log_error);
            }
            row.worse = row.worse.max(score.log_error - paper.log_error);
        }
        row
    }
}

/// Every pattern of looks.
pub(crate) fn chains(outcomes: &[Outcome]) -> String {
    let mut text = format!(
        "\n## Simulated two-state chains\n\nA pattern of looks identifies the rate of a kind of chain where no \
         estimator without bias need be off by more than {IDENTIFIED} (Fisher's bound on the relative standard \
         deviation). The first columns are of these kinds.\n\n| looks | estimator | kinds | largest bias | \
         root mean square error, in bounds | log error | {MASS} intervals that hold the truth | \
         log error elsewhere | at most above `paper`'s |\n|---|---|---|---|---|---|---|---|---|\n"
    );
    for pattern in Pattern::ALL {
        for (at, estimator) in EstimatorChoice::all().into_iter().enumerate() {
            let row = Row::of(outcomes, pattern, at);
            let bias = if row.identified == 0 { "–".to_owned() } else { format!("{:+.3}", row.bias) };
            let _ = writeln!(
                text,
                "| {} | {} | {} | {bias} | {} | {} | {} | {} | {:+.3} |",
                pattern.name(),
                name(&estimator),
                row.identified,
                figure(row.over_least.mean(), 2),
                figure(row.log_error.mean(), 3),
                figure(row.covered.mean(), 2),
                figure(row.elsewhere.mean(), 3),
                row.worse,
            );
        }
    }
    text
}

/// Cells between others of a different pace.
pub(crate) fn unlike_neighbours(rows: &[[Outcome; 3]]) -> String {
    let mut text = "\n## Neighbours that differ\n\nChains seen 10 of 40 steps; bias and log error of \
                    `two-state-gaps`, which lets neighbours speak for a cell.\n\n| cycles per step | alone | between \
                    cells 10 times faster | 10 times slower |\n|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let cell = |outcome: &Outcome| {
            let at =
                EstimatorChoice::all().into_iter().position(|estimator| estimator.name() == "two-state-gaps");
            let score = outcome.scores[at.unwrap_or_default()];
            format!("{:+.3}, {:.3}", score.bias, score.log_error)
        };
        let [alone, faster, slower] = row.each_ref().map(cell);
        let _ = writeln!(text, "| {} | {alone} | {faster} | {slower} |", row[0].rate);
    }
    text
}

/// The mean rate of static cells; 0 under all estimators but those with a shared prior.
fn static_rate(rate: f64) -> String {
    if rate > 0.0 { format!("{rate:.1e}") } else { "0".to_owned() }
}
