use super::scan::write_line;
use super::*;
use crate::ReportSettings;
use crate::tests::synthetic::{experiment, uniform};
use evaluation::trials::Trial;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::fs;
use tempfile::TempDir;

/// Twelve short trials.
fn small() -> (ReportSettings, Vec<Trial>) {
    let (settings, mut trials) = experiment(2, &["paper"], &["curious", "recency"], 3);
    for trial in &mut trials {
        trial.samples.truncate(3);
        trial.strategy_share = vec![("recency".into(), 1.0 / 3.0), ("poisson".into(), 0.1 + 0.2)];
    }
    trials[0].samples[0].rate_error = f64::INFINITY;
    trials[1].samples[1].false_rate = -0.0;
    trials[2].samples[2].brier = f64::MIN_POSITIVE;
    trials[2].collisions = Some(2);
    settings.sort(&mut trials);
    (settings, trials)
}

fn header(shard: Shard, trials: &[Trial]) -> Header {
    Header::new(
        "grid_world",
        "0.1.0",
        vec!["--trials".into(), "3".into()],
        &"settings",
        trials.len() as u64,
        shard,
    )
}

fn shard(number: u64, count: u64) -> Shard {
    Shard::new(number, count).unwrap()
}

/// Runs a shard: the trials that are not finished are appended in a wild order.
fn run(folder: &Path, shard: Shard, trials: &[Trial]) -> Result<(), ShardError> {
    let file = ShardFile::open(folder, &header(shard, trials))?;
    let jobs = (1..).zip(trials).filter(|(job, _)| shard.has(*job) && !file.finished.contains(job));
    let mut jobs: Vec<(u64, &Trial)> = jobs.collect();
    jobs.sort_by_key(|(job, _)| job * 7919 % 101);
    jobs.into_iter().try_for_each(|(job, trial)| file.append(job, trial))?;
    Ok(file.sync()?)
}

/// A folder with all shards, the last one first.
fn ran(count: u64, trials: &[Trial]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    (1..=count).rev().for_each(|number| run(folder.path(), shard(number, count), trials).unwrap());
    folder
}

/// As text: what is not a number is not equal to itself.
fn text(trials: &[Trial]) -> String {
    format!("{trials:?}")
}

fn merged(folder: &Path) -> Result<Vec<Trial>, ShardError> {
    Shards::read(folder)?.trials()?.collect()
}

fn message(folder: &Path) -> String {
    merged(folder).unwrap_err().to_string().replace(&folder.display().to_string(), "DIR")
}

#[test]
fn every_bit_of_every_trial_comes_back_in_the_order_of_the_experiment() {
    let (_, trials) = small();
    for count in [1, 3, 5, 64] {
        let folder = ran(count, &trials);
        assert_eq!(text(&merged(folder.path()).unwrap()), text(&trials), "{count} shards");
        assert!(Shards::read(folder.path()).unwrap().missing().is_none());
    }
}

#[test]
fn a_shard_that_was_cut_off_at_any_byte_goes_on() {
    let (_, trials) = small();
    let folder = ran(3, &trials);
    let path = folder.path().join(shard(2, 3).file_name());
    let whole = fs::read(&path).unwrap();
    let mut stream = ChaCha8Rng::seed_from_u64(1);
    let cuts = (0..150).map(|_| (uniform(&mut stream) * whole.len() as f64) as usize);
    for cut in cuts.chain([0, 1, whole.len() - 1]) {
        fs::write(&path, &whole[..cut]).unwrap();
        assert_eq!(Shards::read(folder.path()).unwrap().missing().as_deref(), Some("2"), "cut at {cut}");
        run(folder.path(), shard(2, 3), &trials).unwrap();
        assert_eq!(text(&merged(folder.path()).unwrap()), text(&trials), "cut at {cut}");
    }
}

#[test]
fn missing_shards_are_listed() {
    let (_, trials) = small();
    let folder = ran(6, &trials);
    for number in [2, 4, 5] {
        fs::remove_file(folder.path().join(shard(number, 6).file_name())).unwrap();
    }
    // The header without a trial.
    drop(ShardFile::open(folder.path(), &header(shard(5, 6), &trials)).unwrap());
    let shards = Shards::read(folder.path()).unwrap();
    assert_eq!(shards.missing().as_deref(), Some("2,4-5"));
    let expected = "shard 2/6                0 of 2 trials\nshard 4/6                0 of 2 trials\n\
                    shard 5/6                0 of 2 trials\n6 of 12 trials (50.0 %), 3 of 6 shards complete";
    assert_eq!(shards.status(), expected);
    let finished = shards.shards().map(|(_, scan)| scan.map(Scan::finished)).collect::<Vec<_>>();
    assert_eq!(finished, [Some(2), None, Some(2), None, Some(0), Some(2)]);
}

#[test]
fn what_does_not_belong_together_is_refused_with_the_name_of_the_file() {
    let (_, trials) = small();
    let changed = |change: &dyn Fn(&Path)| {
        let folder = ran(3, &trials);
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
    insta::assert_snapshot!(edit(&|text| text.replacen("0.99", "0.98", 1)), @"DIR/shard-1-of-3.jsonl: line 2 is not as it was written: it was edited, or is of another experiment; remove the file, and run its shard again");
    insta::assert_snapshot!(edit(&|text| text.replacen("0.1.0", "0.1.1", 1)), @"DIR/shard-1-of-3.jsonl: the first line is not the header of a shard: it was edited, or this is another file");
    insta::assert_snapshot!(edit(&|text| format!("{text}{}\n", text.lines().last().unwrap())), @"DIR/shard-1-of-3.jsonl: line 6 is trial 7, which is in this file before; remove the file, and run its shard again");
    insta::assert_snapshot!(edit(&|text| format!("{text}\n")), @"DIR/shard-1-of-3.jsonl: line 6 is not as it was written: it was edited, or is of another experiment; remove the file, and run its shard again");
    insta::assert_snapshot!(changed(&|folder| {
        let [one, other] = [&first, &second].map(|name| fs::read_to_string(folder.join(name)).unwrap());
        fs::write(folder.join(&first), format!("{one}{}\n", other.lines().last().unwrap())).unwrap();
    }), @"DIR/shard-1-of-3.jsonl: line 6 is trial 2, which does not belong to this shard; remove the file, and run its shard again");
    insta::assert_snapshot!(changed(&|folder| {
        fs::copy(folder.join(&first), folder.join(&second)).unwrap();
    }), @"DIR/shard-2-of-3.jsonl: this is the file of another shard under a new name; give it its name again");
    insta::assert_snapshot!(changed(&|folder| fs::write(folder.join(&second), "notes\n").unwrap()), @"DIR/shard-2-of-3.jsonl: the first line is not the header of a shard: it was edited, or this is another file");
    insta::assert_snapshot!(changed(&|folder| {
        let other = ran(4, &trials);
        fs::copy(other.path().join("shard-1-of-4.jsonl"), folder.join("shard-1-of-4.jsonl")).unwrap();
    }), @"DIR/shard-1-of-4.jsonl: this shard is one of 4 shards, not of 3 as DIR/shard-1-of-3.jsonl");
    insta::assert_snapshot!(changed(&|folder| fs::remove_file(folder.join(&second)).unwrap()), @"cannot read DIR/shard-2-of-3.jsonl: No such file or directory (os error 2)");
    insta::assert_snapshot!(message(tempfile::tempdir().unwrap().path()), @"DIR: this folder has no shard with a finished line");
}

#[test]
fn a_shard_of_another_experiment_is_refused_before_anything_is_written() {
    let (_, trials) = small();
    let folder = ran(3, &trials);
    let own = header(shard(1, 3), &trials);
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
    assert_eq!(file("shard-1-of-3.jsonl"), before);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    // What is no shard is not replaced either.
    fs::write(folder.path().join("shard-2-of-3.jsonl"), "notes").unwrap();
    refused(&Header { shard: shard(2, 3), ..own });
    assert_eq!(file("shard-2-of-3.jsonl"), b"notes");
}

#[test]
fn shards_of_another_build_are_refused() {
    let (_, trials) = small();
    let folder = ran(3, &trials);
    let path = folder.path().join("shard-2-of-3.jsonl");
    let own = fs::read_to_string(&path).unwrap();
    let other = Header { build: "0123".into(), ..header(shard(2, 3), &trials) };
    let other = write_line(&other, 0).unwrap();
    fs::write(&path, other + own.split_once('\n').unwrap().1).unwrap();
    let expected = "DIR/shard-2-of-3.jsonl: this shard is of build 0123, not ";
    assert!(message(folder.path()).starts_with(expected), "{}", message(folder.path()));
    let error = ShardFile::open(folder.path(), &header(shard(1, 3), &trials)).unwrap_err();
    assert!(error.to_string().contains("this shard is of build 0123, not "), "{error}");
}

#[test]
fn two_processes_on_one_shard_are_one_too_many() {
    let (_, trials) = small();
    let folder = tempfile::tempdir().unwrap();
    let header = header(shard(1, 3), &trials);
    let first = ShardFile::open(folder.path(), &header).unwrap();
    let error = ShardFile::open(folder.path(), &header).unwrap_err().to_string();
    assert!(error.ends_with("another run is writing there; wait for it, or start another shard"), "{error}");
    drop(first);
    ShardFile::open(folder.path(), &header).unwrap();
}
