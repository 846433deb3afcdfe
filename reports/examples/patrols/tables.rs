//! The tables of a study as text: scores and delays, and how far from the lower bound.

use crate::cells::{Cell, Named, cells};
use crate::rows::Row;
use crate::runs::Outcome;
use reports::pages::mean;

/// Prints the tables of sorted rows.
pub(crate) fn print(rows: &[Row]) {
    for cell in cells(rows) {
        cell.print();
        cell.print_regrets();
    }
}

impl Cell<'_> {
    fn print(&self) {
        let strategies = self.strategies();
        let seeds = self.seeds(&strategies);
        if strategies.is_empty() || seeds.is_empty() {
            return;
        }
        println!(
            "\n{}, habits {}, patrol {} % of the time, {} days, {} buildings",
            self.kind.name(),
            self.things.name(),
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

    fn print_regrets(&self) {
        let strategies = self.strategies();
        let Some(bounded) = self.bounded(&strategies) else { return };
        let bound = bounded.bound();
        println!("{} buildings with a bound, which is {bound:.4}", bounded.seeds.len());
        println!(
            "{:<14} {:>9} {:>8} {:>21} {:>21} {:>21}",
            "strategy", "B ÷ bound", "regret", "÷curious", "÷round", "÷coverage"
        );
        let others =
            ["curious", "round", "coverage"].map(|name| self.best(name, &strategies, &bounded.seeds));
        for named in &strategies {
            let own = self.regrets(named, &bounded);
            let [to_curious, to_round, to_coverage] = others.map(|other| {
                other.map_or(String::new(), |other| compared(&own, &self.regrets(other, &bounded)))
            });
            println!(
                "{:<14} {:>9.3} {:>8.3} {to_curious:>21} {to_round:>21} {to_coverage:>21}",
                self.name(named, &strategies),
                mean(&self.values(named, &bounded.seeds, |outcome| outcome.brier)) / bound,
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
