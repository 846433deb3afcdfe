//! The table of all runs as a file: a line per run.

use crate::runs::{Outcome, Run};
use anyhow::{Context, bail};
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// The titles of files from before the last two columns.
const OLD_TITLES: &str =
    "kind,habits,share,days,seed,strategy,length_min,brier,median_min,delay95_min,missed,patrol,closed";
const TITLES: &str = "kind,habits,share,days,seed,strategy,length_min,brier,median_min,delay95_min,missed,patrol,closed,lost_s,\
                      not_made";

/// A run and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) run: Run,
    pub(crate) outcome: Outcome,
}

impl Row {
    fn line(&self) -> String {
        let Run { kind, habits, share, days, seed, strategy, length_min } = &self.run;
        let Outcome { brier, delays_min: [median, late], missed, patrol, closed, lost_s, not_made } =
            self.outcome;
        let length = length_min.map_or(String::new(), |length_min| length_min.to_string());
        let (kind, habits) = (kind.name(), habits.name());
        format!(
            "{kind},{habits},{share},{days},{seed},{strategy},{length},{brier},{median},{late},{missed},{patrol},{closed},{lost_s},{not_made}"
        )
    }

    fn parse(line: &str) -> anyhow::Result<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let ([kind, habits, share, days, seed, strategy, length], numbers) =
            fields.split_first_chunk().context("it has less than 8 fields")?;
        let numbers: Vec<f64> = numbers.iter().map(|text| text.parse()).collect::<Result<_, _>>()?;
        let (brier, median, late, missed, patrol, closed, lost_s, not_made) = match numbers[..] {
            [a, b, c, d, e, f, lost_s, not_made] => (a, b, c, d, e, f, lost_s, not_made),
            [a, b, c, d, e, f] => (a, b, c, d, e, f, f64::NAN, f64::NAN), // an older file
            _ => bail!("it has {} fields", fields.len()),
        };
        let run = Run {
            kind: kind.parse().map_err(anyhow::Error::msg)?,
            habits: habits.parse().map_err(anyhow::Error::msg)?,
            share: share.parse()?,
            days: days.parse()?,
            seed: seed.parse()?,
            strategy: (*strategy).to_owned(),
            length_min: if length.is_empty() { None } else { Some(length.parse()?) },
        };
        let outcome = Outcome { brier, delays_min: [median, late], missed, patrol, closed, lost_s, not_made };
        Ok(Self { run, outcome })
    }
}

/// A file that gets a line per run.
pub(crate) struct RowFile {
    /// The rows that it had when it was opened.
    pub(crate) rows: Vec<Row>,
    file: File,
}

impl RowFile {
    /// The rows of a file; what older files do not have is NaN.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<Row>> {
        let text = std::fs::read_to_string(path)?;
        // A line that was cut off has no end.
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        if let Some(titles) = lines.next().filter(|titles| ![TITLES, OLD_TITLES].contains(titles)) {
            bail!("its first line is not that of a table of patrols: {titles}");
        }
        lines
            .enumerate()
            .map(|(at, line)| Row::parse(line).with_context(|| format!("line {}", at + 2)))
            .collect()
    }

    /// Opens a file, or begins a new one, to add rows.
    pub(crate) fn open(path: &Path) -> anyhow::Result<Self> {
        let rows = if path.exists() { Self::read(path)? } else { Vec::new() };
        // Without a line that was cut off.
        let mut file = File::create(path)?;
        writeln!(file, "{TITLES}")?;
        rows.iter().try_for_each(|row| writeln!(file, "{}", row.line()))?;
        Ok(Self { rows, file })
    }

    pub(crate) fn append(&mut self, row: &Row) -> anyhow::Result<()> {
        Ok(writeln!(self.file, "{}", row.line())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files of a study go on: they keep their rows, and get the columns that they did not have.
    #[test]
    fn older_files_are_read_and_completed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.csv");
        let old = "home,known,0.05,7,3,round,2.5,0.0731,20,300,0.1,0.05,0.2";
        let bound = "home,known,0.05,7,3,bound,,0.02,NaN,NaN,NaN,NaN,NaN";
        std::fs::write(&path, format!("{OLD_TITLES}\n{old}\n{bound}\nhome,kno")).unwrap();
        let mut file = RowFile::open(&path).unwrap();
        assert_eq!(file.rows.len(), 2);
        let Outcome { brier, closed, lost_s, not_made, .. } = file.rows[0].outcome;
        assert!((brier, closed) == (0.0731, 0.2) && lost_s.is_nan() && not_made.is_nan());
        let mut new = file.rows[0].clone();
        new.run.seed = 4;
        (new.outcome.lost_s, new.outcome.not_made) = (1.5, 0.25);
        file.append(&new).unwrap();
        drop(file);
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            text,
            format!(
                "{TITLES}\n{old},NaN,NaN\n{bound},NaN,NaN\nhome,known,0.05,7,4,round,2.5,0.0731,20,300,0.1,0.05,0.2,1.5,0.25\n"
            )
        );
        assert_eq!(RowFile::read(&path).unwrap()[2], new);
        std::fs::write(&path, "a,b\n").unwrap();
        assert!(RowFile::read(&path).unwrap_err().to_string().starts_with("its first line is not"));
    }
}
