//! The table of a page, from the rows of the study.

use crate::rows::{Row, Run, VALUES};
use agent::Policy;
use reports::pages::{PageError, mean, ratio, with_tables};

const HEAD: &str = "building | time on patrol | days | buildings | strategy | Brier | ÷ first | delay, min: median / 95 % | missed | \
                    lost per trip, s | not made | flat battery | contacts";

/// The page with its tables made from the rows.
pub(crate) fn rewritten(page: &str, rows: &[Row]) -> Result<String, PageError> {
    with_tables(page, "physics_patrols", |_| table(rows))
}

/// A line per kind of building, share of the time and strategy, in the order of the rows.
pub(crate) fn table(rows: &[Row]) -> Result<String, String> {
    let mut cells: Vec<(Run, Vec<Policy>)> = Vec::new();
    for Row { run, .. } in rows {
        match cells.iter_mut().find(|(cell, _)| is_of(cell, run)) {
            Some((_, strategies)) if strategies.contains(&run.strategy) => {}
            Some((_, strategies)) => strategies.push(run.strategy.clone()),
            None => cells.push((run.clone(), vec![run.strategy.clone()])),
        }
    }
    if cells.is_empty() {
        return Err("there are no rows".to_owned());
    }
    let columns = "---|".repeat(HEAD.split(" | ").count());
    let lines: Vec<String> =
        cells.iter().flat_map(|(cell, strategies)| lines(rows, cell, strategies)).collect();
    Ok(format!("| {HEAD} |\n|{columns}\n{}", lines.concat()))
}

fn is_of(cell: &Run, run: &Run) -> bool {
    (cell.kind, cell.share, cell.battery_s, cell.days) == (run.kind, run.share, run.battery_s, run.days)
}

/// The lines of a kind of building and a share of the time, over the buildings in which every strategy was run.
fn lines(rows: &[Row], cell: &Run, strategies: &[Policy]) -> Vec<String> {
    let own: Vec<&Row> = rows.iter().filter(|row| is_of(cell, &row.run)).collect();
    let row = |strategy: &Policy, seed: u64| {
        own.iter().find(|row| row.run.strategy == *strategy && row.run.seed == seed)
    };
    let mut seeds: Vec<u64> = own.iter().map(|row| row.run.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    seeds.retain(|seed| strategies.iter().all(|strategy| row(strategy, *seed).is_some()));
    let values = |strategy: &Policy, name: &str| -> Vec<f64> {
        let column = VALUES.iter().position(|known| *known == name).unwrap_or_default();
        seeds.iter().filter_map(|seed| Some(row(strategy, *seed)?.values[column])).collect()
    };
    let line = |strategy: &Policy| {
        let mean_of = |name: &str| mean(&values(strategy, name));
        let to_first = if *strategy == strategies[0] {
            "1".to_owned()
        } else {
            ratio(&values(strategy, "brier"), &values(&strategies[0], "brier"))
        };
        format!(
            "| {} | {} % | {} | {} | `{}` | {:.3} | {to_first} | {:.0} / {:.0} | {:.0} % | {:.2} | {:.1} % | {} | {} |\n",
            cell.kind.name(),
            100.0 * cell.share,
            cell.days,
            seeds.len(),
            strategy.name(),
            mean_of("brier"),
            mean_of("median_min"),
            mean_of("delay95_min"),
            100.0 * mean_of("missed"),
            mean_of("lost_s"),
            100.0 * mean_of("not_made"),
            values(strategy, "flat").iter().sum::<f64>(),
            values(strategy, "contacts").iter().sum::<f64>(),
        )
    };
    if seeds.is_empty() { Vec::new() } else { strategies.iter().map(line).collect() }
}
