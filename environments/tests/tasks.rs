//! The tasks as a learner uses them.

use environments::{
    Batch, Drive, DrivePlace, DriveSettings, Explore, ExploreGoals, ExplorePlace, ExploreSettings,
    GoalSettings, Results, Task, TaskError, driving_hall,
};
use sim::physics::{SnapshotError, WorldSpec};
use std::sync::Arc;

/// An action that depends on the environment and the step.
fn action(environment: usize, step: usize) -> [f32; 2] {
    let phase = environment as f64 * 0.7 + step as f64 * 0.13;
    [libm::cos(phase) as f32, libm::sin(phase * 1.7) as f32]
}

/// The bits of observations, rewards and ends.
fn bits(results: &Results) -> Vec<u32> {
    let numbers =
        results.observations.iter().chain(&results.rewards).chain(&results.info).map(|value| value.to_bits());
    numbers.chain(results.terminated.iter().chain(&results.truncated).map(|is| u32::from(*is))).collect()
}

fn drive_place(settings: DriveSettings) -> Arc<DrivePlace> {
    Arc::new(DrivePlace::new(&driving_hall(), settings).unwrap())
}

fn explore_place(settings: ExploreSettings) -> Arc<ExplorePlace> {
    let houses: Vec<WorldSpec> = [3, 5].map(WorldSpec::generate_house).into();
    Arc::new(ExplorePlace::new(&houses, settings).unwrap())
}

/// The bits of every step of a batch, environment by environment, with episodes that end in between.
fn run<T: Task + 'static>(tasks: Vec<T>, first: usize, threads: usize, steps: usize) -> Vec<Vec<u32>> {
    let count = tasks.len();
    let mut batch = Batch::new(tasks);
    batch.set_parallel(threads > 1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let seed =
        |episode: u64| (0..count).map(|index| 1000 * episode + (first + index) as u64).collect::<Vec<u64>>();
    pool.install(|| batch.reset(&seed(0))).unwrap();
    let (mut rows, values) = (vec![Vec::new(); count], batch.observation_len());
    let mut resets = 0;
    for step in 0..steps {
        let actions: Vec<f32> =
            (first..first + count).flat_map(|environment| action(environment, step)).collect();
        let results = pool.install(|| batch.step(&actions, &seed(1 + step as u64))).unwrap();
        resets += results.was_reset.iter().filter(|was| **was).count();
        for (index, row) in rows.iter_mut().enumerate() {
            let observation = &results.observations[index * values..(index + 1) * values];
            row.extend(observation.iter().map(|value| value.to_bits()));
            row.push(results.rewards[index].to_bits());
        }
    }
    assert!(resets > 0, "no episode ended");
    rows
}

#[test]
fn alone_and_in_a_batch_on_any_number_of_threads_the_bits_are_the_same() {
    let place = drive_place(DriveSettings { max_steps: 40, ..DriveSettings::default() });
    let tasks = |count| (0..count).map(|_| Drive::new(&place)).collect::<Vec<_>>();
    let together = run(tasks(7), 0, 1, 150);
    assert_eq!(run(tasks(7), 0, 3, 150), together);
    for (index, row) in together.iter().enumerate() {
        assert_eq!(run(tasks(1), index, 1, 150)[0], *row, "environment {index}");
    }
    let mut lengths = Vec::new();
    for shows_local_map in [false, true] {
        let place = explore_place(ExploreSettings {
            max_steps: 25,
            beams: Some(60),
            shows_local_map,
            ..ExploreSettings::default()
        });
        let tasks = |count| (0..count).map(|_| Explore::new(&place).unwrap()).collect::<Vec<_>>();
        let together = run(tasks(4), 0, 1, 60);
        assert_eq!(run(tasks(4), 0, 2, 60), together);
        assert_eq!(run(tasks(1), 2, 1, 60)[0], together[2]);
        lengths.push(together[0].len() / 60);
    }
    assert_eq!(lengths[1] - lengths[0], 7 * 32 * 32);
}

#[test]
fn a_local_map_changes_nothing_else() {
    let results = [false, true].map(|shows_local_map| {
        let settings = ExploreSettings { beams: Some(60), shows_local_map, ..ExploreSettings::default() };
        let mut batch = Batch::new(vec![Explore::new(&explore_place(settings)).unwrap()]);
        batch.reset(&[5]).unwrap();
        (0..40).map(|step| batch.step(&action(0, step), &[9]).unwrap()).collect::<Vec<_>>()
    });
    let [without, with] = results;
    for (without, with) in without.iter().zip(&with) {
        let (same, local) = with.observations.split_at(without.observations.len());
        assert_eq!(
            (same, &with.rewards, &with.info),
            (&without.observations[..], &without.rewards, &without.info)
        );
        assert!(local.iter().all(|value| (0.0..=1.0).contains(value)) && local.iter().sum::<f32>() > 100.0);
    }
    let refused = |settings| ExplorePlace::of_houses(vec![1], settings).err().unwrap().to_string();
    assert_eq!(
        refused(ExploreSettings { local_map_cells: 1, ..ExploreSettings::default() }),
        "exploring task setting `local_map_cells` must be from 2 to 256, not 1"
    );
    assert_eq!(
        refused(ExploreSettings { local_map_cell_m: 0.01, ..ExploreSettings::default() }),
        "exploring task setting `local_map_cell_m` must be from 0.05 to 2, not 0.01"
    );
}

#[test]
fn a_snapshot_goes_on_bit_by_bit() {
    fn check(mut here: Batch, mut there: Batch) {
        here.reset(&[5]).unwrap();
        there.reset(&[6]).unwrap();
        for step in 0..30 {
            here.step(&action(0, step), &[9]).unwrap();
        }
        let snapshot = here.snapshot(0);
        there.restore(0, &snapshot).unwrap();
        assert_eq!(there.snapshot(0), snapshot);
        for step in 30..60 {
            let [results, other] =
                [&mut here, &mut there].map(|batch| batch.step(&action(0, step), &[9]).unwrap());
            assert_eq!(bits(&results), bits(&other));
        }
        assert_eq!(there.restore(0, &snapshot[1..]), Err(SnapshotError::Damaged));
    }
    for shows_memory in [false, true] {
        let place = drive_place(DriveSettings { shows_memory, ..DriveSettings::default() });
        check(Batch::new(vec![Drive::new(&place)]), Batch::new(vec![Drive::new(&place)]));
    }
    let settings = ExploreSettings { beams: Some(60), shows_local_map: true, ..ExploreSettings::default() };
    let place = explore_place(settings);
    let one = || Batch::new(vec![Explore::new(&place).unwrap()]);
    check(one(), one());
}

#[test]
fn a_memory_shows_where_the_robot_was_and_forgets_it_with_the_episode() {
    let settings = DriveSettings { shows_memory: true, shows_path: false, ..DriveSettings::default() };
    let mut task = Drive::new(&drive_place(settings));
    let mut results =
        Results { rewards: vec![0.0], terminated: vec![false], truncated: vec![false], ..Results::default() };
    let len = task.parts()[0].values();
    assert_eq!(len, 64 + 7 + 2 * 64);
    let layers = |task: &mut Drive| {
        let mut observation = vec![0.0; len];
        task.observe(&mut observation);
        assert_eq!(observation[67..69], [0.0; 2], "no path");
        observation.split_off(71)
    };
    // In the cells at 0.5 m the robot never was, or they are beyond the world.
    let is_visited = |share: &f32| *share > 0.0 && *share < 1.0;
    task.reset(3);
    let first = layers(&mut task);
    assert!(!first[..16].iter().any(is_visited) && first[64..].iter().sum::<f32>() > 5.0, "{first:?}");
    (0..60).for_each(|_| task.step(&[1.0, 0.4], &mut results));
    let then = layers(&mut task);
    assert!(then[..16].iter().any(is_visited) && then[64..] != first[64..], "{then:?}");
    task.reset(3);
    assert_eq!(layers(&mut task), first);
}

/// Follows the direction of the shortest path, and slows down where the scan is near ahead.
fn follow(observation: &[f32]) -> [f32; 2] {
    let (scan, state) = observation.split_at(observation.len() - 7);
    let (cos, sin) = (f64::from(state[3]), f64::from(state[4]));
    let turn = (libm::atan2(sin, cos) * 1.2).clamp(-1.0, 1.0);
    let ahead = scan.len() / 2;
    let near = scan[ahead - 4..=ahead + 4].iter().fold(1.0_f32, |least, range| least.min(*range));
    let speed = if cos < 0.5 { 0.0 } else { (f64::from(near) * 4.0 - 0.2).clamp(0.1, 1.0) * cos };
    [speed as f32, turn as f32]
}

#[test]
fn the_goals_of_the_hall_are_far_and_can_be_reached() {
    let place = drive_place(DriveSettings::default());
    let mut batch = Batch::new((0..100).map(|_| Drive::new(&place)));
    batch.set_autoreset(false);
    let first = batch.reset(&(0..100).collect::<Vec<u64>>()).unwrap();
    for task in (0..100).map(|index| batch.task(index)) {
        let at = task.fleet().robot(0).unwrap().pose.translation.vector;
        assert!((task.goal(0).unwrap().coords - at).norm() >= 3.0);
    }
    let mut results = Results { observations: first.clone(), ..Results::default() };
    for _ in 0..400 {
        let len = batch.observation_len();
        let actions: Vec<f32> = results.observations.chunks(len).flat_map(follow).collect();
        results = batch.step(&actions, &[0; 100]).unwrap();
        assert!(results.observations.iter().all(|value| (-1.0..=1.0).contains(value)));
        assert!(!results.was_reset.contains(&true));
    }
    let reached = results.terminated.iter().filter(|is| **is).count();
    assert!(reached >= 90, "{reached} of 100 goals");
    assert!(
        results
            .terminated
            .iter()
            .zip(&results.truncated)
            .all(|(terminated, truncated)| terminated != truncated)
    );
    // The same seeds are the same episodes again.
    assert_eq!(batch.reset(&(0..100).collect::<Vec<u64>>()).unwrap(), first);
}

#[test]
fn exploring_earns_map_updates_and_the_fall_of_the_log_error() {
    let settings = ExploreSettings { max_steps: 600, collision_reward: 0.0, ..ExploreSettings::version_0() };
    let place = explore_place(settings.clone());
    let mut batch = Batch::new(vec![Explore::new(&place).unwrap()]);
    batch.set_autoreset(false);
    batch.reset(&[4]).unwrap();
    let (mut sum, mut results) = (0.0, Results::default());
    for step in 0..600 {
        let turn = if step % 100 < 60 { 0.0 } else { 0.6 };
        results = batch.step(&[0.5, turn], &[0]).unwrap();
        assert!(results.observations.iter().all(|value| (-1.0..=1.0).contains(value)), "step {step}");
        sum += f64::from(results.rewards[0]);
    }
    assert_eq!((results.terminated[0], results.truncated[0]), (false, true));
    let [_, updates, log_error, ..] = results.info[..] else { panic!("{:?}", results.info) };
    let fleet = batch.task(0).fleet();
    assert!(updates > 0.0 && (fleet.time_s() - 60.0).abs() < 1e-9);
    let robot = &fleet.spec().robots[fleet.spec().driven_robots().next().unwrap()];
    let cells_wide = 2.0 * robot.radius_m / fleet.spec().frame.resolution_m();
    let fall = evaluation::metrics::MAX_LOG_ERROR - f64::from(log_error);
    let expected = settings.update_reward * f64::from(updates) / cells_wide + settings.error_reward * fall;
    assert!((sum - expected).abs() < 1e-3 * expected.abs().max(1.0), "{sum} and not {expected}");
}

#[test]
fn invalid_input_is_refused_and_changes_nothing() {
    let place = drive_place(DriveSettings::default());
    let mut batch = Batch::new((0..2).map(|_| Drive::new(&place)));
    batch.reset(&[1, 2]).unwrap();
    let before = [0, 1].map(|index| batch.snapshot(index));
    let message = |error: Result<Results, TaskError>| error.unwrap_err().to_string();
    for (value, printed) in [(f32::NAN, "NaN"), (1.5, "1.5"), (f32::NEG_INFINITY, "-inf")] {
        let error = message(batch.step(&[0.0, 0.0, 0.0, value], &[3, 4]));
        assert_eq!(error, format!("action {printed} of environment 1 is not from -1 to 1"));
    }
    assert_eq!(message(batch.step(&[0.0; 3], &[3, 4])), "actions: 3 values, and not 4");
    assert_eq!(message(batch.step(&[0.0; 4], &[3])), "seeds: 1 values, and not 2");
    assert_eq!([0, 1].map(|index| batch.snapshot(index)), before);
    let refused = |settings| DrivePlace::new(&driving_hall(), settings).err().unwrap().to_string();
    assert_eq!(
        refused(DriveSettings { decision_s: 0.25, ..DriveSettings::default() }),
        "a decision every 0.25 s is not a whole number of physics steps of 0.1 s"
    );
    assert_eq!(
        refused(DriveSettings { goal_radius_m: 0.0, ..DriveSettings::default() }),
        "driving task setting `goal_radius_m` must be a positive number, not 0"
    );
    let mut nobody = driving_hall();
    nobody.robots.remove(0);
    let error = DrivePlace::new(&nobody, DriveSettings::default()).err().unwrap();
    assert!(matches!(error, TaskError::NoDrivenRobot { .. }), "{error}");
    assert_eq!(ExplorePlace::new(&[], ExploreSettings::default()).err(), Some(TaskError::NoWorld));
}

/// FNV-1a over all bits of observations and rewards, of actions that are exact in binary. `python/tests/test_envs.py`
/// has the same steps and the same numbers: Python and Rust give the same bits.
fn golden<T: Task + 'static>(tasks: Vec<T>) -> u64 {
    let count = tasks.len();
    let mut batch = Batch::new(tasks);
    let seeds = |first: usize| (first..first + count).map(|seed| seed as u64).collect::<Vec<u64>>();
    batch.reset(&seeds(0)).unwrap();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for step in 0..60 {
        let action = |index: usize| ((index * 7 + step * 3) % 17) as f32 / 8.0 - 1.0;
        let actions: Vec<f32> = (0..2 * count).map(action).collect();
        let results = batch.step(&actions, &seeds(100 + step)).unwrap();
        for value in results.observations.iter().chain(&results.rewards) {
            hash = (hash ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3);
        }
    }
    hash
}

#[test]
fn golden_hashes() {
    let place = drive_place(DriveSettings { max_steps: 40, ..DriveSettings::default() });
    let driving = golden((0..3).map(|_| Drive::new(&place)).collect());
    let place =
        explore_place(ExploreSettings { max_steps: 40, beams: Some(20), ..ExploreSettings::version_0() });
    let exploring = golden((0..2).map(|_| Explore::new(&place).unwrap()).collect());
    assert_eq!([driving, exploring], [6_763_501_705_012_223_895, 17_686_607_519_096_061_081]);
}

fn goal_tasks(count: usize, max_steps: u32) -> Vec<ExploreGoals> {
    let settings = ExploreSettings {
        max_steps,
        beams: Some(60),
        shows_local_map: true,
        local_map_cells: 16,
        ..ExploreSettings::default()
    };
    let place = Arc::new(ExplorePlace::of_houses((100..120).collect(), settings).unwrap());
    let goals = Arc::new(GoalSettings { shows_routes: true, ..GoalSettings::default() });
    (0..count).map(|_| ExploreGoals::new(&place, &goals).unwrap()).collect()
}

/// The bits of some steps with goals; episodes end in between.
fn run_goals(first: usize, count: usize, is_parallel: bool) -> Vec<Vec<u32>> {
    let mut batch = Batch::new(goal_tasks(count, 300));
    batch.set_parallel(is_parallel);
    batch.reset(&(first..first + count).map(|seed| seed as u64).collect::<Vec<_>>()).unwrap();
    let (mut rows, values) = (vec![Vec::new(); count], batch.observation_len());
    let mut resets = 0;
    for step in 0..6 {
        let actions: Vec<f32> = (first..first + count).map(|index| ((index + step) % 8) as f32).collect();
        let next: Vec<u64> = (first..first + count).map(|index| (100 * step + index) as u64).collect();
        let results = batch.step(&actions, &next).unwrap();
        assert!(results.observations.iter().all(|value| (-1.0..=1.0).contains(value)));
        resets += results.was_reset.iter().filter(|was| **was).count();
        for (index, row) in rows.iter_mut().enumerate() {
            let observation = &results.observations[index * values..(index + 1) * values];
            row.extend(observation.iter().chain([&results.rewards[index]]).map(|value| value.to_bits()));
        }
    }
    assert!(resets > 0, "no episode ended");
    rows
}

/// The results of some steps with goals, with or without routes in the observation.
fn steps_of_goals(shows_routes: bool) -> Vec<(Vec<f32>, Vec<f32>, Vec<f32>)> {
    let settings = ExploreSettings { beams: Some(60), ..ExploreSettings::default() };
    let place = Arc::new(ExplorePlace::of_houses((100..120).collect(), settings).unwrap());
    let goals = Arc::new(GoalSettings { shows_routes, ..GoalSettings::default() });
    let mut batch = Batch::new(vec![ExploreGoals::new(&place, &goals).unwrap()]);
    batch.reset(&[5]).unwrap();
    let step = |step: usize| {
        let results = batch.step(&[(step % 8) as f32], &[9]).unwrap();
        (results.observations.clone(), results.rewards.clone(), results.info.clone())
    };
    (0..12).map(step).collect()
}

#[test]
fn routes_change_nothing_else() {
    for (without, with) in steps_of_goals(false).iter().zip(&steps_of_goals(true)) {
        let (same, routes) = with.0.split_at(without.0.len());
        assert_eq!((same, &with.1, &with.2), (&without.0[..], &without.1, &without.2));
        assert_eq!(routes.len(), 8 * 7);
        assert!(routes.iter().all(|value| (0.0..=1.0).contains(value)) && routes.iter().sum::<f32>() > 1.0);
    }
}

#[test]
fn a_step_that_ends_on_arrival_takes_less_time() {
    let place = Arc::new(ExplorePlace::of_houses((100..120).collect(), ExploreSettings::default()).unwrap());
    let times = |stays_at_goals| {
        let goals = Arc::new(GoalSettings { stays_at_goals, ..GoalSettings::default() });
        let mut batch = Batch::new(vec![ExploreGoals::new(&place, &goals).unwrap()]);
        let mut first_step = |choice| {
            batch.reset(&[5]).unwrap();
            *batch.step(&[choice as f32], &[9]).unwrap().info.last().unwrap()
        };
        (0..8).map(&mut first_step).collect::<Vec<_>>()
    };
    let (without, with) = (times(false), times(true));
    assert!(without.iter().zip(&with).all(|(without, with)| without <= with), "{without:?} {with:?}");
    assert!(without.iter().sum::<f32>() < 0.9 * with.iter().sum::<f32>(), "{without:?} {with:?}");
}

#[test]
fn goals_have_the_same_bits_alone_and_in_a_batch() {
    let together = run_goals(0, 3, true);
    assert_eq!(run_goals(0, 3, false), together);
    assert_eq!(run_goals(1, 1, false)[0], together[1]);
}

#[test]
fn a_snapshot_of_goals_goes_on_bit_by_bit() {
    let [mut here, mut there] = [5, 6].map(|seed| {
        let mut batch = Batch::new(goal_tasks(1, 3000));
        batch.reset(&[seed]).unwrap();
        batch
    });
    (0..4).for_each(|step| drop(here.step(&[(step % 8) as f32], &[9]).unwrap()));
    let snapshot = here.snapshot(0);
    there.restore(0, &snapshot).unwrap();
    assert_eq!(there.snapshot(0), snapshot);
    for step in 4..10 {
        let [results, other] =
            [&mut here, &mut there].map(|batch| batch.step(&[(step % 8) as f32], &[9]).unwrap());
        assert_eq!(bits(&results), bits(&other), "step {step}");
    }
    assert_eq!(there.restore(0, &snapshot[1..]), Err(SnapshotError::Damaged));
}

#[test]
fn an_exploring_task_that_is_over_stands_still() {
    let place =
        explore_place(ExploreSettings { max_steps: 30, beams: Some(60), ..ExploreSettings::default() });
    let settings = Arc::new(GoalSettings::default());
    let mut batches = [
        Batch::new(vec![Explore::new(&place).unwrap()]),
        Batch::new(vec![ExploreGoals::new(&place, &settings).unwrap()]),
    ];
    for (batch, action) in batches.iter_mut().zip([&[1.0, 0.3][..], &[1.0]]) {
        batch.set_autoreset(false);
        batch.reset(&[4]).unwrap();
        let mut step = || batch.step(action, &[0]).unwrap();
        let last = (0..31).map(|_| step()).find(|results| results.truncated[0]).unwrap();
        let after = step();
        assert_eq!((after.rewards[0], after.terminated[0], after.truncated[0]), (0.0, false, true));
        assert_eq!((after.observations, after.info), (last.observations, last.info));
    }
}

#[test]
fn a_snapshot_has_the_seed_of_its_episode() {
    let place = drive_place(DriveSettings::default());
    let mut batch = Batch::new((0..2).map(|_| Drive::new(&place)));
    batch.reset(&[7, 8]).unwrap();
    let snapshot = batch.snapshot(1);
    batch.reset(&[9, 10]).unwrap();
    batch.restore(0, &snapshot).unwrap();
    assert_eq!([batch.seed(0), batch.seed(1)], [8, 10]);
}

#[test]
fn choices_are_whole_numbers() {
    let mut batch = Batch::new(goal_tasks(2, 3000));
    batch.reset(&[1, 2]).unwrap();
    for (value, printed) in [(8.0, "8"), (0.5, "0.5"), (-1.0, "-1"), (f32::NAN, "NaN")] {
        let error = batch.step(&[0.0, value], &[3, 4]).unwrap_err().to_string();
        assert_eq!(error, format!("action {printed} of environment 1 is not a whole number from 0 to 7"));
    }
}

/// In a minute, a robot that stands still earns the area of its first view alone.
#[test]
fn standing_still_earns_next_to_nothing() {
    let settings = ExploreSettings { max_steps: 600, beams: Some(90), ..ExploreSettings::default() };
    let place = Arc::new(ExplorePlace::of_houses((0..8).collect(), settings).unwrap());
    let goals = Arc::new(GoalSettings::default());
    let total = |tasks: Vec<Box<dyn Task>>, action: &[f32]| {
        let mut sum = 0.0;
        for (seed, mut task) in tasks.into_iter().enumerate() {
            task.reset(seed as u64);
            let mut results = Results {
                rewards: vec![0.0],
                terminated: vec![false],
                truncated: vec![false],
                ..Results::default()
            };
            while !results.truncated[0] {
                task.step(action, &mut results);
                sum += f64::from(results.rewards[0]);
            }
        }
        sum
    };
    let standing = (0..6).map(|_| Box::new(Explore::new(&place).unwrap()) as Box<dyn Task>).collect();
    let exploring =
        (0..6).map(|_| Box::new(ExploreGoals::new(&place, &goals).unwrap()) as Box<dyn Task>).collect();
    let (standing, exploring) = (total(standing, &[0.0, 0.0]), total(exploring, &[0.0]));
    assert!(exploring > 6.0 * 5.0 && standing < 0.25 * exploring, "{standing} and {exploring}");
}
