//! The table for a terminal.

use super::claim::Claim;
use super::comparison::Comparison;
use super::metric::{Measure, Metric, Part};
use super::run::{Run, StrategyResult, conditions};
use super::wording::{difference, p_value, value};
use super::{ONE_BY_ONE, REFERENCE, Report};

const HOW_TO_READ: &str = "\
How to read it: errors are 0 and map quality is 1 at best; final is the value at the end, area the
mean over the run, * the best; time at changes is the share of steps with a changing cell in view.
";

/// The meaning of a column.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Error,
    Quality,
    Share,
}

struct Column {
    name: &'static str,
    measure: Measure,
    kind: Kind,
    width: usize,
}

/// The share of the steps with a swept cell in view.
const CHANGING_SHARE: Measure = Measure { metric: Metric::ChangingShare, part: Part::Final };

/// Above pairs of columns.
const GROUPS: [&str; 4] = ["log error", "rate error", "map quality", "time at"];

const COLUMNS: [Column; 7] = [
    Column { name: "final", measure: Measure::FINAL_LOG_ERROR, kind: Kind::Error, width: 12 },
    Column { name: "area", measure: Measure::LOG_ERROR_AREA, kind: Kind::Error, width: 9 },
    Column { name: "final", measure: Measure::FINAL_RATE_ERROR, kind: Kind::Error, width: 12 },
    Column { name: "area", measure: Measure::RATE_ERROR_AREA, kind: Kind::Error, width: 9 },
    Column { name: "all cells", measure: Measure::FINAL_MAP_QUALITY, kind: Kind::Quality, width: 13 },
    Column { name: "changing", measure: Measure::FINAL_MAP_QUALITY_CHANGING, kind: Kind::Quality, width: 10 },
    Column { name: "changes", measure: CHANGING_SHARE, kind: Kind::Share, width: 12 },
];

impl Column {
    fn text(&self, number: f64) -> String {
        match self.kind {
            Kind::Error => value(number, 3),
            Kind::Quality => value(number, 4),
            Kind::Share if number.is_nan() => "-".into(),
            Kind::Share => format!("{:.1} %", 100.0 * number),
        }
    }

    /// One cell per strategy; a star marks the best number, and numbers that are printed the same.
    fn cells(&self, strategies: &[StrategyResult]) -> Vec<String> {
        let rivals = strategies.iter().filter(|strategy| strategy.name != REFERENCE);
        let numbers = rivals.map(|strategy| strategy.value(self.measure));
        let best = match self.kind {
            Kind::Error => numbers.fold(f64::NAN, f64::min),
            Kind::Quality => numbers.fold(f64::NAN, f64::max),
            Kind::Share => f64::NAN,
        };
        let best = (!best.is_nan()).then(|| self.text(best));
        let cell = |strategy: &StrategyResult| {
            let text = self.text(strategy.value(self.measure));
            let is_best = best.as_ref() == Some(&text) && strategy.name != REFERENCE;
            format!("{text}{}", if is_best { "*" } else { " " })
        };
        strategies.iter().map(cell).collect()
    }
}

/// The tables of all runs; with many worlds, only the runs over all worlds.
pub(super) fn table(report: &Report) -> String {
    if report.runs.is_empty() {
        return "No trial was finished.\n".into();
    }
    let worlds = report.runs.iter().map(|run| run.worlds).max().unwrap_or(1);
    let is_short = worlds > ONE_BY_ONE;
    let mut lines = Vec::new();
    for run in report.runs.iter().filter(|run| !is_short || run.worlds > 1) {
        lines.push(run.world.clone());
        lines.push(conditions(run, &report.settings));
        lines.push(String::new());
        let names = run.strategies.iter().map(|strategy| strategy.name.chars().count());
        let name_width = names.max().unwrap_or(0).max("strategy".len());
        lines.extend(values(run, name_width));
        lines.push(String::new());
        lines.extend(differences(run, name_width));
        lines.extend(false_events(run));
        lines.extend(winner(run));
        lines.extend(Claim::of(run).map(|claim| claim.sentence()));
        lines.push(String::new());
    }
    let mut text: String = lines.iter().flat_map(|line| [line.trim_end(), "\n"]).collect();
    text.push_str(HOW_TO_READ);
    if is_short {
        text.push_str("The worlds one by one are in report.json.\n");
    }
    text
}

/// A row per strategy.
fn values(run: &Run, name_width: usize) -> Vec<String> {
    let groups: String = COLUMNS
        .chunks(2)
        .zip(GROUPS)
        .map(|(columns, group)| {
            let width: usize = columns.iter().map(|column| column.width).sum();
            // Over the middle of its columns, where their numbers stand.
            if columns.len() > 1 {
                format!("{group:^0$}", width + 3)
            } else {
                format!("{group:>0$}", width - 4)
            }
        })
        .collect();
    let names: String =
        COLUMNS.iter().map(|column| format!("{:>1$} ", column.name, column.width - 1)).collect();
    let columns = COLUMNS.map(|column| {
        column
            .cells(&run.strategies)
            .into_iter()
            .map(move |cell| format!("{cell:>0$}", column.width))
            .collect::<Vec<_>>()
    });
    let mut lines = vec![format!("{:name_width$}{groups}", ""), format!("{:name_width$}{names}", "strategy")];
    for (row, strategy) in run.strategies.iter().enumerate() {
        let cells: String = columns.iter().map(|column| column[row].as_str()).collect();
        lines.push(format!("{:name_width$}{cells}", strategy.name));
    }
    lines
}

/// The first strategy against every other.
fn differences(run: &Run, name_width: usize) -> Vec<String> {
    let [first, others @ ..] = run.strategies.as_slice() else { return Vec::new() };
    if others.is_empty() {
        return Vec::new();
    }
    let head = ["log error, area", "log error, final", "map quality, final"];
    let row = |name: &str, cells: [String; 3]| {
        format!("{name:name_width$}{}", cells.map(|cell| format!("{cell:>26}")).concat())
    };
    let over = if run.worlds > 1 { "worlds" } else { "seeds" };
    let mut lines = vec![
        format!(
            "Paired differences, {} minus the other: mean over {over} ± half its 95 % interval, t test",
            first.name
        ),
        row("", head.map(String::from)),
    ];
    for other in others {
        let cell = |measure, decimals| {
            let comparison = run.comparison(&first.name, &other.name, measure);
            comparison.map_or("-".into(), |comparison| difference_cell(&comparison, decimals))
        };
        let cells = [
            cell(Measure::LOG_ERROR_AREA, 3),
            cell(Measure::FINAL_LOG_ERROR, 3),
            cell(Measure::FINAL_MAP_QUALITY, 4),
        ];
        lines.push(row(&other.name, cells));
    }
    lines.push(String::new());
    lines
}

fn difference_cell(comparison: &Comparison, decimals: usize) -> String {
    let mean = difference(comparison.mean_difference, decimals);
    if comparison.p_value.is_nan() {
        return mean;
    }
    let half_width = value((comparison.high - comparison.low) / 2.0, decimals);
    format!("{mean} ±{half_width} {}", p_value(comparison.p_value))
}

/// A line on false changes, if there are any.
fn false_events(run: &Run) -> Option<String> {
    let those = run.strategies.iter().filter(|strategy| strategy.false_change_events > 0);
    let counts: Vec<String> =
        those.map(|strategy| format!("{} {}", strategy.name, strategy.false_change_events)).collect();
    (!counts.is_empty())
        .then(|| format!("False change events on cells that never change: {}.", counts.join(", ")))
}

/// The strategy that learned the rates fastest, and whether the difference is significant.
fn winner(run: &Run) -> Option<String> {
    let area = |strategy: &StrategyResult| strategy.value(Measure::LOG_ERROR_AREA);
    let is_rival = |strategy: &&StrategyResult| strategy.name != REFERENCE && !area(strategy).is_nan();
    let mut ranked: Vec<&StrategyResult> = run.strategies.iter().filter(is_rival).collect();
    ranked.sort_by(|a, b| area(a).total_cmp(&area(b)));
    let [winner, next, ..] = ranked.as_slice() else { return None };
    let comparison = run.comparison(&winner.name, &next.name, Measure::LOG_ERROR_AREA)?;
    let certainty = match comparison.p_holm {
        p if p.is_nan() => "a single pair cannot be tested".into(),
        p if p < 0.05 => format!("significant: {} after Holm's correction", p_value(p)),
        p => format!("not significant: {} after Holm's correction", p_value(p)),
    };
    Some(format!(
        "{} learns rates fastest: its log error over the run is {} times that of {}\n({certainty}).",
        winner.name,
        value(comparison.ratio, 2),
        next.name
    ))
}
