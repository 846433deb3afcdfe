//! The table for a person at a terminal.

use super::claim::Claim;
use super::comparison::Comparison;
use super::metric::{Measure, Metric, Part};
use super::run::{Run, StrategyResult};
use super::wording::{difference, p_value, title, value};
use super::{ONE_BY_ONE, REFERENCE, Report};
use std::fmt::Write;

/// Which way a column is good.
#[derive(Clone, Copy)]
enum Best {
    Lowest,
    Highest,
    Neither,
}

struct Column {
    group: &'static str,
    name: &'static str,
    measure: Measure,
    best: Best,
    decimals: usize,
    width: usize,
}

/// What share of its time a robot had changing cells in view.
const CHANGING_SHARE: Measure = Measure { metric: Metric::ChangingShare, part: Part::Final };

const COLUMNS: [Column; 7] = [
    Column::error("log error", "final", Measure::FINAL_LOG_ERROR),
    Column::error("", "area", Measure::LOG_ERROR_AREA),
    Column::error("rate error", "final", Measure::FINAL_RATE_ERROR),
    Column::error("", "area", Measure::RATE_ERROR_AREA),
    Column::quality("map quality", "all cells", Measure::FINAL_MAP_QUALITY),
    Column::quality("", "changing", Measure::FINAL_MAP_QUALITY_CHANGING),
    Column {
        group: "time at",
        name: "changes",
        measure: CHANGING_SHARE,
        best: Best::Neither,
        decimals: 3,
        width: 10,
    },
];

impl Column {
    const fn error(group: &'static str, name: &'static str, measure: Measure) -> Self {
        Self { group, name, measure, best: Best::Lowest, decimals: 3, width: 11 }
    }

    const fn quality(group: &'static str, name: &'static str, measure: Measure) -> Self {
        Self { group, name, measure, best: Best::Highest, decimals: 4, width: 12 }
    }

    /// A number per strategy; the best with a star, and what looks like it.
    fn cells(&self, strategies: &[StrategyResult]) -> Vec<String> {
        let value_of = |strategy: &StrategyResult| strategy.value(self.measure);
        let numbers = strategies.iter().filter(|strategy| strategy.name != REFERENCE).map(value_of);
        let best = match self.best {
            Best::Lowest => numbers.fold(f64::NAN, f64::min),
            Best::Highest => numbers.fold(f64::NAN, f64::max),
            Best::Neither => f64::NAN,
        };
        let cell = |strategy: &StrategyResult| {
            let text = value(value_of(strategy), self.decimals);
            let is_best =
                best.is_finite() && text == value(best, self.decimals) && strategy.name != REFERENCE;
            format!("{text}{}", if is_best { "*" } else { " " })
        };
        strategies.iter().map(cell).collect()
    }
}

/// The tables of all runs, or of the one over all worlds where there are many.
pub(super) fn table(report: &Report) -> String {
    if report.runs.is_empty() {
        return "No trial was finished: there is nothing to report.\n".into();
    }
    let mut text = String::new();
    let worlds = report.runs.iter().map(|run| run.worlds).max().unwrap_or(1);
    let is_short = worlds > ONE_BY_ONE;
    for run in report.runs.iter().filter(|run| !is_short || run.worlds > 1) {
        write_run(&mut text, report, run);
        text.push('\n');
    }
    text.push_str(
        "How to read it: an error of 0 is perfect and a map quality of 1; area is the mean over the run,\n\
         final the value at its end, * the best.\n",
    );
    if is_short {
        text.push_str("The worlds one by one are in report.json.\n");
    }
    text
}

fn write_run(text: &mut String, report: &Report, run: &Run) {
    let strategies = &run.strategies;
    let name_width =
        strategies.iter().map(|strategy| strategy.name.chars().count()).max().unwrap_or(0).max(8);
    // Infallible: this writes to a string.
    let mut line = |line: String| text.extend([line.trim_end(), "\n"]);
    line(title(run, &report.settings));
    line(String::new());
    let head = |word: fn(&Column) -> &'static str| -> String {
        COLUMNS.iter().map(|column| format!("{:>1$} ", word(column), column.width - 1)).collect()
    };
    line(format!("{:name_width$}{}", "", head(|column| column.group)));
    line(format!("{:name_width$}{}", "strategy", head(|column| column.name)));
    let columns: Vec<Vec<String>> = COLUMNS.iter().map(|column| column.cells(strategies)).collect();
    for (row, strategy) in strategies.iter().enumerate() {
        let cells =
            COLUMNS.iter().zip(&columns).map(|(column, cells)| format!("{:>1$}", cells[row], column.width));
        line(format!("{:name_width$}{}", strategy.name, cells.collect::<String>()));
    }
    line(String::new());
    if let [first, others @ ..] = strategies.as_slice()
        && !others.is_empty()
    {
        line(format!(
            "{} minus another: mean difference ± half of its 95 % interval, paired t test",
            first.name
        ));
        line(format!(
            "{:name_width$}{:>26}{:>26}{:>26}",
            "", "log error, area", "log error, final", "map quality, final"
        ));
        for other in others {
            let cell = |measure, decimals| {
                let comparison = run.comparison(&first.name, &other.name, measure);
                comparison.map_or("-".into(), |comparison| difference_cell(&comparison, decimals))
            };
            line(format!(
                "{:name_width$}{:>26}{:>26}{:>26}",
                other.name,
                cell(Measure::LOG_ERROR_AREA, 3),
                cell(Measure::FINAL_LOG_ERROR, 3),
                cell(Measure::FINAL_MAP_QUALITY, 4),
            ));
        }
        line(String::new());
    }
    if let Some(winner) = winner(run) {
        line(winner);
    }
    if let Some(claim) = Claim::of(run) {
        line(format!("The paper's claim here: {}.", claim.verdict));
    }
}

fn difference_cell(comparison: &Comparison, decimals: usize) -> String {
    let mean = difference(comparison.mean_difference, decimals);
    if comparison.p_value.is_nan() {
        return mean;
    }
    let half_width = value((comparison.high - comparison.low) / 2.0, decimals);
    format!("{mean} ±{half_width} {}", p_value(comparison.p_value))
}

/// Who learned the rates fastest, and whether that may be chance.
fn winner(run: &Run) -> Option<String> {
    let area = |strategy: &StrategyResult| strategy.value(Measure::LOG_ERROR_AREA);
    let mut ranked: Vec<&StrategyResult> = run
        .strategies
        .iter()
        .filter(|strategy| strategy.name != REFERENCE && !area(strategy).is_nan())
        .collect();
    ranked.sort_by(|a, b| area(a).total_cmp(&area(b)));
    let [winner, next, ..] = ranked.as_slice() else { return None };
    let comparison = run.comparison(&winner.name, &next.name, Measure::LOG_ERROR_AREA)?;
    let certainty = match comparison.p_holm {
        p if p.is_nan() => "one pair of trials: it may be chance".into(),
        p if p < 0.05 => format!("significant, {} after Holm's correction", p_value(p)),
        p => format!("not significant, {} after Holm's correction", p_value(p)),
    };
    let less = 100.0 * (1.0 - comparison.ratio);
    Some(format!(
        "{} learns the rates fastest: its log error over the run is {less:.0} % below that of {}\n({certainty}).",
        winner.name, next.name
    ))
}
