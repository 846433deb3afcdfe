//! The targets that the robot must reach in the shipped four rooms in twenty minutes, with any seed.

use crate::run::Run;

#[track_caller]
fn at_least(what: &str, value: f64, bound: f64) {
    assert!(value >= bound, "{what} is {value}, less than {bound}");
}

#[track_caller]
fn at_most(what: &str, value: f64, bound: f64) {
    assert!(value <= bound, "{what} is {value}, more than {bound}");
}

fn holds(seed: u64) {
    let summary = Run::quiet(&format!("--seed {seed}")).summary();
    for [time_s, coverage, map_quality] in summary.curve() {
        if time_s >= 600.0 {
            at_least(&format!("coverage at {time_s} s"), coverage, 0.99);
            at_least(&format!("map quality at {time_s} s"), map_quality, 0.995);
        }
    }
    at_least("balanced accuracy in view", summary.number("/map_quality_changing"), 0.9);
    at_most("false changes", summary.number("/false_change_events"), 0.0);
    at_least("rate AUC", summary.number("/rate_auc"), 0.985);
    at_most("rate error", summary.number("/rate_error"), 0.30);
    at_most("collisions", summary.number("/collisions"), 0.0);
    let [reached, approached, given_up] =
        ["/goals/reached", "/goals/approached", "/goals/given_up"].map(|path| summary.number(path));
    at_least("goals reached or approached", reached + approached, 30.0);
    at_most("share of goals given up", given_up / (reached + approached + given_up), 0.02);
    for (kind, bound_s) in [("block", 0.4), ("free", 1.2)] {
        at_least(kind, summary.number(&format!("/{kind}_latency/shown")), 1000.0);
        at_most(kind, summary.number(&format!("/{kind}_latency/median_s")), bound_s);
        at_most(kind, summary.number(&format!("/{kind}_latency/never_noticed")), 0.05);
    }
}

#[test]
fn targets_hold_with_any_seed() {
    (0..3).for_each(holds);
}

#[test]
fn a_large_building_is_seen_soon() {
    let summary = Run::quiet("--world warehouse --seed 100 --duration 5m").summary();
    at_least("coverage", summary.number("/coverage"), 0.7);
}
