use super::*;
use interfaces::PoseMode;
use mapper::Paper;
use sim::grid::{GenerateSettings, GridSpec};
use sim::physics::WorldSpec;

fn strategy(name: &str) -> TrialStrategy {
    TrialStrategy::all().find(|strategy| strategy.name() == name).unwrap()
}

/// One trial of every strategy in a world.
fn trials<W: TrialWorld>(world: W, length: u64, strategies: &[&str], robot: W::Robot) -> Vec<Trial> {
    let experiment = Experiment {
        worlds: vec![world],
        estimators: vec![Paper.into()],
        strategies: strategies.iter().map(|name| strategy(name)).collect(),
        trials: 1,
        seed: 5,
        length,
        robot,
    };
    experiment.run(experiment.jobs(), &AtomicBool::new(false), |_| ()).unwrap()
}

#[test]
fn a_robot_that_observes_every_cell_has_the_true_map() {
    let grid = GridSpec::generate(&GenerateSettings::default(), 5);
    let of_grid = trials(grid, 500, &["full-observation", "random"], GridRobot::default());
    let house = WorldSpec::generate_house(5);
    let of_house = trials(house, 90, &["full-observation", "random"], PhysicsRobot::default());
    for (trials, end) in [(of_grid, 500), (of_house, 90)] {
        let [full, random] = [&trials[0], &trials[1]].map(|trial| *trial.samples.last().unwrap());
        assert_eq!((full.time, full.map_quality, full.coverage), (end, 1.0, 1.0));
        assert!(full.log_error < random.log_error, "{} {}", full.log_error, random.log_error);
        assert_eq!(trials[0].false_change_events, 0);
        assert_eq!(trials[0].collisions.is_some(), end == 90);
    }
}

#[test]
fn samples_of_a_physics_world_are_at_whole_seconds() {
    for length in [7, 90] {
        let trial =
            trials(WorldSpec::generate_house(5), length, &["recency"], PhysicsRobot::default()).remove(0);
        let times: Vec<u64> = trial.samples.iter().map(|sample| sample.time).collect();
        assert!(times.is_sorted_by(|a, b| a < b) && times.last() == Some(&length), "{times:?}");
        assert!(times.len() == 80.min(length as usize), "{times:?}");
    }
}

#[test]
fn a_robot_that_drifts_is_localized_unless_its_poses_are_chosen() {
    let house = WorldSpec::generate_house(5);
    let mut fleet = house.fleet().clone();
    fleet.robots[house.driven_index()].odometry.turn_gain = 0.1;
    let drifting = WorldSpec::driving(fleet, house.driven_index()).unwrap();
    let trial = |pose| {
        let robot = PhysicsRobot { pose, ..PhysicsRobot::default() };
        trials(drifting.clone(), 60, &["recency"], robot).remove(0)
    };
    let [default, localized, odometry] =
        [None, Some(PoseMode::Localized), Some(PoseMode::Odometry)].map(trial);
    assert_eq!(default.map_hash, localized.map_hash);
    let [localized, odometry] = [localized, odometry].map(|trial| trial.false_change_events);
    assert!(5 * localized < odometry, "{localized} false changes, {odometry} by odometry");
}
