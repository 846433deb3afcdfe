//! From trials to curves and comparisons.

use super::*;

const THREE: [&str; 3] = ["curious", "recency", "poisson"];

/// A trial whose every metric is `value` at both of its samples.
fn flat(world: &str, strategy: &str, seed: u64, value: f64) -> Trial {
    let sample = |time| Sample::new(time, [value; Metric::ALL.len()]);
    Trial {
        world: world.into(),
        estimator: "paper".into(),
        strategy: strategy.into(),
        seed,
        samples: vec![sample(1), sample(100)],
        strategy_share: vec![(strategy.into(), 1.0)],
        false_change_events: 1,
        false_map_changes: 2,
        collisions: Some(2),
        map_hash: String::new(),
    }
}

#[test]
fn nothing_depends_on_the_order_in_which_trials_arrive() {
    let (settings, trials) = experiment(2, &["paper"], &THREE, 4);
    let expected = written(&Report::new(settings.clone(), trials.clone()));
    let mut chance = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..2 {
        let mut shuffled = trials.clone();
        for index in (1..shuffled.len()).rev() {
            shuffled.swap(index, (uniform(&mut chance) * (index + 1) as f64) as usize);
        }
        assert!(shuffled != trials);
        assert!(written(&Report::new(settings.clone(), shuffled)) == expected);
    }
}

#[test]
fn runs_and_strategies_come_as_they_were_asked_for() {
    let (mut settings, trials) = experiment(2, &["two-state", "paper"], &THREE, 2);
    let order = |settings: &ReportSettings| {
        let report = Report::new(settings.clone(), trials.clone());
        let name = |run: &Run| format!("{}/{}", run.world, run.estimator);
        let strategies = report.runs[0].strategies.iter().map(|strategy| strategy.name.clone());
        (report.runs.iter().map(name).collect::<Vec<_>>(), strategies.collect::<Vec<_>>())
    };
    let (runs, strategies) = order(&settings);
    let of_world = |world: &str| ["two-state", "paper"].map(|estimator| format!("{world}/{estimator}"));
    assert_eq!(runs, ["two_blocks", "generated 1", "all worlds (2)"].map(of_world).concat());
    assert_eq!(strategies, THREE);
    settings.worlds.reverse();
    settings.estimators.clear();
    settings.strategies = vec!["poisson".into()];
    let (runs, strategies) = order(&settings);
    assert_eq!(runs[0], "generated 1/paper");
    assert_eq!(strategies, ["poisson", "curious", "recency"], "the others by name");
}

#[test]
fn a_curve_is_the_mean_of_its_trials_with_what_is_undefined_left_out() {
    let mut trials = vec![flat("a", "x", 0, 1.0), flat("a", "x", 1, 2.0), flat("a", "x", 2, 6.0)];
    trials[2].samples[0].rate_error = f64::NAN;
    let report = Report::new(ReportSettings::default(), trials);
    let strategy = report.runs[0].strategy("x").unwrap();
    let curve = strategy.curve(Metric::RateError);
    assert_eq!((curve[0].count, curve[0].mean, curve[1].count, curve[1].mean), (2, 1.5, 3, 3.0));
    // 4.3027 √7 / √3 around 3.
    close(curve[1].high, 3.0 + 4.302_65 * (7.0_f64 / 3.0).sqrt(), 1e-4);
    assert_eq!(strategy.value(Measure::Final(Metric::RateError)), 3.0);
    assert_eq!((strategy.trials, strategy.false_change_events, strategy.collisions), (3, 3, Some(6)));
    assert_eq!(strategy.false_map_changes, 6);
}

#[test]
fn no_band_exceeds_what_its_metric_can_be() {
    let report = Report::new(ReportSettings::default(), vec![flat("a", "x", 0, 0.1), flat("a", "x", 1, 0.9)]);
    let strategy = report.runs[0].strategy("x").unwrap();
    for metric in Metric::ALL {
        let at = strategy.curve(metric)[1];
        assert_eq!(at.mean, 0.5, "{metric:?}");
        let apart: f64 = 12.7062 * 0.4; // Student's t of two values
        close(at.low, (0.5 - apart).max(*metric.range().start()), 1e-4);
        close(at.high, (0.5 + apart).min(*metric.range().end()), 1e-4);
    }
}

#[test]
fn trials_are_paired_by_seed_and_a_missing_one_costs_its_pair() {
    // Differences x − y of seeds 1, 2 and 4: −1, −2, −3. Seeds 0 and 7 have no partner.
    let x = [(0, 99.0), (1, 1.0), (2, 2.0), (4, 3.0)].map(|(seed, value)| flat("a", "x", seed, value));
    let y = [(1, 2.0), (2, 4.0), (4, 6.0), (7, -50.0)].map(|(seed, value)| flat("a", "y", seed, value));
    let report = Report::new(ReportSettings::default(), [x, y].concat());
    let run = report.run("a", "paper").unwrap();
    let found = run.comparison("x", "y", Measure::Final(Metric::RateError)).unwrap();
    assert_eq!((found.pairs, found.mean_difference, found.ratio), (3, -2.0, 0.5));
    // The deviation is 1, so t = −2 √3 with 2 degrees of freedom: p = 1 − t/√(t² + 2).
    close(found.p_value, 1.0 - (12.0_f64 / 14.0).sqrt(), 1e-9);
    close(found.effect_size, -2.0, 1e-12);
    close(found.low, -2.0 - 4.302_653 / 3.0_f64.sqrt(), 1e-5);
    assert_eq!(found.p_holm, found.p_value, "one test in its family");
    let flipped = run.comparison("y", "x", Measure::Final(Metric::RateError)).unwrap();
    assert_eq!((flipped.mean_difference, flipped.low, flipped.high), (2.0, -found.high, -found.low));
    assert_eq!((flipped.ratio, flipped.p_value), (2.0, found.p_value));
    assert_eq!(flipped.flipped(), found);
}

#[test]
fn every_pair_of_strategies_is_compared_in_every_measure() {
    let report = report(1, &["paper"], &["curious", "recency", "poisson", "random", "coin"], 3);
    let run = &report.runs[0];
    assert_eq!(run.comparisons.len(), 10 * Measure::COMPARED.len());
    for comparison in &run.comparisons {
        assert_eq!(comparison.pairs, 3);
        assert!((comparison.low..=comparison.high).contains(&comparison.mean_difference));
        assert!((comparison.p_value..=1.0).contains(&comparison.p_holm), "{comparison:?}");
        let means =
            [&comparison.a, &comparison.b].map(|name| run.strategy(name).unwrap().value(comparison.measure));
        close(comparison.mean_difference, means[0] - means[1], 1e-12);
        close(comparison.ratio, means[0] / means[1], 1e-12);
    }
}

#[test]
fn over_all_worlds_a_world_counts_once_and_is_the_pair() {
    // World b has three trials and a has one: their means are 2 and 6.
    let x = [flat("a", "x", 0, 6.0), flat("b", "x", 0, 1.0), flat("b", "x", 1, 2.0), flat("b", "x", 2, 3.0)];
    let y = [flat("a", "y", 0, 7.0), flat("b", "y", 0, 5.0)];
    let report = Report::new(ReportSettings::default(), [x.as_slice(), &y].concat());
    let all = report.run("all worlds (2)", "paper").unwrap();
    let strategy = all.strategy("x").unwrap();
    assert_eq!(strategy.value(Measure::PRIMARY), 4.0);
    assert_eq!((strategy.curve(Metric::LogError)[1].count, strategy.trials), (2, 4));
    let found = all.comparison("x", "y", Measure::PRIMARY).unwrap();
    // Differences −1 and −3.
    assert_eq!((found.pairs, found.mean_difference, found.ratio), (2, -2.0, 8.0 / 12.0));
    // Student's interval would end at 10.7: more than two log errors can differ by.
    close(found.high, std::f64::consts::LN_10, 1e-12);
    close(all.comparison("x", "y", Measure::Area(Metric::RateError)).unwrap().high, -2.0 + 12.7062, 1e-3);
    assert_eq!(report.runs.len(), 3);
    assert!(report.run("all worlds (2)", "two-state").is_none());
}

#[test]
#[should_panic(expected = "trials are sampled at the same times")]
fn trials_of_different_times_are_refused() {
    let mut trials = vec![flat("a", "x", 0, 1.0), flat("a", "x", 1, 1.0)];
    trials[1].samples.pop();
    Report::new(ReportSettings::default(), trials);
}
