//! Recorded doors and rooms: how well the clock, the estimators of the map, and simple baselines predict them.
//!
//! ```text
//! cargo run -p curious-studies --bin real_series -- [--time-zone ZONE] FILES
//! ```
//!
//! A file has the lines `time_s,state`, one per change: seconds since 1970-01-01 UTC (or since a midnight), and 1 (blocked,
//! open, occupied), 0, or `nan` where nothing was recorded. A comment with `split_s=… end_s=…` says which part is learned from
//! and which part is predicted; without it, the first half. Files whose names agree up to the first `-` are a set (a home);
//! errors are averaged over the things of a set.
//!
//! A robot sees a thing at all minutes, at random ones (5, 2, 1 % of them; three draws), or on patrol: every two hours for five
//! minutes. Models learn from the looks before the split. After it they take the looks without learning from them, and predict
//! every five minutes. *Best baseline*: the baseline with the least Brier score in this set, with these looks, at this horizon,
//! in hindsight.

mod hours;
mod models;
mod recorded;
mod score;
mod series;
mod table;
#[cfg(test)]
mod tests;

use clap::Parser;
use evaluation::metrics::ProbabilityScores;
use mapper::{Calendar, DAY_S};
use rayon::prelude::*;
use score::HORIZONS;
use series::{LOOKS, Looks, Series};
use std::io::Write;
use std::path::PathBuf;
use table::Table;

/// How well the clock, the estimators of the map and simple baselines predict recorded doors and rooms.
#[derive(Parser)]
struct Options {
    /// Series of events: CSV files with the lines `time_s,state`
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The zone of the times, an IANA name such as Europe/Berlin
    #[arg(long, default_value = "UTC")]
    time_zone: String,
    /// Without the learning curve, which takes five times as long as the rest
    #[arg(long)]
    no_curve: bool,
}

/// Days of history of the learning curve.
const CURVE_DAYS: [f64; 5] = [1.0, 3.0, 7.0, 14.0, 28.0];
/// The number of draws of random looks.
const DRAWS: u64 = 3;

/// The scores of all models for one series and one kind of looks.
struct Case<'a> {
    series: &'a Series,
    looks: usize,
    scores: Vec<[ProbabilityScores; HORIZONS.len()]>,
}

/// Scores all models on all series, learning from at most `history_s` before the split.
fn evaluate<'a>(series: &'a [Series], history_s: f64, calendar: &Calendar) -> Vec<Case<'a>> {
    let cases: Vec<(&Series, usize)> =
        series.iter().flat_map(|series| (0..LOOKS.len()).map(move |looks| (series, looks))).collect();
    let case = |(series, looks): (&'a Series, usize)| {
        let draws = if matches!(LOOKS[looks].1, Looks::Full) { 1 } else { DRAWS };
        let mut scores = vec![[ProbabilityScores::default(); HORIZONS.len()]; models::all(calendar).len()];
        for seed in 0..draws {
            for (sum, mut model) in scores.iter_mut().zip(models::all(calendar)) {
                let of_draw = score::score(series, LOOKS[looks].1, seed, history_s, &mut model);
                sum.iter_mut().zip(&of_draw).for_each(|(sum, score)| sum.merge(score));
            }
        }
        Case { series, looks, scores }
    };
    cases.into_par_iter().map(case).collect()
}

fn run(options: &Options, out: &mut impl Write) -> Result<(), String> {
    let calendar = Calendar::of_zone(&options.time_zone).map_err(|error| error.to_string())?;
    let series = options.files.iter().map(|file| Series::read(file)).collect::<Result<Vec<_>, _>>()?;
    let (cases, models) = (evaluate(&series, f64::INFINITY, &calendar), models::all(&calendar));
    let table = Table::new(&cases, &models);
    if table.is_empty() {
        return Err("nothing can be predicted: the series are over before the shortest time ahead".to_owned());
    }
    let say = |error: std::io::Error| error.to_string();
    table.print(out).map_err(say)?;
    hours::print(&series, &calendar, out).map_err(say)?;
    if !options.no_curve {
        writeln!(out, "\nLearning curve: clock ÷ best baseline with the same history\n").map_err(say)?;
        for days in CURVE_DAYS {
            let cases = evaluate(&series, days * DAY_S, &calendar);
            let ratio = Table::new(&cases, &models).ratio(0);
            writeln!(out, "{days:4} days {ratio:.3}").map_err(say)?;
        }
    }
    Ok(())
}

fn main() -> std::process::ExitCode {
    match run(&Options::parse(), &mut std::io::stdout().lock()) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            std::process::ExitCode::from(2)
        }
    }
}
