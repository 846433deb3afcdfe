//! The lines of the table of all runs.

use crate::life::{AREAS, Outcome, TIMES};
use crate::runs::Run;
use crate::study::Line;
use anyhow::{bail, ensure};

/// A run and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) run: Run,
    pub(crate) outcome: Outcome,
}

impl Line for Row {
    type Run = Run;

    fn titles() -> String {
        let areas = AREAS.iter().map(|length| format!("area_{length}"));
        let errors = TIMES.iter().map(|time| format!("error_{time}"));
        let titles: Vec<String> = areas.chain(errors).collect();
        format!("learner,experience,estimator,steps,seed,{},map_quality,changing,brier", titles.join(","))
    }

    fn run(&self) -> &Run {
        &self.run
    }

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
