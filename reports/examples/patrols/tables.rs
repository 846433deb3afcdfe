//! The tables of a study: scores and delays, and how far from the lower bound.

use crate::rows::Row;
use crate::runs::{BOUND, NO_LOOKS, Outcome, STRATEGIES};
use days::{Habits, Kind};
use evaluation::metrics::freshness_regret;
use std::collections::BTreeSet;

/// All rows of a kind of building, of a robot that knows the habits or not, and of a share of the time.
struct Cell<'a> {
    kind: Kind,
    habits: Habits,
    share: f64,
    days: f64,
    rows: &'a [Row],
}

/// A strategy, with a length of its patrols.
#[derive(Clone, PartialEq)]
struct Named {
    strategy: String,
    length_min: Option<f64>,
}

/// Prints the tables of all rows.
pub(crate) fn print(mut rows: Vec<Row>) {
    let place = |kind: Kind| Kind::ALL.iter().position(|other| other.1 == kind);
    let habits = |habits: Habits| Habits::ALL.iter().position(|other| other.1 == habits);
    let strategy = |row: &Row| STRATEGIES.iter().position(|name| *name == row.run.strategy);
    rows.sort_by(|a, b| {
        let key = |row: &Row| (place(row.run.kind), habits(row.run.habits));
        let cell = key(a)
            .cmp(&key(b))
            .then(b.run.share.total_cmp(&a.run.share))
            .then(a.run.days.total_cmp(&b.run.days));
        let lengths = [a, b].map(|row| row.run.length_min.unwrap_or(0.0));
        cell.then(strategy(a).cmp(&strategy(b)))
            .then(lengths[0].total_cmp(&lengths[1]))
            .then(a.run.seed.cmp(&b.run.seed))
    });
    rows.dedup_by(|a, b| a.run == b.run);
    for group in rows.chunk_by(|a, b| {
        let key = |row: &Row| (row.run.kind, row.run.habits, row.run.share, row.run.days);
        key(a) == key(b)
    }) {
        let first = &group[0].run;
        let cell = Cell {
            kind: first.kind,
            habits: first.habits,
            share: first.share,
            days: first.days,
            rows: group,
        };
        cell.print();
        cell.print_regrets(&rows);
    }
}

fn mean(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    finite.iter().sum::<f64>() / finite.len() as f64
}

impl Cell<'_> {
    /// The strategies of the cell, in the order of the table.
    fn strategies(&self) -> Vec<Named> {
        let mut all: Vec<Named> = Vec::new();
        for row in self.rows.iter().filter(|row| row.run.strategy != BOUND) {
            let named = Named { strategy: row.run.strategy.clone(), length_min: row.run.length_min };
            if !all.contains(&named) {
                all.push(named);
            }
        }
        all
    }

    fn outcome(&self, named: &Named, seed: u64) -> Option<Outcome> {
        let row = self.rows.iter().find(|row| {
            row.run.seed == seed
                && row.run.strategy == named.strategy
                && row.run.length_min == named.length_min
        });
        row.map(|row| row.outcome)
    }

    /// The seeds of the buildings in which every strategy was run.
    fn seeds(&self, strategies: &[Named]) -> Vec<u64> {
        let all: BTreeSet<u64> = self.rows.iter().map(|row| row.run.seed).collect();
        let is_whole = |seed: &u64| strategies.iter().all(|named| self.outcome(named, *seed).is_some());
        all.into_iter().filter(is_whole).collect()
    }

    fn values(&self, named: &Named, seeds: &[u64], value: impl Fn(&Outcome) -> f64) -> Vec<f64> {
        seeds.iter().filter_map(|seed| self.outcome(named, *seed)).map(|outcome| value(&outcome)).collect()
    }

    /// The name, with the length where there are several.
    fn name(&self, named: &Named, strategies: &[Named]) -> String {
        let alike = strategies.iter().filter(|other| other.strategy == named.strategy).count();
        match named.length_min {
            Some(length_min) if alike > 1 => format!("{} {length_min}", named.strategy),
            _ => named.strategy.clone(),
        }
    }

    /// The strategy of this name with the least mean score.
    fn best<'n>(&self, name: &str, strategies: &'n [Named], seeds: &[u64]) -> Option<&'n Named> {
        let score = |named: &Named| mean(&self.values(named, seeds, |outcome| outcome.brier));
        let named = strategies.iter().filter(|named| named.strategy == name);
        named.min_by(|a, b| score(a).total_cmp(&score(b)))
    }

    fn print(&self) {
        let strategies = self.strategies();
        let seeds = self.seeds(&strategies);
        if strategies.is_empty() || seeds.is_empty() {
            return;
        }
        println!(
            "\n{}, habits {}, patrol {} % of the time, {} days, {} buildings",
            self.kind.name(),
            self.habits.name(),
            100.0 * self.share,
            self.days,
            seeds.len()
        );
        println!(
            "{:<14} {:>8} {:>21} {:>21} {:>21} {:>7} {:>7} {:>7} {:>8} {:>7} {:>7} {:>9}",
            "strategy",
            "Brier",
            "÷curious",
            "÷round",
            "÷coverage",
            "median",
            "95 %",
            "missed",
            "driving",
            "closed",
            "lost",
            "not made"
        );
        let others = ["curious", "round", "coverage"].map(|name| self.best(name, &strategies, &seeds));
        for named in &strategies {
            let brier = |named: &Named| self.values(named, &seeds, |outcome| outcome.brier);
            let [to_curious, to_round, to_coverage] = others
                .map(|other| other.map_or(String::new(), |other| compared(&brier(named), &brier(other))));
            let column = |value: fn(&Outcome) -> f64| mean(&self.values(named, &seeds, value));
            println!(
                "{:<14} {:>8.4} {to_curious:>21} {to_round:>21} {to_coverage:>21} {:>6.0}m {:>6.0}m {:>6.1}% {:>7.2}% {:>6.1}% {:>6.2}s {:>8.2}%",
                self.name(named, &strategies),
                mean(&brier(named)),
                column(|outcome| outcome.delays_min[0]),
                column(|outcome| outcome.delays_min[1]),
                100.0 * column(|outcome| outcome.missed),
                100.0 * column(|outcome| outcome.patrol),
                100.0 * column(|outcome| outcome.closed),
                column(|outcome| outcome.lost_s),
                100.0 * column(|outcome| outcome.not_made),
            );
        }
    }

    /// Bound, and regrets in the buildings that have one. Bound and scores without looks are those of known habits.
    fn print_regrets(&self, all: &[Row]) {
        let strategies = self.strategies();
        let known = |seed: u64, strategy: &str| {
            let row = all.iter().find(|row| {
                let run = &row.run;
                run.seed == seed
                    && run.strategy == strategy
                    && run.habits == Habits::Known
                    && (run.kind, run.share, run.days) == (self.kind, self.share, self.days)
            });
            row.map(|row| row.outcome.brier)
        };
        let seeds = self.seeds(&strategies).into_iter();
        let ends = seeds.filter_map(|seed| Some((seed, known(seed, BOUND)?, known(seed, NO_LOOKS)?)));
        let ends: Vec<(u64, f64, f64)> = ends.collect();
        if ends.is_empty() {
            return;
        }
        let seeds: Vec<u64> = ends.iter().map(|end| end.0).collect();
        let bound = mean(&ends.iter().map(|end| end.1).collect::<Vec<f64>>());
        println!("{} buildings with a bound, which is {bound:.4}", seeds.len());
        println!(
            "{:<14} {:>9} {:>8} {:>21} {:>21} {:>21}",
            "strategy", "B ÷ bound", "regret", "÷curious", "÷round", "÷coverage"
        );
        let regrets = |named: &Named| -> Vec<f64> {
            let scores = self.values(named, &seeds, |outcome| outcome.brier);
            scores.iter().zip(&ends).map(|(score, end)| freshness_regret(*score, end.1, end.2)).collect()
        };
        let others = ["curious", "round", "coverage"].map(|name| self.best(name, &strategies, &seeds));
        for named in &strategies {
            let own = regrets(named);
            let [to_curious, to_round, to_coverage] =
                others.map(|other| other.map_or(String::new(), |other| compared(&own, &regrets(other))));
            println!(
                "{:<14} {:>9.3} {:>8.3} {to_curious:>21} {to_round:>21} {to_coverage:>21}",
                self.name(named, &strategies),
                mean(&self.values(named, &seeds, |outcome| outcome.brier)) / bound,
                mean(&own)
            );
        }
    }
}

/// The ratio of two means, with the p-value of the paired t test.
fn compared(values: &[f64], others: &[f64]) -> String {
    let test = reports::paired_test(values.iter().zip(others).map(|(value, other)| value - other));
    format!("{:.3}, p = {:.1e}", mean(values) / mean(others), test.p_value)
}
