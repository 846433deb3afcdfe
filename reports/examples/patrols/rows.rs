//! The lines of the table of all runs.

use crate::runs::{Outcome, Run};
use crate::study::Line;
use anyhow::{Context, bail};

/// The titles of files from before the last two columns.
const OLD_TITLES: &str =
    "kind,habits,share,days,seed,strategy,length_min,brier,median_min,delay95_min,missed,patrol,closed";
const TITLES: &str = "kind,habits,share,days,seed,strategy,length_min,brier,median_min,delay95_min,missed,patrol,closed,lost_s,\
                      not_made";

/// A number with six decimals, which are far below the scatter of a run: a study has thousands of rows.
fn rounded(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}

/// A run and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) run: Run,
    pub(crate) outcome: Outcome,
}

impl Line for Row {
    type Run = Run;

    fn titles() -> String {
        TITLES.to_owned()
    }

    fn reads(titles: &str) -> bool {
        [TITLES, OLD_TITLES].contains(&titles)
    }

    fn run(&self) -> &Run {
        &self.run
    }

    fn line(&self) -> String {
        let Run { kind, things, share, days, seed, strategy, length_min } = &self.run;
        let Outcome { brier, delays_min: [median, late], missed, patrol, closed, lost_s, not_made } =
            self.outcome;
        let [brier, median, late, missed, patrol, closed, lost_s, not_made] =
            [brier, median, late, missed, patrol, closed, lost_s, not_made].map(rounded);
        let length = length_min.map_or(String::new(), |length_min| length_min.to_string());
        let (kind, habits) = (kind.name(), things.name());
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
            things: habits.parse().map_err(anyhow::Error::msg)?,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::RowFile;

    /// Files of a study go on: they keep their rows, and get the columns that they did not have.
    #[test]
    fn older_files_are_read_and_completed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.csv");
        let old = "home,known,0.05,7,3,round,2.5,0.0731,20,300,0.1,0.05,0.2";
        let bound = "home,known,0.05,7,3,bound,,0.02,NaN,NaN,NaN,NaN,NaN";
        std::fs::write(&path, format!("{OLD_TITLES}\n{old}\n{bound}\nhome,kno")).unwrap();
        let mut file = RowFile::<Row>::open(&path).unwrap();
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
        assert_eq!(RowFile::<Row>::read(&path).unwrap()[2], new);
        std::fs::write(&path, "a,b\n").unwrap();
        assert!(RowFile::<Row>::read(&path).unwrap_err().to_string().starts_with("its first line is not"));
    }
}
