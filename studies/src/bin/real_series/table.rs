//! Models beside each other.

use crate::Case;
use crate::models::Named;
use crate::score::HORIZONS;
use crate::series::LOOKS;
use evaluation::metrics::ProbabilityScores;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// What counts as as good as another, as a ratio of Brier scores.
const EQUAL: f64 = 1.02;

/// The Brier scores of all models by set, looks and horizon, averaged over the things of a set.
pub(crate) struct Table<'a> {
    models: &'a [Named],
    rows: BTreeMap<(&'a str, usize, usize), Vec<f64>>,
    /// All predictions of the clock.
    clock: ProbabilityScores,
}

impl<'a> Table<'a> {
    pub(crate) fn new(cases: &[Case<'a>], models: &'a [Named]) -> Self {
        let mut sums: BTreeMap<_, (Vec<f64>, f64)> = BTreeMap::new();
        let mut clock = ProbabilityScores::default();
        for case in cases {
            for horizon in (0..HORIZONS.len()).filter(|horizon| case.scores[0][*horizon].brier().is_some()) {
                let (sum, n) = sums
                    .entry((case.series.set(), case.looks, horizon))
                    .or_insert_with(|| (vec![0.0; models.len()], 0.0));
                for (sum, scores) in sum.iter_mut().zip(&case.scores) {
                    *sum += scores[horizon].brier().unwrap_or(f64::NAN);
                }
                *n += 1.0;
                clock.merge(&case.scores[0][horizon]);
            }
        }
        let mean = |(sums, n): (Vec<f64>, f64)| sums.into_iter().map(|sum| sum / n).collect();
        let rows = sums.into_iter().map(|(key, sums)| (key, mean(sums))).collect();
        Self { models, rows, clock }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The best baseline of a row.
    fn best(&self, row: &[f64]) -> (usize, f64) {
        let baselines = row.iter().copied().enumerate().filter(|(model, _)| self.models[*model].is_baseline);
        baselines.min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are baselines")
    }

    /// The geometric mean of a model's Brier score ÷ that of the best baseline.
    pub(crate) fn ratio(&self, model: usize) -> f64 {
        let logs = self.rows.values().map(|row| (row[model] / self.best(row).1).ln());
        (logs.sum::<f64>() / self.rows.len() as f64).exp()
    }

    /// The share of the rows in which the clock is at most 2 % worse than another.
    fn share_as_good(&self, other: impl Fn(&[f64]) -> f64) -> f64 {
        let as_good = self.rows.values().filter(|row| row[0] <= EQUAL * other(row)).count();
        100.0 * as_good as f64 / self.rows.len() as f64
    }

    fn index(&self, name: &str) -> usize {
        self.models.iter().position(|model| model.name == name).expect("the model is in the list")
    }

    pub(crate) fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let [last, chain] = ["last seen", "chain"].map(|name| self.index(name));
        writeln!(out, "Brier score\n")?;
        writeln!(out, "set              looks   ahead    clock   chain   last seen   best baseline")?;
        for ((set, looks, horizon), row) in &self.rows {
            let (best, brier) = self.best(row);
            writeln!(
                out,
                "{set:16} {:7} {:7} {:6.4}  {:6.4}  {:6.4}      {brier:6.4}  {}",
                LOOKS[*looks].0, HORIZONS[*horizon].0, row[0], row[chain], row[last], self.models[best].name
            )?;
        }
        writeln!(
            out,
            "\nBrier score ÷ that of the best baseline, geometric mean over {} cases\n",
            self.rows.len()
        )?;
        for (index, model) in self.models.iter().enumerate() {
            writeln!(out, "{:28} {:.3}", model.name, self.ratio(index))?;
        }
        let (best, chain) =
            (self.share_as_good(|row| self.best(row).1), self.share_as_good(|row| row[chain]));
        writeln!(
            out,
            "\nclock: within 2 % of the best baseline in {best:.0} % of the cases, at most 2 % worse than the chain in {chain:.0} %"
        )?;
        let calibration_error = self.clock.calibration_error().unwrap_or(f64::NAN);
        writeln!(out, "clock: expected calibration error {calibration_error:.3}")
    }
}
