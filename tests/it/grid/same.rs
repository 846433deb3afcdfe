//! The results depend on the seed, and on nothing else.

use super::{hash, ran};
use crate::run::{Run, names};
use std::collections::BTreeSet;

const ARGUMENTS: &str =
    "--steps 800 --trials 2 --world two_blocks --generate 2 --strategy curious --strategy coin";

/// All output files of a run.
pub(crate) fn files(run: &Run) -> Vec<(String, Vec<u8>)> {
    let content = |name: String| (name.clone(), std::fs::read(run.out(&name)).unwrap());
    names(&run.path("out")).into_iter().map(content).collect()
}

/// The same names, and the same bytes.
#[track_caller]
pub(crate) fn assert_same(found: &[(String, Vec<u8>)], expected: &[(String, Vec<u8>)], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for ((name, bytes), (expected_name, expected)) in found.iter().zip(expected) {
        assert!(name == expected_name && bytes == expected, "{name} differs {what}");
    }
}

#[test]
fn on_any_number_of_threads_and_again() {
    let reference = files(&ran(&format!("{ARGUMENTS} --threads 1")));
    for threads in [1, 2, 3] {
        let found = files(&ran(&format!("{ARGUMENTS} --threads {threads}")));
        assert_same(&found, &reference, &format!("on {threads} threads"));
    }
}

#[test]
fn seeds_count_up_from_the_first() {
    let common = "--steps 800 --estimator paper --strategy curious";
    let three = super::results(&ran(&format!("{common} --trials 3 --seed 7")));
    for (seed, found) in &three[0].hashes {
        assert_eq!(hash(&format!("{common} --trials 1 --seed {seed}")), *found, "seed {seed}");
    }
    let hashes: BTreeSet<_> = three[0].hashes.iter().map(|(_, hash)| hash).collect();
    assert_eq!(hashes.len(), 3, "other seeds differ");
}

/// A trial does not depend on the other trials of the run.
#[test]
fn a_trial_does_not_depend_on_the_others() {
    let alone = hash("--steps 800 --trials 1 --seed 2 --estimator paper --strategy poisson");
    let among = ran(
        "--steps 800 --trials 2 --seed 1 --estimator two-state --estimator paper --strategy coin --strategy poisson",
    );
    let results = super::results(&among);
    let same = results.iter().find(|it| it.estimator == "paper" && it.strategy == "poisson").unwrap();
    assert!(same.hashes.contains(&("2".to_owned(), alone)), "{:?}", same.hashes);
}
