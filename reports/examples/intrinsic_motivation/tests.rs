use crate::cells::{CellSettings, Table, draw};
use crate::distillation::Distillation;
use crate::forward_model::ForwardModel;
use crate::life::Outcome;
use crate::motives::{Motive, Progress, Surprise, Visits, motive};
use crate::rows::Row;
use crate::runs::{Run, Tuned, train};
use crate::study::RowFile;
use crate::tables::rewritten;
use crate::tiles::Tiles;
use crate::view::View;
use evaluation::trials::{Experiment, GridRobot, TrialStrategy};
use interfaces::{Cell, GridFrame, Purpose, RandomStream};
use nalgebra::Point2;
use sim::grid::{GenerateSettings, GridSpec};
use std::sync::atomic::AtomicBool;

fn rng(seed: u64) -> RandomStream {
    RandomStream::new(seed, Purpose::GridAgent)
}

fn frame(width: usize, height: usize) -> GridFrame {
    GridFrame::new(Point2::origin(), 1.0, width, height).unwrap()
}

fn view(frame: GridFrame, time: f64, robot: Cell, cells: Vec<(usize, bool)>) -> View {
    View { time, frame, robot, cells, updates: 0, true_error: None }
}

/// The number of steps until a robot that begins at the left end of a corridor is at its right end.
fn steps_to_the_end(motive: &mut dyn Motive, settings: CellSettings, seed: u64) -> usize {
    const LENGTH: i32 = 20;
    let frame = frame(LENGTH as usize, 1);
    let (mut table, mut x) = (Table::new(LENGTH as usize, settings, rng(seed)), 0);
    for step in 0..100_000 {
        let reward = motive.reward(&view(frame, f64::from(step), Cell::new(x, 0), Vec::new()));
        let action = table.act(reward, x as usize);
        x = (x + [0, 1, 0, -1, 0][action]).clamp(0, LENGTH - 1);
        if x == LENGTH - 1 {
            return step as usize;
        }
    }
    usize::MAX
}

#[test]
fn counts_lead_to_where_the_robot_was_not() {
    let counts = |seed| steps_to_the_end(&mut Visits(vec![0.0; 20]), CellSettings::default(), seed);
    let walk = CellSettings { epsilon: 1.0, replays: 0, ..CellSettings::default() };
    let random = |seed| steps_to_the_end(&mut *motive("", frame(20, 1), &mut rng(0)), walk, seed);
    // A walk that moves to either side with a probability of 1/5 takes 19 · 20 · 5/2 = 950 steps on average.
    let mean = |steps: &dyn Fn(u64) -> usize| (0..40).map(steps).sum::<usize>() as f64 / 40.0;
    let (counts, random) = (mean(&counts), mean(&random));
    assert!((550.0..1450.0).contains(&random), "{random}");
    assert!(counts < random / 3.0, "{counts} steps with counts, {random} at random");
}

#[test]
fn both_of_two_states_are_visited() {
    let frame = frame(2, 1);
    let (mut table, mut motive) = (Table::new(2, CellSettings::default(), rng(1)), Visits(vec![0.0; 2]));
    let (mut x, mut right) = (0, 0);
    for step in 0..2000 {
        let reward = motive.reward(&view(frame, f64::from(step), Cell::new(x, 0), Vec::new()));
        x = (x + [0, 1, 0, -1, 0][table.act(reward, x as usize)]).clamp(0, 1);
        right += x;
    }
    assert!((600..=1400).contains(&right), "{right} of 2000 on the right");
}

#[test]
fn distillation_forgets_nothing_that_it_sees_often() {
    let frame = frame(30, 30);
    let mut novelty = Distillation::new(&mut rng(2));
    let often = view(frame, 0.0, Cell::new(8, 8), vec![(8 * 30 + 8, false), (8 * 30 + 9, true)]);
    let other = view(frame, 0.0, Cell::new(24, 20), vec![(20 * 30 + 24, false), (21 * 30 + 24, true)]);
    let first = novelty.reward(&often);
    let last = (0..300).map(|_| novelty.reward(&often)).last().unwrap();
    let novel = novelty.reward(&other);
    assert!(last < 0.01 * first, "{first} at first, {last} at last");
    assert!(novel > 20.0 * last, "{novel} elsewhere, {last} where it was");
}

/// The mean reward of a motive over the last half of 400 readings of a region, in which each cell is blocked as `is_blocked` says.
fn paid(motive: &mut dyn Motive, mut is_blocked: impl FnMut(i32) -> bool, readings: i32) -> f64 {
    let frame = frame(5, 5);
    let mut late = 0.0;
    for step in 0..readings {
        let cells = (0..25).map(|cell| (cell, is_blocked(step))).collect();
        let reward = motive.reward(&view(frame, f64::from(step), Cell::new(0, 0), cells));
        late += if step >= readings / 4 { reward } else { 0.0 };
    }
    late / f64::from(readings - readings / 4)
}

#[test]
fn progress_prefers_what_can_be_learned_to_noise_and_surprise_does_not() {
    let mut noise = rng(3);
    let mut blocked = move |_| noise.bernoulli(0.5);
    // Blocked every other step: the chain learns it within a few dozen steps.
    let regular = |step: i32| step % 2 == 0;
    let readings = 60;
    let progress =
        |is_blocked: &mut dyn FnMut(i32) -> bool| paid(&mut Progress::new(frame(5, 5)), is_blocked, readings);
    let surprise = |is_blocked: &mut dyn FnMut(i32) -> bool| {
        paid(&mut Surprise(ForwardModel::new(25)), is_blocked, readings)
    };
    let mut step_by_step = regular;
    let (learned, noisy) = (progress(&mut step_by_step), progress(&mut blocked));
    assert!(learned > 2.0 * noisy, "progress: {learned} where it can learn, {noisy} of noise");
    let (learned, noisy) = (surprise(&mut step_by_step), surprise(&mut blocked));
    assert!(noisy > 5.0 * learned, "surprise: {learned} where it can learn, {noisy} of noise");
}

#[test]
fn what_is_known_pays_no_progress() {
    let mut motive = Progress::new(frame(5, 5));
    paid(&mut motive, |_| false, 500);
    let late = motive.reward(&view(
        frame(5, 5),
        500.0,
        Cell::new(0, 0),
        (0..25).map(|cell| (cell, false)).collect(),
    ));
    assert!(late < 0.001, "{late}");
}

#[test]
fn the_forward_model_predicts_through_gaps_as_its_chain() {
    let mut model = ForwardModel::new(1);
    let mut random = rng(4);
    let (mut is_blocked, [block, free]) = (false, [0.1, 0.3]);
    let steps = 20_000;
    for step in 0..=steps {
        model.learn(0, is_blocked, f64::from(step));
        let changes = random.bernoulli(if is_blocked { free } else { block });
        is_blocked ^= changes;
    }
    // The powers of the matrix, from the last state on.
    let last = model.predicted(0, f64::from(steps));
    assert!(last == 0.0 || last == 1.0);
    let mut expected = last;
    for ahead in 1..6 {
        expected = expected * (1.0 - free) + (1.0 - expected) * block;
        let predicted = model.predicted(0, f64::from(steps + ahead));
        assert!((predicted - expected).abs() < 0.02, "{ahead} steps: {predicted}, {expected}");
    }
    assert!((model.predicted(0, 1e6) - 0.25).abs() < 0.02);
}

#[test]
fn tiles_learn_a_function_of_two_features() {
    let (mut tiles, mut random) = (Tiles::new(2, 0.0), rng(5));
    let wanted = |features: &[f64; 6], action: usize| features[0] * features[3] + action as f64;
    let mut point = || ([0; 6].map(|_| random.uniform(0.0..1.0)), draw(&mut random, 2));
    for _ in 0..40_000 {
        let (features, action) = point();
        tiles.learn(&Tiles::active(&features, action), wanted(&features, action), 0.2);
    }
    let error =
        |(features, action)| tiles.value(&Tiles::active(&features, action)) - wanted(&features, action);
    let mean = (0..1000).map(|_| error(point()).abs()).sum::<f64>() / 1000.0;
    assert!(mean < 0.05, "{mean}");
}

fn some_run(learner: &str, seed: u64) -> Run {
    let (learner, estimator) = (learner.to_owned(), "two-state-gaps".to_owned());
    Run { learner, experience: 0, estimator, steps: 1000, seed }
}

#[test]
fn a_life_of_a_strategy_is_a_trial() {
    let strategy = TrialStrategy::all().find(|strategy| strategy.name() == "curious").unwrap();
    let experiment = Experiment {
        worlds: vec![GridSpec::generate(&GenerateSettings::default(), 7)],
        estimators: vec!["two-state-gaps".parse().unwrap()],
        strategies: vec![strategy],
        trials: 1,
        seed: 7,
        length: 1000,
        robot: GridRobot::default(),
    };
    let trial = experiment.run(experiment.jobs(), &AtomicBool::new(false), |_| ()).unwrap().remove(0);
    let last = trial.samples.last().unwrap();
    let outcome = some_run("curious", 7).outcome(Tuned::default(), None).unwrap();
    assert_eq!((last.time, last.log_error, last.map_quality), (1000, outcome.errors[0], outcome.map_quality));
}

#[test]
fn lives_repeat_and_differ_by_motive() {
    let outcome = |learner: &str| some_run(learner, 7).outcome(Tuned::default(), None).unwrap();
    let mut errors = Vec::new();
    for learner in ["walk", "cells-visits", "cells-progress", "goals-visits", "goals-distillation"] {
        let once = outcome(learner);
        assert_eq!(once.errors[0].to_bits(), outcome(learner).errors[0].to_bits(), "{learner}");
        errors.push(once.errors[0].to_bits());
    }
    errors.sort_unstable();
    errors.dedup();
    assert!(errors.len() > 1);
}

#[test]
fn training_goes_on_where_it_was() {
    let settings = Tuned::default().goals;
    let both = train("views", 0, &[600, 1200], "two-state-gaps", settings).unwrap();
    let one = train("views", 0, &[600], "two-state-gaps", settings).unwrap();
    let other = train("views", 1, &[600], "two-state-gaps", settings).unwrap();
    assert_eq!(both.iter().map(|(steps, _)| *steps).collect::<Vec<_>>(), [600, 1200]);
    assert_eq!(both[0].1.tiles, one[0].1.tiles);
    assert_ne!(both[0].1.tiles, both[1].1.tiles);
    assert_ne!(one[0].1.tiles, other[0].1.tiles);
}

#[test]
fn a_table_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.csv");
    let run = some_run("cells-visits", 3);
    let outcome = run.outcome(Tuned::default(), None).unwrap();
    RowFile::open(&path).unwrap().append(&Row { run: run.clone(), outcome }).unwrap();
    let rows = RowFile::<Row>::read(&path).unwrap();
    assert_eq!((rows.len(), &rows[0].run), (1, &run));
    assert!((rows[0].outcome.errors[0] - outcome.errors[0]).abs() < 1e-6);
    assert!(rows[0].outcome.areas[0].is_nan());
}

#[test]
fn tables_are_made_of_rows() {
    let row = |learner: &str, experience: u64, steps: u64, seed: u64, area: f64| {
        let run = Run { experience, steps, ..some_run(learner, seed) };
        let late = if steps > 20_000 { area / 4.0 } else { f64::NAN };
        let errors = [area, area, area, area, area / 2.0, late, f64::NAN];
        let outcome =
            Outcome { areas: [2.0 * area, area], errors, map_quality: 0.99, changing: 0.5, brier: 0.1 };
        Row { run, outcome }
    };
    let rows = vec![
        row("goals-visits", 10_000, 20_000, 1, 0.5),
        row("walk", 0, 20_000, 0, 0.9),
        row("curious", 0, 20_000, 0, 1.0),
        row("curious", 0, 20_000, 1, 2.0),
        // A longer life of the same takes the place of the shorter one.
        row("curious", 0, 50_000, 1, 2.0),
    ];
    let page = "a\n<!-- intrinsic_motivation areas two-state-gaps --><!-- end -->\n<!-- intrinsic_motivation times two-state-gaps --><!-- end -->\n";
    let made = rewritten(page, rows.clone()).unwrap();
    for line in [
        "| `curious` |  | 2 | 3.000 | 1.500 |  |  | 0.990 | 0.500 | 0.100 |",
        "| `walk` |  | 1 | 1.800 | 0.900 | 0.900 |",
        "| `goals-visits` | 10,000 | 1 | 1.000 | 0.500 | 0.250 |",
        "| `curious` | 1.500 | 1.500 | 1.500 | 1.500 | 0.750 | 0.500 |  |",
        "| `walk` | 0.900 | 0.900 | 0.900 | 0.900 | 0.450 |  |  |",
    ] {
        assert!(made.contains(line), "{line}\n{made}");
    }
    for which in ["areas paper", "speed two-state-gaps", "areas"] {
        let page = format!("<!-- intrinsic_motivation {which} --><!-- end -->");
        assert!(rewritten(&page, rows.clone()).is_err(), "{which}");
    }
}

/// A page with tables that were not made from the rows of the study is stale.
#[test]
fn the_page_has_what_the_file_says() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let rows = RowFile::read(&root.join("docs/results/intrinsic_motivation.csv")).unwrap();
    let page = std::fs::read_to_string(root.join("docs/strategies.md")).unwrap();
    assert_eq!(page.matches("<!-- intrinsic_motivation ").count(), 2);
    assert!(
        rewritten(&page, rows).unwrap() == page,
        "cargo run -p curious-reports --example intrinsic_motivation -- --merge docs/results/intrinsic_motivation.csv --page docs/strategies.md"
    );
}
