//! The tasks as a learner uses them.

use environments::{Batch, Drive, DrivePlace, DriveSettings, Results, TaskError, driving_hall};
use sim::physics::SnapshotError;
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

/// The bits of every step of a batch, environment by environment, with episodes that end in between.
fn run(tasks: Vec<Drive>, first: usize, threads: usize, steps: usize) -> Vec<Vec<u32>> {
    let count = tasks.len();
    let mut batch = Batch::new(tasks);
    batch.is_parallel = threads > 1;
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
}

#[test]
fn a_snapshot_goes_on_bit_by_bit() {
    let mut bare = driving_hall();
    bare.obstacles.clear();
    let elsewhere = Arc::new(DrivePlace::new(&bare, DriveSettings::default()).unwrap());
    for shows_memory in [false, true] {
        let place = drive_place(DriveSettings { shows_memory, ..DriveSettings::default() });
        let [mut here, mut there] = [0, 1].map(|_| Batch::new([Drive::new(&place)]));
        here.reset(&[5]).unwrap();
        there.reset(&[6]).unwrap();
        for step in 0..30 {
            here.step(&action(0, step), &[9]).unwrap();
        }
        let snapshot = here.snapshot(0);
        there.restore(0, &snapshot).unwrap();
        assert_eq!((there.snapshot(0), there.seed(0)), (snapshot.clone(), here.seed(0)));
        for step in 30..60 {
            let [results, other] =
                [&mut here, &mut there].map(|batch| batch.step(&action(0, step), &[9]).unwrap());
            assert_eq!(bits(&results), bits(&other));
        }
        let before = there.snapshot(0);
        assert_eq!(there.restore(0, &snapshot[1..]), Err(SnapshotError::Damaged));
        let mut other = Batch::new([Drive::new(&elsewhere)]);
        other.reset(&[5]).unwrap();
        assert_eq!(there.restore(0, &other.snapshot(0)), Err(SnapshotError::OtherSpec));
        assert_eq!((there.snapshot(0), there.seed(0)), (before, here.seed(0)));
    }
}

#[test]
fn a_memory_shows_where_the_robot_was_and_forgets_it_with_the_episode() {
    let settings = DriveSettings { shows_memory: true, shows_path: false, ..DriveSettings::default() };
    let mut task = Drive::new(&drive_place(settings));
    let mut results =
        Results { rewards: vec![0.0], terminated: vec![false], truncated: vec![false], ..Results::default() };
    let len = task.observation_len();
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
    batch.is_autoreset = false;
    let first = batch.reset(&(0..100).collect::<Vec<u64>>()).unwrap();
    for task in (0..100).map(|index| batch.task(index)) {
        let mut info = [0.0; 3];
        task.info(&mut info);
        assert!(info[2] >= 3.0, "{} m", info[2]);
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
    let mut ends = results.terminated.iter().zip(&results.truncated);
    assert!(ends.all(|(terminated, truncated)| terminated != truncated));
    // The same seeds are the same episodes again.
    assert_eq!(batch.reset(&(0..100).collect::<Vec<u64>>()).unwrap(), first);
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
    let error = DrivePlace::new(&nobody, DriveSettings::default()).err().unwrap().to_string();
    assert!(error.starts_with("no robot of the world `driving hall` is driven: give one of them"), "{error}");
}

/// FNV-1a over all bits of observations and rewards, of actions that are exact in binary. `python/tests/test_envs.py`
/// has the same steps and the same numbers: Python and Rust give the same bits.
fn golden(tasks: Vec<Drive>) -> u64 {
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
fn golden_hash() {
    let place = drive_place(DriveSettings { max_steps: 40, ..DriveSettings::default() });
    assert_eq!(golden((0..3).map(|_| Drive::new(&place)).collect()), 3_425_119_552_214_407_938);
}
