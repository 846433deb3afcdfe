//! Every choice on the command line runs; equal choices give equal runs, others do not.

use crate::run::Run;
use std::collections::BTreeSet;

fn hash(arguments: &str) -> String {
    Run::quiet(arguments).summary().hash().to_owned()
}

#[test]
fn every_strategy_explores_in_its_own_way() {
    let mut hashes = BTreeSet::new();
    for (strategy, alone) in
        [("curious", false), ("coin", false), ("recency", true), ("poisson", true), ("random", true)]
    {
        let summary = Run::quiet(&format!("--duration 3m --strategy {strategy}")).summary();
        assert_eq!(summary.text("/strategy"), strategy);
        let shares = summary.at("/strategy_share").as_object().unwrap();
        let names: Vec<&str> = shares.keys().map(String::as_str).collect();
        assert_eq!(names, if alone { vec![strategy] } else { vec!["poisson", "recency"] });
        assert!(summary.number("/coverage") > 0.5, "{strategy} saw {}", summary.number("/coverage"));
        assert!(summary.number("/goals/reached") >= 3.0, "{strategy}");
        hashes.insert(summary.hash().to_owned());
    }
    assert_eq!(hashes.len(), 5, "two strategies did the same");
}

#[test]
fn every_estimator_estimates_in_its_own_way() {
    let mut errors = BTreeSet::new();
    for estimator in ["paper", "paper-all", "two-state"] {
        // A tour does not depend on rates, so that all of them see the same.
        let arguments = format!("--duration 8m --drive tour --strategy curious --estimator {estimator}");
        let summary = Run::quiet(&arguments).summary();
        assert_eq!(summary.text("/estimator"), estimator);
        assert!(summary.at("/strategy").is_null(), "nobody chose a strategy");
        assert!(summary.number("/rate_auc") > 0.9, "{estimator}: {}", summary.number("/rate_auc"));
        errors.insert(summary.at("/log_error").to_string());
    }
    assert_eq!(errors.len(), 3, "{errors:?}");
}

#[test]
fn the_seed_decides_and_nothing_else_does() {
    let reference = hash("--duration 60 --seed 7");
    assert_eq!(hash("--duration 1m --seed 7"), reference);
    assert_ne!(hash("--duration 60 --seed 8"), reference);
    assert_ne!(hash("--duration 61 --seed 7"), reference);

    // Neither a recording, nor words, nor the pace.
    let run = Run::new();
    run.goes_well("--duration 60 --seed 7");
    assert_eq!(run.summary().hash(), reference);
    assert_eq!(hash("--duration 60 --seed 7 --speed 60"), reference);
}
