//! The table of all runs as a file: a line per run.

use crate::runs::{Outcome, Run};
use anyhow::{Context, bail};
use std::fs::File;
use std::io::Write;
use std::path::Path;

const TITLES: &str =
    "kind,habits,share,days,seed,strategy,length_min,brier,median_min,delay95_min,missed,patrol,closed";

/// A run and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) run: Run,
    pub(crate) outcome: Outcome,
}

impl Row {
    fn line(&self) -> String {
        let Run { kind, habits, share, days, seed, strategy, length_min } = &self.run;
        let Outcome { brier, delays_min: [median, late], missed, patrol, closed } = self.outcome;
        let length = length_min.map_or(String::new(), |length_min| length_min.to_string());
        let (kind, habits) = (kind.name(), habits.name());
        format!(
            "{kind},{habits},{share},{days},{seed},{strategy},{length},{brier},{median},{late},{missed},{patrol},{closed}"
        )
    }

    fn parse(line: &str) -> anyhow::Result<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let [kind, habits, share, days, seed, strategy, length, brier, median, late, missed, patrol, closed] =
            fields[..]
        else {
            bail!("it has {} fields", fields.len());
        };
        let run = Run {
            kind: kind.parse().map_err(anyhow::Error::msg)?,
            habits: habits.parse().map_err(anyhow::Error::msg)?,
            share: share.parse()?,
            days: days.parse()?,
            seed: seed.parse()?,
            strategy: strategy.to_owned(),
            length_min: if length.is_empty() { None } else { Some(length.parse()?) },
        };
        let delays_min = [median.parse()?, late.parse()?];
        let [brier, missed, patrol, closed] = [brier, missed, patrol, closed].map(str::parse::<f64>);
        let outcome =
            Outcome { brier: brier?, delays_min, missed: missed?, patrol: patrol?, closed: closed? };
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
    /// The rows of a file.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<Row>> {
        let text = std::fs::read_to_string(path)?;
        // A line that was cut off has no end.
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        if let Some(titles) = lines.next().filter(|titles| *titles != TITLES) {
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
