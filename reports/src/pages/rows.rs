//! Results as rows: a CSV file, or a table of a Markdown file that a program wrote.

use serde::Serialize;
use std::path::Path;
use std::process::Command;

/// A table of results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// From which sources, and by which command; empty if the file does not say it.
    pub made: String,
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The values, by row and column.
    pub values: Vec<Vec<String>>,
}

impl Rows {
    /// The rows of a CSV text, whose first line can be `# ` and what they were made from.
    ///
    /// # Errors
    ///
    /// When a line does not have as many values as there are columns.
    pub fn of_csv(text: &str) -> Result<Self, String> {
        let (made, text) = match text.strip_prefix("# ").and_then(|rest| rest.split_once('\n')) {
            Some((made, rest)) => (made.to_owned(), rest),
            None => (String::new(), text),
        };
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let owned = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
        let columns = owned(reader.headers().map_err(|why| why.to_string())?);
        let values = reader.records().map(|record| record.map(|record| owned(&record)));
        Ok(Self { made, columns, values: values.collect::<Result<_, _>>().map_err(|why| why.to_string())? })
    }

    /// The tables below a heading of a Markdown text, up to the next heading. A line `Made from …` says what they were made from.
    pub fn of_markdown(text: &str, heading: &str) -> Vec<Self> {
        let is_heading = |line: &&str| line.starts_with('#');
        let named = |line: &str| line.trim_start_matches('#').trim() == heading;
        let lines = text.lines().skip_while(|line| !(is_heading(line) && named(line))).skip(1);
        let lines: Vec<&str> = lines.take_while(|line| !is_heading(line)).collect();
        let made = lines.iter().find_map(|line| line.strip_prefix("Made from ")?.strip_suffix('.'));
        let tables = lines.split(|line| !line.starts_with('|')).filter(|table| table.len() > 2);
        tables
            .map(|table| Self {
                made: made.unwrap_or_default().to_owned(),
                columns: cells(table[0]),
                values: table[2..].iter().map(|line| cells(line)).collect(),
            })
            .collect()
    }

    /// The number of a column.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }
}

/// The values of a line of a Markdown table.
fn cells(line: &str) -> Vec<String> {
    line.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// Writes rows with what they were made from: the commit, and the command.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write_rows<R: Serialize>(path: &Path, command: &str, rows: &[R]) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(format!("# {}, {command}\n", commit()).into_bytes());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    let text = writer.into_inner().map_err(|why| why.into_error())?;
    Ok(std::fs::write(path, text)?)
}

/// The names of the columns that rows of this kind have in a file.
///
/// # Panics
///
/// When rows of this kind cannot be written as CSV.
pub fn columns_of<R: Serialize>(row: &R) -> Vec<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(row).expect("a row is a plain struct");
    let text = writer.into_inner().expect("memory");
    Rows::of_csv(&String::from_utf8_lossy(&text)).expect("just written").columns
}

/// The commit of the sources and its date: `commit 3e12ade4 of 2026-11-27`, with `, changed` where files differ from it.
pub fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["show", "-s", "--format=commit %h of %cs"]) else {
        return "no commit".to_owned();
    };
    let is_changed = git(&["status", "--porcelain", "--untracked-files=no", "--", "*.rs", "*.toml"]);
    commit + if is_changed.is_some_and(|files| !files.is_empty()) { ", changed" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_and_markdown_give_the_same_rows() {
        let csv = Rows::of_csv("# commit 1, cargo run\na,b c\n1,x\n2,y\n").unwrap();
        assert_eq!(csv.made, "commit 1, cargo run");
        let text = "# T\n| no |\n|---|\n| 0 |\n## Two\ntext\n\n| a | b c |\n|---|---|\n| 1 | x |\n| 2 | y |\n\n| z |\n|---|\n| 3 |\n";
        let tables = Rows::of_markdown(text, "Two");
        assert_eq!(tables.len(), 2);
        assert_eq!((&tables[0].columns, &tables[0].values), (&csv.columns, &csv.values));
        assert!(Rows::of_markdown(text, "Three").is_empty() && tables[0].made.is_empty());
        let made = Rows::of_markdown("# T\nMade from commit 2, run.\n| a |\n|---|\n| 1 |\n", "T");
        assert_eq!(made[0].made, "commit 2, run");
        assert!(Rows::of_csv("a,b\n1\n").is_err());
    }

    #[test]
    fn a_row_knows_its_columns() {
        #[derive(Serialize)]
        struct Row {
            world: &'static str,
            error_m: f64,
        }
        assert_eq!(columns_of(&Row { world: "house", error_m: 0.1 }), ["world", "error_m"]);
    }
}
