//! The rows of runs, and the ratios of their scores.

use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// The strategies that look everywhere in turn, or where the paper looks.
const OTHERS: [&str; 3] = ["recency", "curious", "coverage"];

/// A run and its result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    /// The number of rooms along each side.
    pub rooms: usize,
    /// The side of a room, m.
    pub side_m: f64,
    /// The range of the laser, m.
    pub laser_m: f64,
    /// The number of things in a part of 4 × 4 m that has any.
    pub things: usize,
    /// Whether these have the same rates.
    pub alike: bool,
    /// The standard deviation of the logarithm of the mean stays.
    pub spread: f64,
    /// The share of the time on patrol.
    pub duty: f64,
    /// Simulated hours.
    pub hours: f64,
    /// The seed of the place.
    pub seed: u64,
    /// The strategy.
    pub strategy: String,
    /// The Brier score.
    pub brier: f64,
    /// The way of the robot, m.
    pub way_m: f64,
}

impl Row {
    pub(super) fn setting(&self) -> String {
        let Self { rooms, side_m, laser_m, things, spread, duty, .. } = self;
        let things = match (things, self.alike) {
            (1, _) => "1 thing".to_owned(),
            (_, true) => format!("{things} things alike"),
            (_, false) => format!("{things} things"),
        };
        let moves = if *duty < 1.0 { format!(", {:.0} % on patrol", 100.0 * duty) } else { String::new() };
        format!("{rooms} x {rooms} rooms of {side_m} m, laser {laser_m} m, {things}, spread {spread}{moves}")
    }
}

/// For every setting and strategy the ratio to the best of the others.
pub(super) fn ratios(rows: &[Row]) -> Vec<(String, String, f64, Ratio)> {
    let mut settings: Vec<String> = Vec::new();
    for setting in rows.iter().map(Row::setting) {
        if !settings.contains(&setting) {
            settings.push(setting);
        }
    }
    let mut found = Vec::new();
    for setting in settings {
        let own: Vec<&Row> = rows.iter().filter(|row| row.setting() == setting).collect();
        let mut strategies: Vec<&str> = Vec::new();
        for row in &own {
            if !strategies.contains(&row.strategy.as_str()) {
                strategies.push(&row.strategy);
            }
        }
        let mut seeds: Vec<u64> = own.iter().map(|row| row.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        let brier = |strategy: &str, seed: u64| {
            own.iter().find(|row| row.strategy == strategy && row.seed == seed).map(|row| row.brier)
        };
        seeds.retain(|seed| strategies.iter().all(|strategy| brier(strategy, *seed).is_some()));
        let scores =
            |strategy: &str| -> Vec<f64> { seeds.iter().filter_map(|seed| brier(strategy, *seed)).collect() };
        let mean = |scores: &[f64]| scores.iter().sum::<f64>() / scores.len() as f64;
        let others =
            strategies.iter().filter(|strategy| OTHERS.contains(strategy)).map(|strategy| scores(strategy));
        let Some(best) = others.min_by(|a, b| mean(a).total_cmp(&mean(b))) else { continue };
        for strategy in &strategies {
            let own = scores(strategy);
            found.push((setting.clone(), (*strategy).to_owned(), mean(&own), ratio(&own, &best)));
        }
    }
    found
}

/// The scores of each setting, and their ratios to that of the best of recency, curious and coverage.
pub fn table(rows: &[Row]) -> String {
    let (mut text, mut last) = (String::new(), String::new());
    for (setting, strategy, brier, Ratio { mean, standard_error, places }) in ratios(rows) {
        if setting != last {
            let _ = writeln!(text, "{setting}: {places} places"); // a string can be written
            last = setting;
        }
        let _ = writeln!(text, "  {strategy:<17} {brier:.4}  x {mean:.3} +- {standard_error:.3}");
    }
    text
}

/// A measured ratio agrees with the prediction within this, and two standard errors.
const AGREES: f64 = 0.05;

/// What was predicted beside what was measured.
pub fn compare(predicted: &[Row], measured: &[Row]) -> String {
    let mut text = String::new();
    let predicted = ratios(predicted);
    for (setting, strategy, _, found) in ratios(measured) {
        let Some((.., expected)) =
            predicted.iter().find(|(of, name, ..)| *of == setting && *name == strategy)
        else {
            continue;
        };
        let error = (found.standard_error.powi(2) + expected.standard_error.powi(2)).sqrt();
        let agrees = (found.mean - expected.mean).abs() <= AGREES + 2.0 * error;
        let _ = writeln!(
            text,
            "{setting}, {strategy}: predicted {:.3} +- {:.3}, measured {:.3} +- {:.3} ({} places){}",
            expected.mean,
            expected.standard_error,
            found.mean,
            found.standard_error,
            found.places,
            if agrees { "" } else { ": apart" },
        );
    }
    text
}

/// A ratio of means over places, with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The mean of the one divided by the mean of the other.
    pub mean: f64,
    /// Its standard error, by leaving out one place at a time (jackknife). Not a number for fewer than two places.
    pub standard_error: f64,
    /// The number of places.
    pub places: usize,
}

/// The ratio of the means of two scores of the same places, in the same order.
pub fn ratio(ones: &[f64], others: &[f64]) -> Ratio {
    let places = ones.len().min(others.len());
    let without = |left_out: Option<usize>| {
        let sum = |scores: &[f64]| -> f64 {
            let kept = scores[..places].iter().enumerate().filter(|(place, _)| Some(*place) != left_out);
            kept.map(|(_, score)| score).sum()
        };
        sum(ones) / sum(others)
    };
    let left_out: Vec<f64> = (0..places).map(|place| without(Some(place))).collect();
    let middle = left_out.iter().sum::<f64>() / places as f64;
    let squares: f64 = left_out.iter().map(|ratio| (ratio - middle) * (ratio - middle)).sum();
    let standard_error =
        if places < 2 { f64::NAN } else { ((places - 1) as f64 / places as f64 * squares).sqrt() };
    Ratio { mean: without(None), standard_error, places }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_ratio() {
        let others = [1.0; 8];
        let ones = [0.7, 0.9, 0.8, 0.8, 0.6, 1.0, 0.75, 0.85];
        let found = ratio(&ones, &others);
        let mean = ones.iter().sum::<f64>() / 8.0;
        let variance = ones.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>() / 7.0;
        assert!((found.mean - mean).abs() < 1e-12);
        assert!((found.standard_error - (variance / 8.0).sqrt()).abs() < 1e-12, "of a mean, the usual one");
        assert!(ratio(&ones[..1], &others).standard_error.is_nan());
    }
}
