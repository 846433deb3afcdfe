//! The rows of a study, by kind of building, knowledge of the habits, and share of the time.

use crate::rows::Row;
use crate::runs::{BOUND, NO_LOOKS, Outcome, STRATEGIES, Things};
use days::{Habits, Kind};
use evaluation::metrics::freshness_regret;
use reports::pages::mean;
use std::collections::BTreeSet;

/// All rows of a kind of building, of what the things do and the robot knows, and of a share of the time.
pub(crate) struct Cell<'a> {
    pub(crate) kind: Kind,
    pub(crate) things: Things,
    pub(crate) share: f64,
    pub(crate) days: f64,
    pub(crate) rows: &'a [Row],
    /// The rows of all cells.
    all: &'a [Row],
}

/// A strategy, with a length of its patrols.
#[derive(Clone, PartialEq)]
pub(crate) struct Named {
    pub(crate) strategy: String,
    pub(crate) length_min: Option<f64>,
}

/// The buildings of a cell that have a bound, and the ends of its scale in each: the bound and the score without looks, both of a robot that knows the habits.
pub(crate) struct Bounded {
    pub(crate) seeds: Vec<u64>,
    ends: Vec<[f64; 2]>,
}

/// Sorts the rows, without those that are there twice.
pub(crate) fn sort(rows: &mut Vec<Row>) {
    let place = |kind: Kind| Kind::ALL.iter().position(|other| other.1 == kind);
    let strategy = |row: &Row| STRATEGIES.iter().position(|name| *name == row.run.strategy);
    rows.sort_by(|a, b| {
        let key = |row: &Row| (place(row.run.kind), row.run.things.place());
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
}

/// The cells of sorted rows, in their order.
pub(crate) fn cells(rows: &[Row]) -> impl Iterator<Item = Cell<'_>> {
    let key = |row: &Row| (row.run.kind, row.run.things, row.run.share, row.run.days);
    rows.chunk_by(move |a, b| key(a) == key(b)).map(|group| {
        let first = &group[0].run;
        Cell {
            kind: first.kind,
            things: first.things,
            share: first.share,
            days: first.days,
            rows: group,
            all: rows,
        }
    })
}

impl Cell<'_> {
    /// The strategies of the cell, in the order of the table.
    pub(crate) fn strategies(&self) -> Vec<Named> {
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
    pub(crate) fn seeds(&self, strategies: &[Named]) -> Vec<u64> {
        let all: BTreeSet<u64> = self.rows.iter().map(|row| row.run.seed).collect();
        let is_whole = |seed: &u64| strategies.iter().all(|named| self.outcome(named, *seed).is_some());
        all.into_iter().filter(is_whole).collect()
    }

    pub(crate) fn values(&self, named: &Named, seeds: &[u64], value: impl Fn(&Outcome) -> f64) -> Vec<f64> {
        seeds.iter().filter_map(|seed| self.outcome(named, *seed)).map(|outcome| value(&outcome)).collect()
    }

    /// The name, with the length where there are several.
    pub(crate) fn name(&self, named: &Named, strategies: &[Named]) -> String {
        let alike = strategies.iter().filter(|other| other.strategy == named.strategy).count();
        match named.length_min {
            Some(length_min) if alike > 1 => format!("{} {length_min}", named.strategy),
            _ => named.strategy.clone(),
        }
    }

    /// The strategy of this name with the least mean score.
    pub(crate) fn best<'n>(&self, name: &str, strategies: &'n [Named], seeds: &[u64]) -> Option<&'n Named> {
        let score = |named: &Named| mean(&self.values(named, seeds, |outcome| outcome.brier));
        let named = strategies.iter().filter(|named| named.strategy == name);
        named.min_by(|a, b| score(a).total_cmp(&score(b)))
    }

    /// The buildings with a bound, of those in which every strategy was run; `None` if there are no such buildings.
    pub(crate) fn bounded(&self, strategies: &[Named]) -> Option<Bounded> {
        let known = |seed: u64, strategy: &str| {
            let row = self.all.iter().find(|row| {
                let run = &row.run;
                run.seed == seed
                    && run.strategy == strategy
                    && run.things == Things::Generated(Habits::Known)
                    && (run.kind, run.share, run.days) == (self.kind, self.share, self.days)
            });
            row.map(|row| row.outcome.brier)
        };
        let seeds = self.seeds(strategies).into_iter();
        let (seeds, ends): (Vec<u64>, Vec<[f64; 2]>) =
            seeds.filter_map(|seed| Some((seed, [known(seed, BOUND)?, known(seed, NO_LOOKS)?]))).unzip();
        (!seeds.is_empty()).then_some(Bounded { seeds, ends })
    }

    /// The freshness regret of a strategy in each of these buildings.
    pub(crate) fn regrets(&self, named: &Named, bounded: &Bounded) -> Vec<f64> {
        let scores = self.values(named, &bounded.seeds, |outcome| outcome.brier);
        let regret = |(score, [bound, none]): (&f64, &[f64; 2])| freshness_regret(*score, *bound, *none);
        scores.iter().zip(&bounded.ends).map(regret).collect()
    }
}

impl Bounded {
    /// The mean of the bounds.
    pub(crate) fn bound(&self) -> f64 {
        mean(&self.ends.iter().map(|end| end[0]).collect::<Vec<f64>>())
    }
}
