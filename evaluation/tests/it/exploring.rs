//! A strategy that chooses every goal sees the whole place.

use evaluation::trials::{Experiment, GridRobot, TrialSettings, TrialStrategy, run_trial};
use mapper::EstimatorChoice;
use sim::grid::GridSpec;

#[test]
fn strategies_explore_by_themselves() {
    // In the last world, passages are a cell wide.
    let worlds = [0, 3, 6].map(|seed| GridSpec::generate(&Default::default(), seed));
    let names = ["recency", "coverage", "fresh-map", "information-gain"];
    let experiment = Experiment {
        worlds: worlds.to_vec(),
        estimators: vec![EstimatorChoice::default()],
        strategies: names.map(|name| TrialStrategy::Agent(name.parse().unwrap())).to_vec(),
        trials: 1,
        seed: 1,
        length: 3000,
        robot: GridRobot::default(),
    };
    for (world, strategy) in
        experiment.worlds.iter().flat_map(|world| experiment.strategies.iter().map(move |name| (world, name)))
    {
        let estimator = &experiment.estimators[0];
        let trial = TrialSettings { number: 1, world, estimator, strategy, seed: 1, experiment: &experiment };
        let seen = run_trial(&trial, || true).unwrap().unwrap().samples.last().unwrap().coverage;
        assert!(seen > 0.99, "{} saw {seen} of {}", strategy.name(), world.name);
    }
}
