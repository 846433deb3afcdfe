use super::*;
use evaluation::trials::{Experiment, GridRobot, TrialStrategy};
use sim::grid::{GenerateSettings, GridSpec};
use std::fs;
use std::sync::atomic::AtomicBool;
use tempfile::TempDir;

/// Twelve short trials.
fn experiment() -> Experiment<GridSpec> {
    let strategy = |name: &str| TrialStrategy::all().find(|strategy| strategy.name() == name).unwrap();
    Experiment {
        worlds: (0..2).map(|seed| GridSpec::generate(&GenerateSettings::default(), seed)).collect(),
        estimators: vec!["paper".parse().unwrap()],
        strategies: ["curious", "recency"].map(strategy).into(),
        trials: 3,
        seed: 7,
        length: 20,
        robot: GridRobot::default(),
    }
}

fn header(shard: Shard) -> Header {
    Header::new("grid_world", "0.1.0", vec!["--trials".into(), "3".into()], &"settings", 12, shard)
}

fn shard(number: u64, count: u64) -> Shard {
    Shard::new(number, count).unwrap()
}

/// The trials of an experiment that belong to a shard.
fn trials(shard: Shard) -> Vec<Trial> {
    let experiment = experiment();
    let mut jobs = experiment.jobs();
    jobs.retain(|job| shard.has(job.number));
    experiment.run(jobs, &AtomicBool::new(false), |_| ()).unwrap()
}

/// A folder with all shards, the last one first.
fn ran(count: u64) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for shard in (1..=count).rev().map(|number| shard(number, count)) {
        ShardFile::open(folder.path(), &header(shard)).unwrap().unwrap().write(&trials(shard)).unwrap();
    }
    folder
}

/// As text: what is not a number is not equal to itself.
fn sorted(trials: Vec<Trial>) -> Vec<String> {
    let mut texts: Vec<String> = trials.iter().map(|trial| format!("{trial:?}")).collect();
    texts.sort();
    texts
}

fn merged(folder: &Path) -> Result<Vec<Trial>, ShardError> {
    let shards = Shards::read(folder)?;
    shards.check("grid_world", "0.1.0")?;
    shards.trials(&experiment())
}

fn message(folder: &Path) -> String {
    merged(folder).unwrap_err().to_string().replace(&folder.display().to_string(), "DIR")
}

#[test]
fn every_bit_of_every_trial_comes_back() {
    let all = sorted(trials(shard(1, 1)));
    assert_eq!(all.len(), 12);
    for count in [1, 3, 5, 64] {
        assert_eq!(sorted(merged(ran(count).path()).unwrap()), all, "{count} shards");
    }
}

#[test]
fn numbers_that_are_rare_come_back() {
    let own = shard(1, 12);
    let folder = ran(12);
    let mut trials = trials(own);
    trials[0].samples[0].rate_error = f64::INFINITY;
    trials[0].samples[1].false_rate = -0.0;
    trials[0].samples[2].brier = f64::MIN_POSITIVE;
    trials[0].strategy_share = vec![("recency".into(), 1.0 / 3.0), ("poisson".into(), 0.1 + 0.2)];
    trials[0].collisions = Some(2);
    fs::remove_file(folder.path().join(own.file_name())).unwrap();
    ShardFile::open(folder.path(), &header(own)).unwrap().unwrap().write(&trials).unwrap();
    let text = format!("{:?}", trials[0]);
    assert!(sorted(merged(folder.path()).unwrap()).contains(&text));
}

/// An interrupted or killed shard leaves nothing that could be taken for a result.
#[test]
fn a_shard_is_complete_or_missing() {
    let folder = ran(6);
    for number in [2, 4, 5] {
        fs::remove_file(folder.path().join(shard(number, 6).file_name())).unwrap();
    }
    drop(ShardFile::open(folder.path(), &header(shard(5, 6))).unwrap().unwrap());
    fs::write(folder.path().join("shard-4-of-6.unfinished.jsonl"), "{").unwrap();
    insta::assert_snapshot!(message(folder.path()), @"DIR is not complete: run --shard I/6 for I = 2,4-5, whose files are missing");
    assert!(ShardFile::open(folder.path(), &header(shard(1, 6))).unwrap().is_none(), "it is complete");
    for shard in [2, 4, 5].map(|number| shard(number, 6)) {
        ShardFile::open(folder.path(), &header(shard)).unwrap().unwrap().write(&trials(shard)).unwrap();
    }
    assert_eq!(sorted(merged(folder.path()).unwrap()), sorted(trials(shard(1, 1))));
}

#[test]
fn what_does_not_belong_together_is_refused_with_the_name_of_the_file() {
    let changed = |change: &dyn Fn(&Path)| {
        let folder = ran(3);
        change(folder.path());
        message(folder.path())
    };
    let [first, second] = [1, 2].map(|number| shard(number, 3).file_name());
    let edit = |edit: &dyn Fn(&str) -> String| {
        changed(&|folder| {
            let text = fs::read_to_string(folder.join(&first)).unwrap();
            fs::write(folder.join(&first), edit(&text)).unwrap();
        })
    };
    insta::assert_snapshot!(edit(&|text| text.replacen("\"seed\":7", "\"seed\":8", 1)), @"DIR/shard-1-of-3.jsonl: line 2 is not the trial that belongs there; remove the file, and run its shard again");
    insta::assert_snapshot!(edit(&|text| text.replacen("\"trials\":12", "\"trials\":no", 1)), @"DIR/shard-1-of-3.jsonl: the first line is not the header of a shard: it was edited, or this is another file");
    insta::assert_snapshot!(edit(&|text| format!("{text}{}\n", text.lines().last().unwrap())), @"DIR/shard-1-of-3.jsonl: line 6 is not the trial that belongs there; remove the file, and run its shard again");
    insta::assert_snapshot!(edit(&|text| text[..text.len() - 9].to_owned()), @"DIR/shard-1-of-3.jsonl: line 5 is not the trial that belongs there; remove the file, and run its shard again");
    insta::assert_snapshot!(edit(&|text| text.lines().take(4).map(|line| format!("{line}\n")).collect()), @"DIR/shard-1-of-3.jsonl: it has 3 of 4 trials; remove the file, and run its shard again");
    insta::assert_snapshot!(changed(&|folder| {
        fs::copy(folder.join(&first), folder.join(&second)).unwrap();
    }), @"DIR/shard-2-of-3.jsonl: this is the file of another shard under a new name; give it its name again");
    insta::assert_snapshot!(changed(&|folder| fs::write(folder.join(&second), "notes\n").unwrap()), @"DIR/shard-2-of-3.jsonl: the first line is not the header of a shard: it was edited, or this is another file");
    insta::assert_snapshot!(changed(&|folder| {
        fs::copy(ran(4).path().join("shard-1-of-4.jsonl"), folder.join("shard-1-of-4.jsonl")).unwrap();
    }), @"DIR/shard-1-of-4.jsonl: this shard is one of 4 shards, not of 3 as DIR/shard-1-of-3.jsonl");
    insta::assert_snapshot!(changed(&|folder| {
        let text = fs::read_to_string(folder.join(&second)).unwrap();
        fs::write(folder.join(&second), text.replacen("\"build\":\"", "\"build\":\"0", 1)).unwrap();
    }).split_once(", not ").unwrap().0.replace(robot::BUILD, "BUILD"), @"DIR/shard-2-of-3.jsonl: this shard is of build 0BUILD");
    insta::assert_snapshot!(message(tempfile::tempdir().unwrap().path()), @"DIR: this folder has no complete shard");
}

#[test]
fn a_shard_of_another_experiment_is_refused_before_anything_is_written() {
    let folder = ran(3);
    let own = header(shard(1, 3));
    let file = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let before = file("shard-1-of-3.jsonl");
    let refused = |header: &Header| {
        let error = ShardFile::open(folder.path(), header).unwrap_err().to_string();
        error.replace(&folder.path().display().to_string(), "DIR")
    };
    let with = |program: &str, version: &str, trials: &str, settings: &str| {
        let arguments = vec!["--trials".into(), trials.into()];
        refused(&Header::new(program, version, arguments, &settings, 12, shard(1, 3)))
    };
    insta::assert_snapshot!(with("house_trials", "0.1.0", "3", "settings"), @"DIR/shard-1-of-3.jsonl: this shard is of the program grid_world, not house_trials; give another folder by --out");
    insta::assert_snapshot!(with("grid_world", "0.2.0", "3", "settings"), @"DIR/shard-1-of-3.jsonl: this shard is of version 0.1.0, not 0.2.0; give another folder by --out");
    insta::assert_snapshot!(with("grid_world", "0.1.0", "4", "settings"), @"DIR/shard-1-of-3.jsonl: this shard is of the experiment `--trials 3`, not `--trials 4`; give another folder by --out");
    insta::assert_snapshot!(with("grid_world", "0.1.0", "3", "other"), @"DIR/shard-1-of-3.jsonl: this shard is of an experiment with the same arguments, but other worlds or settings; give another folder by --out");
    insta::assert_snapshot!(refused(&Header { shard: shard(2, 4), ..own.clone() }), @"DIR/shard-1-of-3.jsonl: this shard is one of 3 shards, not of 4; give another folder by --out");
    assert!(
        refused(&Header { build: "0123".into(), ..own.clone() }).contains(", not 0123; give another folder")
    );
    assert_eq!(file("shard-1-of-3.jsonl"), before);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4); // with the list of files
    // What is no shard is not replaced either.
    fs::write(folder.path().join("shard-2-of-3.jsonl"), "notes").unwrap();
    refused(&Header { shard: shard(2, 3), ..own });
    assert_eq!(file("shard-2-of-3.jsonl"), b"notes");
}

#[test]
fn two_processes_on_one_shard_are_one_too_many() {
    let folder = tempfile::tempdir().unwrap();
    let first = ShardFile::open(folder.path(), &header(shard(1, 3))).unwrap();
    let error = ShardFile::open(folder.path(), &header(shard(1, 3))).unwrap_err().to_string();
    assert!(error.contains("another run is writing there; wait for it"), "{error}");
    drop(first);
    ShardFile::open(folder.path(), &header(shard(1, 3))).unwrap();
}
