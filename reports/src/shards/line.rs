//! The lines of the file of a shard.

use evaluation::trials::{Metric, Sample, Trial};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use xxhash_rust::xxh3::xxh3_64_with_seed;

/// What ends the text of a line, before its hash.
const HASH: &str = ",\"hash\":\"";
/// What begins the samples.
const SAMPLES: &str = ",\"samples\":[[";
/// A number that every reader of JSON reads as infinite, or as the largest number.
const INFINITE: &str = "1e999";

/// What a trial has cost. This is the only part of a line that is not the same at every repetition.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// The wall time of the trial on its thread, s.
    pub seconds: f64,
    /// The time at which the trial was finished, in s since 1970.
    pub finished: u64,
}

/// A line of a trial without the samples.
#[derive(Serialize, Deserialize)]
pub(super) struct Head {
    /// The number of the trial.
    pub(super) job: u64,
    #[serde(flatten)]
    pub(super) cost: Cost,
    world: String,
    estimator: String,
    strategy: String,
    seed: u64,
    /// The shares as text: reading a JSON number need not give every bit again.
    strategy_share: Vec<(String, String)>,
    false_change_events: u64,
    false_map_changes: u64,
    collisions: Option<u64>,
    map_hash: String,
}

/// The text of a JSON object, with its hash as the last key, and a line's end.
pub(super) fn seal(object: &str, key: u64) -> String {
    let text = object.strip_suffix('}').unwrap_or(object);
    format!("{text}{HASH}{:016x}\"}}\n", xxh3_64_with_seed(text.as_bytes(), key))
}

/// The text of an object without its last brace and its hash; `None` if the line, without its end, is not as it was
/// written.
pub(super) fn unseal(line: &str, key: u64) -> Option<&str> {
    let (text, hash) = line.strip_suffix("\"}")?.rsplit_once(HASH)?;
    (hash == format!("{:016x}", xxh3_64_with_seed(text.as_bytes(), key))).then_some(text)
}

/// The line of the trial with a number, with a line's end.
pub(super) fn write(job: u64, cost: Cost, trial: &Trial, key: u64) -> serde_json::Result<String> {
    let share = |(name, share): &(String, f64)| (name.clone(), share.to_string());
    let head = Head {
        job,
        cost,
        world: trial.world.clone(),
        estimator: trial.estimator.clone(),
        strategy: trial.strategy.clone(),
        seed: trial.seed,
        strategy_share: trial.strategy_share.iter().map(share).collect(),
        false_change_events: trial.false_change_events,
        false_map_changes: trial.false_map_changes,
        collisions: trial.collisions,
        map_hash: trial.map_hash.clone(),
    };
    let mut text = serde_json::to_string(&head)?;
    text.pop(); // the brace
    text.push_str(",\"samples\":[");
    for (index, sample) in trial.samples.iter().enumerate() {
        text.push_str(if index == 0 { "[" } else { ",[" });
        push(&mut text, sample.time);
        for value in Metric::ALL.map(|metric| metric.of(sample)) {
            text.push(',');
            match value {
                value if value.is_nan() => text.push_str("null"),
                value if value.is_infinite() && value > 0.0 => text.push_str(INFINITE),
                value => push(&mut text, value),
            }
        }
        text.push(']');
    }
    text.push_str("]}");
    Ok(seal(&text, key))
}

/// Appends a number as text; a text in memory accepts everything.
fn push(text: &mut String, number: impl std::fmt::Display) {
    let _ = write!(text, "{number}");
}

/// The head of an unsealed line, and its samples as text; `None` for something else.
pub(super) fn split(text: &str) -> Option<(Head, &str)> {
    // A line without samples has none of a trial.
    let (head, samples) = text.split_once(SAMPLES)?;
    let head = serde_json::from_str(&format!("{head}}}")).ok()?;
    Some((head, samples.strip_suffix("]]")?))
}

/// The trial of an unsealed line; `None` if the text is of something else. Numbers are read with all of their bits.
pub(super) fn read(text: &str) -> Option<(u64, Trial)> {
    let (head, samples) = split(text)?;
    let share = |(name, share): (String, String)| Some((name, share.parse().ok()?));
    let trial = Trial {
        world: head.world,
        estimator: head.estimator,
        strategy: head.strategy,
        seed: head.seed,
        samples: samples.split("],[").map(sample).collect::<Option<_>>()?,
        strategy_share: head.strategy_share.into_iter().map(share).collect::<Option<_>>()?,
        false_change_events: head.false_change_events,
        false_map_changes: head.false_map_changes,
        collisions: head.collisions,
        map_hash: head.map_hash,
    };
    Some((head.job, trial))
}

fn sample(text: &str) -> Option<Sample> {
    let mut numbers = text.split(',');
    let time = numbers.next()?.parse().ok()?;
    let mut values = [f64::NAN; Metric::ALL.len()];
    for value in &mut values {
        let number = numbers.next()?;
        if number != "null" {
            *value = number.parse().ok()?;
        }
    }
    numbers.next().is_none().then(|| Sample::new(time, values))
}
