//! The tables of the study: the error over a life, and how it falls.

use crate::life::{AREAS, TIMES};
use crate::rows::Row;
use crate::runs::{can_be_trained, learners};
use reports::pages::{PageError, mean, ratio, with_tables};
use results::numbers::thousands;

/// What the others are compared with.
const REFERENCES: [&str; 2] = ["curious", "information-gain"];

/// The rows of a learner with an experience, by seed.
struct Named<'a> {
    rows: &'a [Row],
}

impl Named<'_> {
    fn values(&self, value: impl Fn(&Row) -> f64) -> Vec<f64> {
        self.rows.iter().map(value).collect()
    }

    /// The ratio of the means in the worlds of both, with the p-value of the paired t test.
    fn compared(&self, other: &Named, value: impl Fn(&Row) -> f64) -> String {
        let pair = |row: &Row| {
            let other = other.rows.iter().find(|other| other.run.seed == row.run.seed)?;
            Some((value(row), value(other)))
        };
        let (own, others): (Vec<f64>, Vec<f64>) = self.rows.iter().filter_map(pair).unzip();
        ratio(&own, &others)
    }
}

/// The rows by estimator, learner, experience and seed. Of two lives of the same, the longer one: its beginning is the shorter one.
fn sorted(mut rows: Vec<Row>) -> Vec<Row> {
    let order = learners();
    let place = |row: &Row| order.iter().position(|name| *name == row.run.learner);
    rows.sort_by(|a, b| {
        a.run
            .estimator
            .cmp(&b.run.estimator)
            .then(place(a).cmp(&place(b)))
            .then(a.run.experience.cmp(&b.run.experience))
            .then(a.run.seed.cmp(&b.run.seed))
            .then(b.run.steps.cmp(&a.run.steps))
    });
    rows.dedup_by(|b, a| {
        let key = |row: &Row| {
            (row.run.estimator.clone(), row.run.learner.clone(), row.run.experience, row.run.seed)
        };
        key(a) == key(b)
    });
    rows
}

/// The rows of each estimator, and in them those of each learner and experience.
fn by_estimator(rows: &[Row]) -> impl Iterator<Item = (&str, Vec<Named<'_>>)> {
    rows.chunk_by(|a, b| a.run.estimator == b.run.estimator).map(|own| {
        let named = own
            .chunk_by(|a, b| (&a.run.learner, a.run.experience) == (&b.run.learner, b.run.experience))
            .map(|rows| Named { rows })
            .collect();
        (own[0].run.estimator.as_str(), named)
    })
}

/// Prints the tables of all rows, for each estimator.
pub(crate) fn print(rows: Vec<Row>) {
    for (estimator, named) in by_estimator(&sorted(rows)) {
        println!(
            "\nEstimator {estimator}: mean log error of the rates over the first steps of a life\n{}",
            areas(&named)
        );
        println!("\nLog error after this number of steps in the world, without training\n{}", times(&named));
    }
}

/// The page with its tables made from the rows: `areas` and `times`, each with the name of an estimator after it.
pub(crate) fn rewritten(page: &str, rows: Vec<Row>) -> Result<String, PageError> {
    let rows = sorted(rows);
    with_tables(page, "intrinsic_motivation", |which| {
        let (table, estimator) = which.split_once(' ').ok_or("expected a table and an estimator")?;
        let (_, named) = by_estimator(&rows)
            .find(|(name, _)| *name == estimator)
            .ok_or_else(|| format!("the rows have nothing for the estimator {estimator}"))?;
        match table {
            "areas" => Ok(areas(&named)),
            "times" => Ok(times(&named)),
            _ => Err("the tables are areas and times".to_owned()),
        }
    })
}

/// The errors over a life, against the references.
fn areas(all: &[Named]) -> String {
    let [short, long] = AREAS.map(thousands);
    let mut table = format!(
        "| learner | steps of training | worlds | area, {short} | area, {long} | ÷ `curious` | ÷ `information-gain` | map | \
         changing cells | Brier |\n|---|---|---|---|---|---|---|---|---|---|\n"
    );
    let references = REFERENCES.map(|name| all.iter().find(|named| named.rows[0].run.learner == name));
    for named in all {
        let run = &named.rows[0].run;
        let mean = |value: fn(&Row) -> f64| mean(&named.values(value));
        let [to_curious, to_gain] = references.map(|other| match other {
            Some(other) if other.rows[0].run.learner != run.learner => {
                named.compared(other, |row| row.outcome.areas[1])
            }
            _ => String::new(),
        });
        let training = if can_be_trained(&run.learner) { thousands(run.experience) } else { String::new() };
        table += &format!(
            "| `{}` | {training} | {} | {:.3} | {:.3} | {to_curious} | {to_gain} | {:.3} | {:.3} | {:.3} |\n",
            run.learner,
            named.rows.len(),
            mean(|row| row.outcome.areas[0]),
            mean(|row| row.outcome.areas[1]),
            mean(|row| row.outcome.map_quality),
            mean(|row| row.outcome.changing),
            mean(|row| row.outcome.brier),
        );
    }
    table
}

/// How the error falls in a life without training before it. A number of steps that no life of the learner reached is empty.
fn times(all: &[Named]) -> String {
    let titles = TIMES.map(|time| format!(" {} |", thousands(time))).concat();
    let mut table = format!("| learner |{titles}\n|---|{}\n", "---|".repeat(TIMES.len()));
    for named in all.iter().filter(|named| named.rows[0].run.experience == 0) {
        table += &format!("| `{}` |", named.rows[0].run.learner);
        for time in 0..TIMES.len() {
            let error = mean(&named.values(|row| row.outcome.errors[time]));
            table += &if error.is_finite() { format!(" {error:.3} |") } else { "  |".to_owned() };
        }
        table.push('\n');
    }
    table
}
