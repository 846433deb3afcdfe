//! The tasks as a learner uses them.

use environments::{
    Batch, Drive, DrivePlace, DriveSettings, Explore, ExplorePlace, ExploreSettings, Results, Task,
    TaskError, driving_hall,
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
    let settings = ExploreSettings { max_steps: 25, beams: Some(60), ..ExploreSettings::default() };
    let place = explore_place(settings);
    let tasks = |count| (0..count).map(|_| Explore::new(&place).unwrap()).collect::<Vec<_>>();
    let together = run(tasks(4), 0, 1, 60);
    assert_eq!(run(tasks(4), 0, 2, 60), together);
    assert_eq!(run(tasks(1), 2, 1, 60)[0], together[2]);
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
        assert_eq!((there.snapshot(0), there.seed(0)), (snapshot.clone(), here.seed(0)));
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
    let place = explore_place(ExploreSettings { beams: Some(60), ..ExploreSettings::default() });
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
fn exploring_earns_found_changes_and_the_area_that_becomes_known() {
    let settings = ExploreSettings { max_steps: 600, collision_reward: 0.0, ..ExploreSettings::default() };
    let place = explore_place(settings.clone());
    let mut batch = Batch::new(vec![Explore::new(&place).unwrap()]);
    batch.is_autoreset = false;
    batch.reset(&[4]).unwrap();
    let mut first = [0.0; 7];
    batch.task(0).info(&mut first);
    let (mut sum, mut results) = (0.0, Results::default());
    for step in 0..600 {
        let turn = if step % 100 < 60 { 0.0 } else { 0.6 };
        results = batch.step(&[0.5, turn], &[0]).unwrap();
        assert!(results.observations.iter().all(|value| (-1.0..=1.0).contains(value)), "step {step}");
        sum += f64::from(results.rewards[0]);
    }
    assert_eq!((results.terminated[0], results.truncated[0]), (false, true));
    let [house, updates, _, _, found, seen_m2, time_s] = results.info[..] else {
        panic!("{:?}", results.info)
    };
    assert!(updates > 0.0 && (time_s - 60.0).abs() < 1e-4);
    let spec = WorldSpec::generate_house([3, 5][house as usize]);
    let cells_wide = 2.0 * spec.driven().radius_m / spec.frame.resolution_m();
    let area = settings.seen_reward * f64::from(seen_m2 - first[5]);
    let expected = settings.update_reward * f64::from(found) / cells_wide + area;
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
    let error = DrivePlace::new(&nobody, DriveSettings::default()).err().unwrap().to_string();
    assert!(error.starts_with("no robot of the world `driving hall` is driven: give one of them"), "{error}");
    let error = ExplorePlace::new(&[], ExploreSettings::default()).err().unwrap().to_string();
    assert_eq!(error, "exploring needs at least one world");
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
        explore_place(ExploreSettings { max_steps: 40, beams: Some(20), ..ExploreSettings::default() });
    let exploring = golden((0..2).map(|_| Explore::new(&place).unwrap()).collect());
    assert_eq!([driving, exploring], [3_425_119_552_214_407_938, 5_066_755_386_246_569_362]);
}

#[test]
fn an_exploring_task_that_is_over_stands_still() {
    let place =
        explore_place(ExploreSettings { max_steps: 30, beams: Some(60), ..ExploreSettings::default() });
    let mut batch = Batch::new(vec![Explore::new(&place).unwrap()]);
    batch.is_autoreset = false;
    batch.reset(&[4]).unwrap();
    let mut step = || batch.step(&[1.0, 0.3], &[0]).unwrap();
    let last = (0..31).map(|_| step()).find(|results| results.truncated[0]).unwrap();
    let after = step();
    assert_eq!((after.rewards[0], after.terminated[0], after.truncated[0]), (0.0, false, true));
    assert_eq!((after.observations, after.info), (last.observations, last.info));
}

/// In a minute, a robot that stands still earns the area of its first view alone.
#[test]
fn standing_still_earns_next_to_nothing() {
    let settings = ExploreSettings { max_steps: 600, beams: Some(90), ..ExploreSettings::default() };
    let place = Arc::new(ExplorePlace::of_houses((0..8).collect(), settings).unwrap());
    let total = |action: fn(&[f32]) -> [f32; 2]| {
        let mut batch = Batch::new((0..6).map(|_| Explore::new(&place).unwrap()));
        batch.is_autoreset = false;
        let mut observations = batch.reset(&[0, 1, 2, 3, 4, 5]).unwrap();
        let (len, mut sum) = (batch.observation_len(), 0.0);
        for _ in 0..600 {
            let actions: Vec<f32> = observations.chunks(len).flat_map(action).collect();
            let results = batch.step(&actions, &[0; 6]).unwrap();
            sum += f64::from(results.rewards.iter().sum::<f32>());
            observations = results.observations;
        }
        sum
    };
    let standing = total(|_| [0.0, 0.0]);
    // Straight on, and a turn before obstacles.
    let wandering = total(|observation| {
        let near = observation[35..55].iter().copied().fold(1.0_f32, f32::min);
        if near < 0.08 { [0.0, 1.0] } else { [0.8, 0.0] }
    });
    assert!(wandering > 6.0 * 2.0 && standing < 0.5 * wandering, "{standing} and {wandering}");
}
