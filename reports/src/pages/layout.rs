//! Tables whose layout is on the page: which file, which rows, and what is in each column.
//!
//! ```text
//! docs/results/flicker.csv where beams=360
//! world = {world}
//! false changes = {false_changes:t}
//! time, s = {mean time_s:.1} ({min time_s:.1} to {max time_s:.1})
//! naive = {time_s if map=naive:.1} -->
//! ```
//!
//! Rows with the same text in the first column are one line of the table; with `by COLUMN, COLUMN` after the source, those with the
//! same values in these columns. A reference in braces is a column, after the word `mean`, `min`, `max` or `sum` if the rows of a
//! line differ in it. `*100` multiplies it. `if COLUMN=VALUE` chooses rows, as `where` does; `!=` leaves them out. Formats: `.2`
//! decimals, `+.2` with the sign, `t` thousands separated, `p` a p-value.

use super::rows::Rows;
use results::numbers::thousands;

/// A condition on a row: a column, its value, and whether the row has it or not.
type Condition<'t> = (&'t str, &'t str, bool);

/// The Markdown table of this layout; `read` gives the tables of the source that the layout names.
///
/// # Errors
///
/// When the layout is not complete, the source has no such table, or a value is missing or ambiguous.
pub fn table(layout: &str, read: impl Fn(&str) -> Result<Vec<Rows>, String>) -> Result<String, String> {
    let mut lines = layout.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().ok_or("there is no source")?;
    let (source, conditions) = first.split_once(" where ").unwrap_or((first, ""));
    let (source, by) = source.split_once(" by ").unwrap_or((source, ""));
    let by: Vec<&str> = by.split(',').map(str::trim).filter(|name| !name.is_empty()).collect();
    let conditions = self::conditions(conditions)?;
    let columns: Vec<(&str, &str)> = lines
        .map(|line| {
            line.split_once('=')
                .map(|(title, cell)| (title.trim(), cell.trim()))
                .ok_or(format!("`{line}` is not TITLE = CELL"))
        })
        .collect::<Result<_, _>>()?;
    let tables = read(source.trim())?;
    let parts = columns.iter().map(|(_, cell)| parts(cell)).collect::<Result<Vec<_>, _>>()?;
    let names = || {
        parts
            .iter()
            .flatten()
            .filter_map(Part::column)
            .chain(conditions.iter().map(|(column, ..)| *column))
            .chain(by.iter().copied())
    };
    let fits = |rows: &&Rows| names().all(|name| rows.column(name).is_some());
    let rows = tables.iter().find(fits).ok_or_else(|| {
        let known: Vec<String> = tables.iter().map(|rows| rows.columns.join(", ")).collect();
        format!("no table of the source has all of these columns; it has {}", known.join("; "))
    })?;
    let shown: Vec<&Vec<String>> = rows.values.iter().filter(|row| holds(rows, row, &conditions)).collect();
    let first = parts.first().ok_or("there are no columns")?;
    let mut groups: Vec<(String, Vec<&Vec<String>>)> = Vec::new();
    for row in shown {
        let key: Vec<&str> =
            by.iter().filter_map(|name| rows.column(name)).map(|at| row[at].as_str()).collect();
        let key = if by.is_empty() { text(rows, &[row], first)? } else { key.join("\n") };
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, members)) => members.push(row),
            None => groups.push((key, vec![row])),
        }
    }
    if groups.is_empty() {
        return Err("no row of the source fits".to_owned());
    }
    let titles: Vec<&str> = columns.iter().map(|(title, _)| *title).collect();
    let mut table = format!("| {} |\n|{}\n", titles.join(" | "), "---|".repeat(titles.len()));
    for (_, members) in groups {
        let cells = parts.iter().map(|parts| text(rows, &members, parts)).collect::<Result<Vec<_>, _>>()?;
        table += &format!("| {} |\n", cells.join(" | "));
    }
    if !rows.made.is_empty() {
        table += &format!("\nMade from {}.\n", rows.made);
    }
    Ok(table)
}

/// A part of a cell.
enum Part<'t> {
    Text(&'t str),
    Value(Reference<'t>),
}

impl<'t> Part<'t> {
    fn column(&self) -> Option<&'t str> {
        match self {
            Self::Text(_) => None,
            Self::Value(reference) => Some(reference.column),
        }
    }
}

/// A value of the rows of a line.
struct Reference<'t> {
    fold: Option<Fold>,
    column: &'t str,
    factor: f64,
    conditions: Vec<Condition<'t>>,
    format: &'t str,
}

/// One value for those of several rows.
type Fold = fn(&[f64]) -> f64;

const FOLDS: [(&str, Fold); 4] = [
    ("mean ", |values| values.iter().sum::<f64>() / values.len() as f64),
    ("min ", |values| values.iter().copied().fold(f64::INFINITY, f64::min)),
    ("max ", |values| values.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
    ("sum ", |values| values.iter().sum()),
];

fn conditions(text: &str) -> Result<Vec<Condition<'_>>, String> {
    let pairs = text.split(" and ").map(str::trim).filter(|pair| !pair.is_empty());
    pairs
        .map(|pair| match (pair.split_once("!="), pair.split_once('=')) {
            (Some((column, value)), _) => Ok((column, value, false)),
            (None, Some((column, value))) => Ok((column, value, true)),
            (None, None) => Err(format!("`{pair}` is not COLUMN=VALUE")),
        })
        .collect()
}

fn parts(cell: &str) -> Result<Vec<Part<'_>>, String> {
    let (mut parts, mut rest) = (Vec::new(), cell);
    while let Some((before, after)) = rest.split_once('{') {
        let (inside, after) = after.split_once('}').ok_or(format!("`{cell}`: a brace is not closed"))?;
        parts.extend([Part::Text(before), Part::Value(reference(inside)?)]);
        rest = after;
    }
    parts.push(Part::Text(rest));
    Ok(parts)
}

fn reference(text: &str) -> Result<Reference<'_>, String> {
    // A name of a column can have a colon.
    let is_format = |format: &str| ["p", "t"].contains(&format) || format.starts_with(['.', '+']);
    let (text, format) = text.rsplit_once(':').filter(|(_, format)| is_format(format)).unwrap_or((text, ""));
    let (text, chosen) = text.split_once(" if ").unwrap_or((text, ""));
    let fold = FOLDS.iter().find_map(|(name, fold)| Some((text.strip_prefix(name)?, *fold)));
    let (text, fold) = fold.map_or((text, None), |(text, fold)| (text, Some(fold)));
    let (column, factor) = match text.split_once('*') {
        Some((column, factor)) => {
            (column, factor.parse().map_err(|_| format!("`{factor}` is not a number"))?)
        }
        None => (text, 1.0),
    };
    Ok(Reference { fold, column, factor, conditions: conditions(chosen)?, format })
}

fn holds(rows: &Rows, row: &[String], conditions: &[Condition<'_>]) -> bool {
    let has = |column: &str, value: &str| rows.column(column).is_some_and(|at| row[at] == value);
    conditions.iter().all(|(column, value, is_wanted)| has(column, value) == *is_wanted)
}

/// A cell; a dash where a value is missing.
fn text(rows: &Rows, members: &[&Vec<String>], parts: &[Part<'_>]) -> Result<String, String> {
    let mut text = String::new();
    for part in parts {
        match part {
            Part::Text(plain) => text += plain,
            Part::Value(reference) => match reference.value(rows, members)? {
                Some(value) => text += &value,
                None => return Ok("–".to_owned()),
            },
        }
    }
    Ok(text)
}

impl Reference<'_> {
    fn value(&self, rows: &Rows, members: &[&Vec<String>]) -> Result<Option<String>, String> {
        let at = rows.column(self.column).ok_or(format!("there is no column `{}`", self.column))?;
        let chosen = members.iter().filter(|row| holds(rows, row, &self.conditions));
        let mut values: Vec<&str> =
            chosen.map(|row| row[at].as_str()).filter(|value| !value.is_empty()).collect();
        let Some(fold) = self.fold else {
            values.dedup();
            return match values.as_slice() {
                [] => Ok(None),
                [value] => Ok(Some(self.formatted(value))),
                [first, second, ..] => Err(format!("`{}` is {first} and {second} in one line", self.column)),
            };
        };
        let numbers: Vec<f64> = values.iter().filter_map(|value| value.parse().ok()).collect();
        Ok((!numbers.is_empty()).then(|| self.number(fold(&numbers) * self.factor)))
    }

    /// A value of a row: what is no number stays as it is.
    fn formatted(&self, value: &str) -> String {
        match value.parse::<f64>() {
            Ok(number) if !self.format.is_empty() => self.number(number * self.factor),
            _ => value.to_owned(),
        }
    }

    fn number(&self, value: f64) -> String {
        let decimals = |digits: &str| digits.parse().unwrap_or(2);
        let text = match self.format {
            "p" if value < 0.001 => "p < 0.001".to_owned(),
            "p" => format!("p = {value:.3}"),
            "t" => thousands(value.round() as u64),
            format if format.starts_with("+.") => format!("{value:+.*}", decimals(&format[2..])),
            format => format!("{value:.*}", decimals(format.trim_start_matches('.'))),
        };
        let is_zero = !text.contains(|letter: char| ('1'..='9').contains(&letter));
        if is_zero { text.trim_start_matches(['-', '+']).to_owned() } else { text.replace('-', "−") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(layout: &str) -> Result<String, String> {
        let rows = "world,map,changes,share,p\nT,steady,0,0.5,0.0001\nT,naive,207347,0.25,0.04\nR,steady,30,-0.001,\nR,naive,9,,0.5\n";
        table(layout, |source| match source {
            "a.csv" => Ok(vec![Rows::of_csv(rows).unwrap()]),
            other => Err(format!("there is no {other}")),
        })
    }

    #[test]
    fn rows_become_lines_and_columns() {
        let table = made(
            "a.csv where map=steady\nworld = {world}\nchanges = {changes}\nshare = {share*100:.0} %, {p:p}",
        )
        .unwrap();
        assert_eq!(
            table,
            "| world | changes | share |\n|---|---|---|\n| T | 0 | 50 %, p < 0.001 |\n| R | 30 | – |\n"
        );
    }

    #[test]
    fn rows_with_one_title_are_one_line() {
        let table = made("a.csv\nworld = {world}\nnaive = {changes if map=naive:t}\nboth = {mean changes:.1} ({min share:+.2})").unwrap();
        assert_eq!(
            table,
            "| world | naive | both |\n|---|---|---|\n| T | 207,347 | 103673.5 (+0.25) |\n| R | 9 | 19.5 (0.00) |\n"
        );
        let by = made("a.csv by world, map where map!=naive\nmap = {map}\nworld = {world}").unwrap();
        assert_eq!(by, "| map | world |\n|---|---|\n| steady | T |\n| steady | R |\n");
        assert!(made("a.csv\nworld = {world}\nchanges = {changes}").unwrap_err().contains("0 and 207347"));
    }

    #[test]
    fn what_is_not_there_is_refused() {
        for layout in [
            "",
            "b.csv\nw = {world}",
            "a.csv\nw = {place}",
            "a.csv\nw",
            "a.csv where map=none\nw = {world}",
            "a.csv\nw = {world",
        ] {
            assert!(made(layout).is_err(), "{layout}");
        }
    }
}
