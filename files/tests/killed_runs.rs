//! Runs that are killed while results are exchanged.

use files::RunFolder;
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

const FIRST: [&str; 3] = ["map.pgm", "house.rrd", "summary.json"];
const SECOND: [&str; 4] = ["a.png", "map.pgm", "office.rrd", "report.json"];

/// The results of the run with this number, with their texts.
fn results(number: u32) -> BTreeMap<String, String> {
    let names: &[&str] = if number.is_multiple_of(2) { &FIRST } else { &SECOND };
    names.iter().map(|name| ((*name).to_owned(), format!("{name} {number}"))).collect()
}

/// The folder of [`exchanges_until_it_is_killed`].
const KILLED: &str = "CURIOUS_KILLED_FOLDER";

#[test]
#[ignore = "a process that `killed_runs_lose_nothing` starts"]
fn exchanges_until_it_is_killed() {
    let Ok(path) = std::env::var(KILLED) else { return };
    for number in std::env::var("FIRST").unwrap().parse::<u32>().unwrap().. {
        let folder = RunFolder::open(Path::new(&path)).unwrap();
        for (name, text) in results(number) {
            let file = folder.unfinished().join(name);
            files::write_file(&file, |file| file.write_all(text.as_bytes())).unwrap();
        }
        folder.finish(&[]).unwrap();
        println!("finished {number}");
    }
}

/// `KILLS=200 cargo test -p curious-files killed_runs` kills more often.
#[test]
fn killed_runs_lose_nothing() {
    let kills: u64 = std::env::var("KILLS").map_or(20, |count| count.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("notes.txt"), "of the user").unwrap();
    let mut last = 0;
    for kill in 0..kills {
        let test = "exchanges_until_it_is_killed";
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", test, "--ignored", "--nocapture"]);
        command.env(KILLED, path).env("FIRST", (last + 1).to_string()).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        // At least one exchange; then anywhere in one.
        let is_end = |line: &String| line.ends_with(&format!("finished {}", last + 1));
        assert!(lines.by_ref().any(|line| is_end(&line)));
        thread::sleep(Duration::from_micros(kill * 7919 % 20_000));
        child.kill().unwrap();
        child.wait().unwrap();
        let ended =
            lines.filter_map(|line| line.rsplit_once("finished ")?.1.parse().ok()).last().unwrap_or(last + 1);
        drop(RunFolder::open(path).unwrap());
        drop(fs::remove_dir_all(path.join("unfinished_run_1"))); // as the note says
        let files =
            fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
        let named = |file: &Path| file.file_name().unwrap().to_str().unwrap().to_owned();
        let mut found: BTreeMap<_, _> =
            files.map(|file| (named(&file), fs::read_to_string(&file).unwrap())).collect();
        assert_eq!(found.remove("notes.txt").as_deref(), Some("of the user"));
        assert!(found.contains_key(".curious_run.json"));
        found.retain(|name, _| !name.starts_with('.'));
        let whole = [ended, ended + 1].into_iter().find(|&number| found == results(number));
        last = whole.unwrap_or_else(|| panic!("{kill}: {ended} {found:?}"));
    }
}
