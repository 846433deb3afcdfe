//! The second table: how far from the lower bound of all strategies.

use days::{Building, Duty, Kind};
use evaluation::freshness_bound::building::{BoundSettings, BuildingBound};
use evaluation::metrics::freshness_regret;
use rayon::prelude::*;
use std::io::Write;
use std::path::Path;

/// The Brier scores of all strategies in the buildings of a kind.
pub(crate) struct Scores {
    pub(crate) place: String,
    /// The share of the time that the robot can be on patrol.
    pub(crate) share: f64,
    pub(crate) seeds: Vec<u64>,
    /// The names of the strategies; the first one never looks.
    pub(crate) plans: Vec<String>,
    /// By strategy, then by building.
    pub(crate) briers: Vec<Vec<f64>>,
    /// By building; empty if they were not computed.
    pub(crate) bounds: Vec<f64>,
}

/// The lower bound in the week of each seed.
pub(crate) fn bounds(kind: Kind, duty: Duty, seeds: &[u64], steps: usize) -> Vec<f64> {
    let bound = |seed: &u64| {
        let building = Building::generate(kind, *seed);
        BuildingBound::new(&building, duty, steps, BoundSettings::of(&building, duty)).brier(*seed)
    };
    seeds.par_iter().map(bound).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl Scores {
    /// The regret of a strategy in each building.
    fn regrets(&self, plan: usize) -> Vec<f64> {
        let building =
            |at: usize| freshness_regret(self.briers[plan][at], self.bounds[at], self.briers[0][at]);
        (0..self.bounds.len()).map(building).collect()
    }

    /// Prints bound and regrets, against two strategies.
    pub(crate) fn print(&self, [curious, round]: [usize; 2]) {
        if self.bounds.is_empty() {
            return;
        }
        println!(
            "bound {:.4}, {:.3} of no looks",
            mean(&self.bounds),
            mean(&self.bounds) / mean(&self.briers[0])
        );
        let titles = ["strategy", "B ÷ bound", "regret", "÷curious", "p", "÷round", "p"];
        let [strategy, ratio, regret, to_curious, p_curious, to_round, p_round] = titles;
        println!(
            "{strategy:<14} {ratio:>9} {regret:>8} {to_curious:>9} {p_curious:>9} {to_round:>8} {p_round:>9}"
        );
        for (plan, name) in self.plans.iter().enumerate() {
            let regrets = self.regrets(plan);
            let against = |other: usize| {
                let others = self.regrets(other);
                let differences = regrets.iter().zip(&others).map(|(regret, other)| regret - other);
                (mean(&regrets) / mean(&others), reports::paired_test(differences).p_value)
            };
            let ((to_curious, p_curious), (to_round, p_round)) = (against(curious), against(round));
            println!(
                "{name:<14} {:>9.3} {:>8.3} {to_curious:>9.3} {p_curious:>9.1e} {to_round:>8.3} {p_round:>9.1e}",
                mean(&self.briers[plan]) / mean(&self.bounds),
                mean(&regrets)
            );
        }
    }
}

/// Writes a line for each building, share of the time and strategy.
pub(crate) fn write(path: &Path, all: &[Scores]) -> std::io::Result<()> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "place,share,seed,strategy,brier,bound")?;
    for scores in all {
        for (plan, name) in scores.plans.iter().enumerate() {
            for (at, seed) in scores.seeds.iter().enumerate() {
                let bound = scores.bounds.get(at).map_or(String::new(), f64::to_string);
                let brier = scores.briers[plan][at];
                writeln!(file, "{},{},{seed},{name},{brier},{bound}", scores.place, scores.share)?;
            }
        }
    }
    file.flush()
}
