//! Each flag of each program that takes a value is tried with a wrong one: exit code 2, the flag is named, and nothing is
//! written.

use crate::map_log::standing_log;
use crate::run::names;
use std::process::{Command, Stdio};

/// A program, a short run of it, and a wrong value of each of its flags; with what else it takes to be refused.
struct Program {
    name: &'static str,
    arguments: &'static str,
    wrong: &'static [(&'static str, &'static str)],
}

const PROGRAMS: [Program; 8] = [
    Program {
        name: "four_rooms",
        arguments: "--quiet",
        wrong: &[
            ("--world", "nowhere"),
            ("--map", "gone.yaml"),
            ("--seed", "-1"),
            ("--duration", "0"),
            ("--drive", "train"),
            ("--tour", "gone.toml"),
            ("--strategy", "clever"),
            ("--patrol", "0"),
            ("--battery", "59s"),
            ("--speed", "0"),
            ("--pose", "guessed"),
            ("--estimator", "guess"),
            ("--occupancy", "loose"),
            ("--out", "a.log"),
            ("--rrd", "folder"),
            ("--state", "folder"),
            ("--state-every", "0"),
            ("--gif", "run.png"),
            ("--connect", "viewer:here"),
            ("--mcap", "folder"),
        ],
    },
    Program { name: "grid_world", arguments: "--quiet", wrong: &GRID_WORLD },
    Program { name: "grid_world", arguments: "merge folder", wrong: &[("--out", "a.log")] },
    Program { name: "house_trials", arguments: "--quiet", wrong: &HOUSE_TRIALS },
    Program { name: "house_trials", arguments: "merge folder", wrong: &[("--out", "a.log")] },
    Program {
        name: "map_log",
        arguments: "a.log --quiet",
        wrong: &[
            ("--scan-topic", "/scan"),
            ("--odom-topic", "/odom"),
            ("--base-frame", "base_link"),
            ("--map-frame", "map"),
            ("--pose", "guessed"),
            ("--resolution", "0"),
            ("--map-memory", "0"),
            ("--max-range", "nan"),
            ("--no-return", "perhaps"),
            ("--noise", "10"),
            ("--shadow-angle", "90"),
            ("--estimator", "guess"),
            ("--time-zone", "Mars/Olympus"),
            ("--out", "a.log"),
            ("--mcap", "folder"),
            ("--state", "folder"),
            ("--places", "folder"),
            ("--state-every", "0"),
        ],
    },
    Program {
        name: "predict",
        arguments: concat!(env!("CARGO_MANIFEST_DIR"), "/tests/states/map_log.state"),
        wrong: &[
            ("--at", "teatime"),
            ("--place", "here"),
            ("--door", "front"),
            ("--route", "folder"),
            ("--graph", "folder"),
            ("--from", "there"),
            ("--speed", "0"),
            ("--radius", "wide"),
            ("--out", "a.log"),
        ],
    },
    Program { name: "check_world", arguments: "four_rooms --png", wrong: &[("--out", "a.log")] },
];

const GRID_WORLD: [(&str, &str); 14] = [
    ("--world", "nowhere"),
    ("--calendar", "moon"),
    ("--sensor-radius", "-1"),
    ("--stochastic", "2"),
    ("--generate", "0"),
    ("--strategy", "clever"),
    ("--estimator", "guess"),
    ("--trials", "0"),
    ("--steps", "0"),
    ("--max-steps", "-1"),
    ("--seed", "-1"),
    ("--out", "a.log"),
    ("--threads", "0"),
    ("--shard", "3/2"),
];

const HOUSE_TRIALS: [(&str, &str); 14] = [
    ("--world", "nowhere"),
    ("--generate", "0"),
    ("--calendar", "moon"),
    ("--kind", "palace"),
    ("--strategy", "clever"),
    ("--estimator", "guess"),
    ("--trials", "0"),
    ("--duration", "0"),
    ("--max-steps", "-1"),
    ("--pose", "guessed"),
    ("--seed", "-1"),
    ("--out", "a.log"),
    ("--threads", "0"),
    ("--shard", "3/2"),
];

/// The flags with a value in the help of a program, which clap makes of its definitions.
fn flags(program: &Program) -> Vec<String> {
    let subcommand = program.arguments.split(' ').next().filter(|word| *word == "merge");
    let help =
        Command::new(crate::run::program(program.name)).args(subcommand).arg("--help").output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let definitions = help.lines().filter_map(|line| {
        line[line.len().min(6)..].split_once(' ').filter(|_| {
            let at = line.len() - line.trim_start().len();
            (2..=6).contains(&at) && line[at..].starts_with('-')
        })
    });
    let with_value =
        definitions.filter(|(flag, value)| flag.starts_with("--") && value.starts_with(['<', '[']));
    with_value.map(|(flag, _)| flag.to_owned()).collect()
}

#[test]
fn every_flag_refuses_a_wrong_value_by_its_name() {
    for program in &PROGRAMS {
        let mut known: Vec<&str> = program.wrong.iter().map(|(flag, _)| *flag).collect();
        let mut found = flags(program);
        known.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, known, "{}: each flag needs a wrong value here", program.name);
        for (flag, value) in program.wrong {
            let folder = tempfile::tempdir().unwrap();
            std::fs::create_dir(folder.path().join("folder")).unwrap();
            std::fs::write(folder.path().join("a.log"), standing_log(1.7e9, 40)).unwrap();
            let mut command = Command::new(crate::run::program(program.name));
            command.current_dir(folder.path()).args(program.arguments.split(' ')).args([flag, value]);
            match *flag {
                "--state-every" => drop(command.args(["--state", "s.state"])),
                "--tour" => drop(command.args(["--drive", "tour"])),
                _ => {}
            }
            let output = command.stdin(Stdio::null()).output().unwrap();
            let message = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{} {flag} {value}: {message}", program.name);
            assert!(message.contains(flag), "{} {flag} {value}: {message}", program.name);
            assert_eq!(names(folder.path()), ["a.log", "folder"], "{} {flag} {value}", program.name);
            assert_eq!(names(&folder.path().join("folder")), [""; 0], "{} {flag} {value}", program.name);
        }
    }
}
