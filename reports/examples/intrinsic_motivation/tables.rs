//! The tables of the study: the error over a life, and how it falls.

use crate::life::TIMES;
use crate::rows::Row;
use crate::runs::learners;
use reports::pages::mean;

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
        let pairs: Vec<(f64, f64)> = self.rows.iter().filter_map(pair).collect();
        let [sum, others] = [0, 1].map(|which| pairs.iter().map(|pair| [pair.0, pair.1][which]).sum::<f64>());
        let test = reports::paired_test(pairs.iter().map(|(value, other)| value - other));
        format!("{:.2}, p = {:.1e}", sum / others, test.p_value)
    }
}

/// Prints the tables of all rows, for each estimator.
pub(crate) fn print(mut rows: Vec<Row>) {
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
    // Of two lives of the same, the longer one: its beginning is the shorter one.
    rows.dedup_by(|b, a| {
        let key = |row: &Row| {
            (row.run.estimator.clone(), row.run.learner.clone(), row.run.experience, row.run.seed)
        };
        key(a) == key(b)
    });
    for of_estimator in rows.chunk_by(|a, b| a.run.estimator == b.run.estimator) {
        let named: Vec<Named> = of_estimator
            .chunk_by(|a, b| (&a.run.learner, a.run.experience) == (&b.run.learner, b.run.experience))
            .map(|rows| Named { rows })
            .collect();
        print_areas(&of_estimator[0].run.estimator, &named);
        print_times(&named);
    }
}

fn print_areas(estimator: &str, all: &[Named]) {
    println!("\nEstimator {estimator}: mean log error of the rates over the first steps of a life");
    println!(
        "| learner | experience | worlds | 5,000 | 20,000 | ÷ `curious` | ÷ `information-gain` | map | changing | Brier |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let references = REFERENCES.map(|name| all.iter().find(|named| named.rows[0].run.learner == name));
    for named in all {
        let run = &named.rows[0].run;
        let mean = |value: fn(&Row) -> f64| mean(&named.values(value));
        let [to_curious, to_gain] = references.map(|other| {
            other.map_or(String::new(), |other| named.compared(other, |row| row.outcome.areas[1]))
        });
        println!(
            "| {} | {} | {} | {:.3} | {:.3} | {to_curious} | {to_gain} | {:.3} | {:.3} | {:.3} |",
            run.learner,
            run.experience,
            named.rows.len(),
            mean(|row| row.outcome.areas[0]),
            mean(|row| row.outcome.areas[1]),
            mean(|row| row.outcome.map_quality),
            mean(|row| row.outcome.changing),
            mean(|row| row.outcome.brier),
        );
    }
}

fn print_times(all: &[Named]) {
    println!("\nLog error after this number of steps in the world");
    let times = TIMES.map(|time| format!(" {time} |")).concat();
    println!("| learner | experience |{times}\n|---|---|{}", "---|".repeat(TIMES.len()));
    for named in all {
        let run = &named.rows[0].run;
        let error = |time: usize| mean(&named.values(|row| row.outcome.errors[time]));
        let errors: Vec<String> = (0..TIMES.len()).map(|time| format!(" {:.3} |", error(time))).collect();
        println!("| {} | {} |{}", run.learner, run.experience, errors.concat());
    }
}
