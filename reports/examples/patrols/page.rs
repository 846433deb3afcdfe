//! The tables of the page, from the rows of the study.

use crate::cells::{Bounded, Cell, Named, cells};
use crate::rows::Row;
use crate::runs::Outcome;
use reports::pages::{PageError, mean, ratio, with_tables};

/// The strategies of the tables; the last one is compared with the others.
const SHOWN: [&str; 4] = ["curious", "round", "coverage", "gain"];

/// The entries of a line; `None` if the cell has no results for it.
type Line = fn(&Cell) -> Option<Vec<String>>;

/// The page with its tables made from sorted rows.
pub(crate) fn rewritten(page: &str, rows: &[Row]) -> Result<String, PageError> {
    with_tables(page, "patrols", |which| table(which, rows))
}

/// A table: what the things do and the robot knows, and what is measured.
fn table(which: &str, rows: &[Row]) -> Result<String, String> {
    let (habits, measure) = which.split_once(' ').ok_or("expected habits and a measure")?;
    let (head, line): (&str, Line) = match measure {
        "scores" => (
            "buildings | no looks | `curious` | round | coverage | gain | gain ÷ `curious` | gain ÷ round | gain ÷ coverage",
            scores,
        ),
        "delays" => (
            "delay 95 %, min: `curious` / round / coverage / gain | gain ÷ `curious` | missed, %: `curious` / round / coverage / gain",
            delays,
        ),
        "regrets" => (
            "buildings | bound | B ÷ bound: `curious` / round / coverage / gain | regret: `curious` / round / coverage / gain | regret, gain ÷ `curious` | gain ÷ round | gain ÷ coverage",
            regrets,
        ),
        "users" => (
            "lost per trip, s: no looks | `curious` / round / coverage / gain | gain ÷ `curious` | gain ÷ round | not made, %: `curious` / round / coverage / gain",
            users,
        ),
        _ => return Err("the measures are scores, delays, regrets and users".to_owned()),
    };
    let lines: Vec<String> = cells(rows)
        .filter(|cell| cell.things.name() == habits)
        .filter_map(|cell| {
            let place = [cell.kind.name().to_owned(), format!("{} %", 100.0 * cell.share)];
            let values = line(&cell)?;
            Some(format!("| {} | {} |\n", place.join(" | "), values.join(" | ")))
        })
        .collect();
    if lines.is_empty() {
        return Err("the rows have nothing for it".to_owned());
    }
    let columns = "---|".repeat(head.split(" | ").count());
    Ok(format!("| building | time on patrol | {head} |\n|---|---|{columns}\n{}", lines.concat()))
}

/// The strategies of the tables, if the cell has all of them.
fn shown(cell: &Cell, all: &[Named]) -> Option<[Named; 4]> {
    let seeds = cell.seeds(all);
    let found = SHOWN.map(|name| cell.best(name, all, &seeds).cloned());
    let [Some(curious), Some(round), Some(coverage), Some(gain)] = found else { return None };
    Some([curious, round, coverage, gain])
}

fn scores(cell: &Cell) -> Option<Vec<String>> {
    let all = cell.strategies();
    let (seeds, shown) = (cell.seeds(&all), shown(cell, &all)?);
    let brier = |named: &Named| cell.values(named, &seeds, |outcome| outcome.brier);
    let none = cell.best("no-looks", &all, &seeds).map_or("–".to_owned(), |named| score(&brier(named)));
    let own = shown.each_ref().map(brier);
    let mut line = vec![seeds.len().to_string(), none];
    line.extend(own.iter().map(|values| score(values)));
    line.extend(own[..3].iter().map(|other| ratio(&own[3], other)));
    Some(line)
}

fn delays(cell: &Cell) -> Option<Vec<String>> {
    let all = cell.strategies();
    let (seeds, shown) = (cell.seeds(&all), shown(cell, &all)?);
    let of =
        |value: fn(&Outcome) -> f64| shown.each_ref().map(|named| mean(&cell.values(named, &seeds, value)));
    let (late, missed) = (of(|outcome| outcome.delays_min[1]), of(|outcome| 100.0 * outcome.missed));
    let ratio = format!("{:.2}", late[3] / late[0]);
    Some(vec![listed(&late, 0), ratio, listed(&missed, 1)])
}

fn users(cell: &Cell) -> Option<Vec<String>> {
    let all = cell.strategies();
    let (seeds, shown) = (cell.seeds(&all), shown(cell, &all)?);
    let lost = |named: &Named| cell.values(named, &seeds, |outcome| outcome.lost_s);
    let none = format!("{:.2}", mean(&lost(cell.best("no-looks", &all, &seeds)?)));
    let own = shown.each_ref().map(lost);
    let means = own.each_ref().map(|values| mean(values));
    let not_made =
        shown.each_ref().map(|named| mean(&cell.values(named, &seeds, |outcome| 100.0 * outcome.not_made)));
    let ratios = [0, 1].map(|other| ratio(&own[3], &own[other]));
    let [to_curious, to_round] = ratios;
    Some(vec![none, listed(&means, 2), to_curious, to_round, listed(&not_made, 1)])
}

fn regrets(cell: &Cell) -> Option<Vec<String>> {
    let all = cell.strategies();
    let shown = shown(cell, &all)?;
    let bounded: Bounded = cell.bounded(&all)?;
    let brier = |named: &Named| mean(&cell.values(named, &bounded.seeds, |outcome| outcome.brier));
    let over = shown.each_ref().map(|named| brier(named) / bounded.bound());
    let own = shown.each_ref().map(|named| cell.regrets(named, &bounded));
    let means = own.each_ref().map(|values| mean(values));
    let (count, bound) = (bounded.seeds.len().to_string(), format!("{:.4}", bounded.bound()));
    let mut line = vec![count, bound, listed(&over, 2), listed(&means, 3)];
    line.extend(own[..3].iter().map(|other| ratio(&own[3], other)));
    Some(line)
}

fn score(values: &[f64]) -> String {
    format!("{:.4}", mean(values))
}

fn listed(values: &[f64], decimals: usize) -> String {
    values.iter().map(|value| format!("{value:.decimals$}")).collect::<Vec<_>>().join(" / ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{cells::sort, study::RowFile};
    use std::path::Path;

    /// A page with tables that were not made from the rows of the study is stale.
    #[test]
    fn the_page_has_what_the_file_says() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut rows = RowFile::read(&root.join("docs/results/patrols.csv")).unwrap();
        sort(&mut rows);
        let page = std::fs::read_to_string(root.join("docs/strategies.md")).unwrap();
        assert!(page.matches("<!-- patrols ").count() >= 6);
        assert!(
            rewritten(&page, &rows).unwrap() == page,
            "cargo run -p curious-reports --example patrols -- --merge docs/results/patrols.csv --page docs/strategies.md"
        );
    }

    #[test]
    fn a_table_that_is_not_known_is_refused() {
        assert!(table("known", &[]).is_err() && table("known speed", &[]).is_err());
        assert!(table("known scores", &[]).is_err());
    }
}
