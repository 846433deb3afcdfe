//! The tables for a terminal of 80 columns.

use super::builder::{Run, conditions};
use super::comparison::Comparison;
use super::strategy::{Measure, StrategyResult};
use super::{ONE_BY_ONE, Report, is_reference};
use evaluation::trials::Metric;
use results::numbers::percent;
use tabled::Table;
use tabled::settings::object::Columns;
use tabled::settings::{Alignment, Padding, Span, Style};

const HOW_TO_READ_GRID: &str = "\
How to read it: errors are 0 and map correct is 1 at best; final is the value at
the end, area the mean over the run, * the best; time at changes is the share of
steps with a changing cell in view.
";
const HOW_TO_READ_PHYSICS: &str = "\
How to read it: errors are 0, map correct and AUC are 1 at best; final is the
value at the end, area the mean over the run, * the best; AUC tells how well the
rates separate changing cells from static cells, seen is the share of the cells
that can be seen. Predictions: deviance is 1 for rates that predict the events
to come, 0 for the best constant, or for the known one; passages are those per
hour in squares of half a meter, busiest the share of their busiest tenth that
is found; Brier scores of cells out of view, 0 at best.
";

/// Longer names are broken at their hyphens beside the differences.
const LONG_NAME: usize = 12;

/// The meaning of a column.
#[derive(Clone, Copy)]
enum Kind {
    Error,
    Quality,
    Share,
}

/// The group, the name, the numbers and their meaning; a group continues where its name is empty.
type Column = (&'static str, &'static str, Measure, Kind);

const GRID_COLUMNS: [Column; 7] = [
    ("log error", "final", Measure::Final(Metric::LogError), Kind::Error),
    ("", "area", Measure::Area(Metric::LogError), Kind::Error),
    ("rate error", "final", Measure::Final(Metric::RateError), Kind::Error),
    ("", "area", Measure::Area(Metric::RateError), Kind::Error),
    ("map correct", "all cells", Measure::Final(Metric::MapQuality), Kind::Quality),
    ("", "changing", Measure::Final(Metric::MapQualityChanging), Kind::Quality),
    ("time at", "changes", Measure::Final(Metric::ChangingShare), Kind::Share),
];
const PHYSICS_COLUMNS: [Column; 6] = [
    ("log error", "final", Measure::Final(Metric::LogError), Kind::Error),
    ("", "area", Measure::Area(Metric::LogError), Kind::Error),
    ("rate", "AUC", Measure::Final(Metric::RateAuc), Kind::Quality),
    ("map correct", "all cells", Measure::Final(Metric::MapQuality), Kind::Quality),
    ("", "changing", Measure::Final(Metric::MapQualityChanging), Kind::Quality),
    ("cells", "seen", Measure::Final(Metric::Coverage), Kind::Share),
];
/// How well the rates and the map predict.
const PREDICTION_COLUMNS: [Column; 6] = [
    ("deviance", "of best", Measure::Final(Metric::PredictiveDeviance), Kind::Quality),
    ("", "of known", Measure::Final(Metric::PredictiveDevianceKnown), Kind::Quality),
    ("passages", "log error", Measure::Final(Metric::PassagesLogError), Kind::Error),
    ("", "busiest", Measure::Final(Metric::BusiestTenthHit), Kind::Quality),
    ("Brier score", "predicted", Measure::Area(Metric::Brier), Kind::Error),
    ("", "last seen", Measure::Area(Metric::BrierLastSeen), Kind::Error),
];

/// The columns of the differences, with their decimals.
const DIFFERENCES: [(&str, Measure, usize); 3] = [
    ("log error, area", Measure::Area(Metric::LogError), 3),
    ("log error, final", Measure::Final(Metric::LogError), 3),
    ("map correct, final", Measure::Final(Metric::MapQuality), 4),
];

/// A count of a strategy, and what it is.
type Count = (&'static str, fn(&StrategyResult) -> u64);

/// The counts that are named where a strategy has any.
const COUNTS: [Count; 3] = [
    ("False change events on cells that never change", |strategy| strategy.false_change_events),
    ("False changes of the map on these cells, with corrections", |strategy| strategy.false_map_changes),
    ("Contacts of the robot by its own motion", |strategy| strategy.collisions.unwrap_or(0)),
];

impl Report {
    /// The tables for a terminal, with 80 columns if the names of the strategies are not too long; with many
    /// worlds, and with worlds of one trial each, only the runs over all worlds.
    pub fn table(&self) -> String {
        if self.runs.is_empty() {
            return "No trial was finished.\n".into();
        }
        let length = self.settings.length;
        let columns = length.choose(&GRID_COLUMNS[..], &PHYSICS_COLUMNS);
        let is_short = self.leaves_out_worlds();
        let mut text = String::new();
        if self.settings.interrupted {
            let finished = self.finished;
            text = format!(
                "Interrupted: {finished} of {} trials were finished.\n\n",
                self.settings.all_trials()
            );
        }
        for run in self.runs.iter().filter(|run| !is_short || run.worlds > 1) {
            let counts = COUNTS.iter().filter_map(|(what, count)| counts(run, what, count));
            let conclusions = counts.chain(winner(run));
            let paragraphs = [
                format!("{}\n{}", run.world, conditions(run, &self.settings)),
                values(&run.strategies, columns),
                values(&run.strategies, length.choose(&[][..], &PREDICTION_COLUMNS)),
                differences(run).unwrap_or_default(),
                conclusions.collect::<Vec<_>>().join("\n"),
            ];
            for line in
                paragraphs.iter().filter(|text| !text.is_empty()).flat_map(|text| text.lines().chain([""]))
            {
                text.extend([line.trim_end(), "\n"]);
            }
        }
        text.push_str(length.choose(HOW_TO_READ_GRID, HOW_TO_READ_PHYSICS));
        text
    }

    /// Whether the tables leave out the single worlds; `report.json` has them.
    pub fn leaves_out_worlds(&self) -> bool {
        let is_one_of_many =
            |run: &Run| run.worlds > ONE_BY_ONE || run.worlds > 1 && self.settings.trials == 1;
        self.runs.iter().any(is_one_of_many)
    }
}

/// Columns of numbers beside the names.
fn aligned(rows: Vec<Vec<String>>) -> Table {
    let mut table = Table::from_iter(rows);
    table.with(Style::empty()).with(Alignment::right()).with(Padding::new(2, 0, 0, 0));
    table.modify(Columns::first(), Alignment::left()).modify(Columns::first(), Padding::zero());
    table
}

/// A row per strategy, if there are columns.
fn values(strategies: &[StrategyResult], columns: &[Column]) -> String {
    if columns.is_empty() {
        return String::new();
    }
    let head = |name: &str, of: fn(&Column) -> String| {
        [name.to_owned()].into_iter().chain(columns.iter().map(of)).collect()
    };
    let mut rows = vec![
        head("", |(group, ..)| (*group).to_owned()),
        head("strategy", |(_, name, ..)| (*name).to_owned()),
    ];
    rows.extend(strategies.iter().map(|strategy| vec![strategy.name.clone()]));
    for &(_, _, measure, kind) in columns {
        let cells = cells(strategies, measure, kind);
        rows[2..].iter_mut().zip(cells).for_each(|(row, cell)| row.push(cell));
    }
    let mut table = aligned(rows);
    for (column, _) in columns.iter().enumerate().filter(|(_, (_, name, ..))| {
        ["final", "all cells", "of best", "log error", "predicted"].contains(name)
    }) {
        table.modify((0, column + 1), Span::column(2)).modify((0, column + 1), Alignment::center());
    }
    table.to_string()
}

/// The strategies that can be the best.
fn rivals(strategies: &[StrategyResult]) -> impl Iterator<Item = &StrategyResult> + Clone {
    strategies.iter().filter(|strategy| !is_reference(&strategy.name))
}

/// Whether all rivals have the same trials, or worlds: after an interruption, means can be those of different ones.
fn have_same_units(strategies: &[StrategyResult]) -> bool {
    let keys =
        |strategy: &StrategyResult| -> Vec<u64> { strategy.units.iter().map(|unit| unit.key).collect() };
    let mut all = rivals(strategies).map(keys);
    let first = all.next();
    all.all(|keys| first.as_ref() == Some(&keys))
}

/// One number per strategy; a star marks the best number, and numbers that are printed the same. Means of different trials have no
/// best.
fn cells(strategies: &[StrategyResult], measure: Measure, kind: Kind) -> impl Iterator<Item = String> {
    let text = move |number: f64| match kind {
        Kind::Error => value(number, 3),
        Kind::Quality => value(number, 4),
        Kind::Share if number.is_nan() => "-".into(),
        Kind::Share => percent(number),
    };
    let rivals = rivals(strategies);
    let numbers = rivals.clone().map(|strategy| strategy.value(measure));
    let best = match kind {
        Kind::Error => numbers.fold(f64::NAN, f64::min),
        Kind::Quality => numbers.fold(f64::NAN, f64::max),
        Kind::Share => f64::NAN,
    };
    // What is the same for all has no best.
    let mut texts = rivals.map(|strategy| text(strategy.value(measure)));
    let first = texts.next();
    let differs = texts.any(|text| first.as_ref() != Some(&text));
    let best = (!best.is_nan() && differs && have_same_units(strategies)).then(|| text(best));
    strategies.iter().map(move |strategy| {
        let text = text(strategy.value(measure));
        let is_best = best.as_ref() == Some(&text) && !is_reference(&strategy.name);
        text + if is_best { "*" } else { " " }
    })
}

/// The first strategy against every other.
fn differences(run: &Run) -> Option<String> {
    let (first, others) = run.strategies.split_first().filter(|(_, others)| !others.is_empty())?;
    let mut rows = vec![vec![String::new()]];
    rows[0].extend(DIFFERENCES.map(|(name, ..)| name.to_owned()));
    for other in others {
        let is_long = other.name.chars().count() > LONG_NAME;
        let mut row = vec![if is_long { other.name.replace('-', "-\n") } else { other.name.clone() }];
        row.extend(DIFFERENCES.map(|(_, measure, decimals)| {
            let Some(found) = run.comparison(&first.name, &other.name, measure) else { return "-".into() };
            let mean = difference(found.mean_difference, decimals);
            if found.p_value.is_nan() {
                return mean;
            }
            let half_width = value((found.high - found.low) / 2.0, decimals);
            let p_value = p_value(found.p_value).replace(['p', '=', ' '], "");
            format!("{mean} ±{half_width} {p_value:>6}")
        }));
        rows.push(row);
    }
    let over = if run.worlds > 1 { "worlds" } else { "seeds" };
    let head = match first.trials {
        1 => format!("Differences, {} minus the other; one trial has no interval and no test", first.name),
        _ => format!(
            "Paired differences over {over}, {} minus the other: mean ± half of its\n\
             95 % interval, p-value of the t test",
            first.name
        ),
    };
    Some(format!("{head}\n{}", aligned(rows)))
}

/// A count of the strategies for which it is above zero.
fn counts(run: &Run, what: &str, count: impl Fn(&StrategyResult) -> u64) -> Option<String> {
    let those = run.strategies.iter().filter(|strategy| count(strategy) > 0);
    let counts: Vec<String> =
        those.map(|strategy| format!("{} {}", strategy.name, count(strategy))).collect();
    (!counts.is_empty()).then(|| format!("{what}: {}.", counts.join(", ")))
}

/// The strategy with the smallest error of the rates, and whether the next one is significantly worse; `None` where means are those
/// of different trials, or pairs say otherwise.
fn winner(run: &Run) -> Option<String> {
    let error = |strategy: &&StrategyResult| strategy.value(Measure::PRIMARY);
    let mut ranked: Vec<_> = rivals(&run.strategies).filter(|strategy| !error(strategy).is_nan()).collect();
    ranked.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let [winner, next, ..] = ranked[..] else { return None };
    let comparison = run.comparison(&winner.name, &next.name, Measure::PRIMARY);
    let Comparison { a: winner, b: next, p_holm, ratio, .. } =
        comparison.filter(|found| found.mean_difference <= 0.0 && have_same_units(&run.strategies))?;
    let ratio = value(ratio, 2);
    let smallest = format!("{winner} has the smallest log error over the run, {ratio} times\nthat of {next}");
    Some(match p_holm {
        p if p.is_nan() => format!("{smallest}; a single pair cannot be tested."),
        p if p < 0.05 => format!(
            "{winner} learns rates fastest: its log error over the run is {ratio} times\n\
             that of {next} (significant: {} after Holm's correction).",
            p_value(p)
        ),
        p => format!(
            "{smallest}; the difference is not significant\n({} after Holm's correction).",
            p_value(p)
        ),
    })
}

/// A value with `decimals`; a dash where it is not a number.
fn value(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "-".into() }
}

/// A difference, with its sign; zero has none.
fn difference(value: f64, decimals: usize) -> String {
    let text = if value.is_finite() { format!("{value:+.decimals$}") } else { return "-".into() };
    let is_zero = !text.contains(|letter: char| ('1'..='9').contains(&letter));
    if is_zero { text.replace(['+', '-'], " ") } else { text }
}

/// `p = 0.012`, or `p < 0.001`.
fn p_value(p_value: f64) -> String {
    if p_value < 0.001 { "p < 0.001".into() } else { format!("p = {p_value:.3}") }
}
