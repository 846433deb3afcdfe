//! Every choice on the command line runs.

use super::{ran, results, values};
use crate::run::Run;
use std::collections::BTreeSet;

/// The strategies that a program has.
fn strategies(run: &Run) -> Vec<String> {
    values(run, "--strategy")
}

#[test]
fn every_strategy_explores_a_grid_world() {
    let names = strategies(&Run::of("grid_world"));
    assert!(names.len() >= 6 && names.contains(&"curious".to_owned()), "{names:?}");
    let chosen: Vec<String> = names.iter().map(|name| format!("--strategy {name}")).collect();
    let run = ran(&format!("--steps 3000 --trials 1 --estimator two-state {}", chosen.join(" ")));
    let results = results(&run);
    // In the order of the arguments.
    let text = std::fs::read_to_string(run.out("report.json")).unwrap();
    let places: Vec<_> = names.iter().map(|name| text.find(&format!("\"{name}\":{{")).unwrap()).collect();
    assert!(places.is_sorted(), "{places:?}");
    let mut hashes = BTreeSet::new();
    for result in &results {
        let coverage = result.entry["final_coverage"].as_f64().unwrap();
        assert!(coverage > 0.3, "{} saw {coverage}", result.strategy);
        assert_eq!(result.entry["false_change_events"], 0, "{}", result.strategy);
        hashes.insert(result.hashes.clone());
    }
    assert_eq!(hashes.len(), names.len(), "two strategies did the same");
}

#[test]
fn trials_have_the_strategies_of_a_run_and_the_references() {
    let of_run = strategies(&Run::new());
    // The reference needs the ground truth, and is compared with other strategies.
    let references = vec!["full-observation".to_owned()];
    for of_trials in [Run::of("grid_world"), Run::of("house_trials")].map(|run| strategies(&run)) {
        assert_eq!(of_trials, [&of_run[..], &references].concat());
    }
}

#[test]
fn every_estimator_estimates_in_its_own_way() {
    let names = values(&Run::of("grid_world"), "--estimator");
    let chosen: Vec<String> = names.iter().map(|name| format!("--estimator {name}")).collect();
    // Random goals do not depend on rates, so that all runs have the same observations.
    let run = ran(&format!("--steps 3000 --trials 1 --strategy random {}", chosen.join(" ")));
    let results = results(&run);
    assert_eq!(results.iter().map(|result| result.estimator.clone()).collect::<Vec<_>>(), names);
    let seen: BTreeSet<_> = results.iter().map(|it| it.entry["final_coverage"].to_string()).collect();
    assert_eq!(seen.len(), 1, "{seen:?}");
    let errors: BTreeSet<_> = results.iter().map(|it| it.entry["final_log_error"].to_string()).collect();
    assert_eq!(errors.len(), names.len(), "{errors:?}");
}
