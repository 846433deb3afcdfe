//! The table of all runs as a file: a line per run.

use crate::life::{AREAS, Outcome, TIMES};
use crate::runs::Run;
use anyhow::{Context, bail, ensure};
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// A run and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) run: Run,
    pub(crate) outcome: Outcome,
}

fn titles() -> String {
    let areas = AREAS.iter().map(|length| format!("area_{length}"));
    let errors = TIMES.iter().map(|time| format!("error_{time}"));
    let titles: Vec<String> = areas.chain(errors).collect();
    format!("learner,experience,estimator,steps,seed,{},map_quality,changing,brier", titles.join(","))
}

impl Row {
    fn line(&self) -> String {
        let Run { learner, experience, estimator, steps, seed } = &self.run;
        let Outcome { areas, errors, map_quality, changing, brier } = &self.outcome;
        let numbers = areas.iter().chain(errors).chain([map_quality, changing, brier]);
        let numbers: Vec<String> = numbers.map(|number| format!("{number:.6}")).collect();
        format!("{learner},{experience},{estimator},{steps},{seed},{}", numbers.join(","))
    }

    fn parse(line: &str) -> anyhow::Result<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let [learner, experience, estimator, steps, seed, numbers @ ..] = &fields[..] else {
            bail!("it has {} fields", fields.len());
        };
        let numbers: Result<Vec<f64>, _> = numbers.iter().map(|number| number.parse()).collect();
        let numbers = numbers?;
        ensure!(numbers.len() == AREAS.len() + TIMES.len() + 3, "it has {} numbers", numbers.len());
        let (areas, rest) = numbers.split_at(AREAS.len());
        let (errors, rest) = rest.split_at(TIMES.len());
        let run = Run {
            learner: (*learner).to_owned(),
            experience: experience.parse()?,
            estimator: (*estimator).to_owned(),
            steps: steps.parse()?,
            seed: seed.parse()?,
        };
        let outcome = Outcome {
            areas: areas.try_into()?,
            errors: errors.try_into()?,
            map_quality: rest[0],
            changing: rest[1],
            brier: rest[2],
        };
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
        if let Some(first) = lines.next().filter(|first| *first != titles()) {
            bail!("its first line is not that of this study: {first}");
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
        writeln!(file, "{}", titles())?;
        rows.iter().try_for_each(|row| writeln!(file, "{}", row.line()))?;
        Ok(Self { rows, file })
    }

    pub(crate) fn append(&mut self, row: &Row) -> anyhow::Result<()> {
        Ok(writeln!(self.file, "{}", row.line())?)
    }
}
