//! The rows of a study, and their means.

use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;
use std::io::Stdout;
use std::sync::Mutex;

/// The score of a strategy in one building.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// What all buildings have in common, over which the scores of a strategy are averaged.
    pub group: String,
    /// The strategy.
    pub strategy: String,
    /// The seed of the building: strategies are compared building by building.
    pub seed: u64,
    /// The Brier score; less is better.
    pub brier: f64,
}

/// Computes the rows of all runs on all cores. Each row is printed as a line of CSV as soon as it is finished.
///
/// # Errors
///
/// When a run fails, or its row cannot be printed.
pub fn compute<T: Sync, R: Serialize + Send>(
    runs: &[T],
    row: impl Fn(&T) -> anyhow::Result<R> + Sync,
) -> anyhow::Result<Vec<R>> {
    let out: Mutex<csv::Writer<Stdout>> = Mutex::new(csv::Writer::from_writer(std::io::stdout()));
    let computed = |run: &T| {
        let row = row(run)?;
        if let Ok(mut out) = out.lock() {
            out.serialize(&row)?;
            out.flush()?;
        }
        Ok(row)
    };
    runs.par_iter().map(computed).collect()
}

/// The mean score of every strategy of each group, over the buildings in which all strategies of the group were run, and its
/// ratio to that of the first strategy, with the p-value of the paired t test of the differences.
pub fn means(scores: &[Score]) -> String {
    let mut text = String::new();
    let mut groups: Vec<&str> = scores.iter().map(|score| score.group.as_str()).collect();
    unique(&mut groups);
    for group in groups {
        let own: Vec<&Score> = scores.iter().filter(|score| score.group == group).collect();
        let mut strategies: Vec<&str> = own.iter().map(|score| score.strategy.as_str()).collect();
        unique(&mut strategies);
        let brier = |strategy: &str, seed: u64| {
            let found = own.iter().find(|score| score.strategy == strategy && score.seed == seed);
            found.map(|score| score.brier)
        };
        let mut seeds: Vec<u64> = own.iter().map(|score| score.seed).collect();
        unique(&mut seeds);
        seeds.retain(|seed| strategies.iter().all(|strategy| brier(strategy, *seed).is_some()));
        let values =
            |strategy: &str| -> Vec<f64> { seeds.iter().filter_map(|seed| brier(strategy, *seed)).collect() };
        let _ = writeln!(text, "{group}, {} buildings", seeds.len()); // a string can be written
        let first = values(strategies[0]);
        for strategy in strategies {
            let own = values(strategy);
            let p_value = reports::paired_test(own.iter().zip(&first).map(|(a, b)| a - b)).p_value;
            let ratio = mean(&own) / mean(&first);
            let _ = writeln!(text, "  {strategy:<14} {:.4}  × {ratio:.3}, p = {p_value:.1e}", mean(&own));
        }
    }
    text
}

/// Keeps the first of equal values.
fn unique<T: PartialEq + Copy>(values: &mut Vec<T>) {
    let mut known = Vec::new();
    values.retain(|value| {
        let is_new = !known.contains(value);
        known.extend(is_new.then_some(*value));
        is_new
    });
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strategies_are_compared_building_by_building() {
        let score = |strategy: &str, seed, brier| Score {
            group: "home".to_owned(),
            strategy: strategy.to_owned(),
            seed,
            brier,
        };
        let scores = [
            score("round", 0, 0.2),
            score("gain", 0, 0.1),
            score("round", 1, 0.4),
            score("gain", 1, 0.1),
            score("round", 2, 9.0),
        ];
        let text = means(&scores);
        assert!(text.starts_with("home, 2 buildings\n"), "{text}");
        assert!(
            text.contains("round          0.3000  × 1.000")
                && text.contains("gain           0.1000  × 0.333")
        );
    }
}
