//! Every choice on the command line runs; equal choices give equal runs, others do not.

use crate::run::Run;
use agent::Policy;
use std::collections::BTreeSet;

fn hash(arguments: &str) -> String {
    Run::quiet(arguments).summary().hash().to_owned()
}

#[test]
fn every_strategy_explores_in_its_own_way() {
    let papers = ["poisson", "recency"];
    let mut hashes = BTreeSet::new();
    for strategy in Policy::built_in().iter().map(Policy::name) {
        let summary = Run::quiet(&format!("--duration 3m --strategy {strategy}")).summary();
        assert_eq!(summary.text("/strategy"), strategy);
        let shares = summary.at("/strategy_share").as_object().unwrap();
        let names: Vec<&str> = shares.keys().map(String::as_str).collect();
        let expected = match strategy {
            "curious" | "coin" => &papers[..],
            alone => &[alone],
        };
        assert_eq!(names, expected);
        assert!(summary.number("/coverage") > 0.5, "{strategy} saw {}", summary.number("/coverage"));
        let goals = summary.number("/goals/reached") + summary.number("/goals/approached");
        assert!(goals >= 3.0, "{strategy}");
        assert_eq!(summary.number("/collisions"), 0.0, "{strategy}");
        assert_eq!(summary.number("/false_change_events"), 0.0, "{strategy}");
        hashes.insert(summary.hash().to_owned());
    }
    assert_eq!(hashes.len(), Policy::built_in().len(), "two strategies did the same");
}

#[test]
fn the_seed_decides_and_nothing_else_does() {
    let reference = hash("--duration 60 --seed 7");
    assert_eq!(hash("--duration 1m --seed 7"), reference);
    assert_ne!(hash("--duration 60 --seed 8"), reference);
    assert_ne!(hash("--duration 61 --seed 7"), reference);

    // Neither a recording, nor messages, nor the speed.
    let run = Run::new();
    run.goes_well("--duration 60 --seed 7");
    assert_eq!(run.summary().hash(), reference);
    assert_eq!(hash("--duration 60 --seed 7 --speed 60"), reference);
}
