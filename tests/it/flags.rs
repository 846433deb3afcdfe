//! Each flag of each program that takes a value is tried with a wrong one: exit code 2, the flag is named, and nothing is
//! written.

use crate::map_log::standing_log;
use crate::run::{Run, names};

/// A program, a short run of it, and a wrong value of each of its flags.
type Program = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

const PROGRAMS: [Program; 8] = [
    (
        "four_rooms",
        "--quiet",
        &[
            ("--world", "nowhere"),
            ("--map", "gone.yaml"),
            ("--seed", "-1"),
            ("--duration", "0"),
            ("--drive", "train"),
            ("--tour", "gone.toml"),
            ("--strategy", "clever"),
            ("--patrol", "0"),
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
    ),
    ("grid_world", "--quiet", &GRID_WORLD),
    ("grid_world", "merge folder", &[("--out", "a.log")]),
    ("house_trials", "--quiet", &HOUSE_TRIALS),
    ("house_trials", "merge folder", &[("--out", "a.log")]),
    (
        "map_log",
        "a.log --quiet",
        &[
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
    ),
    (
        "predict",
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/states/map_log.state"),
        &[
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
    ),
    ("check_world", "four_rooms --png", &[("--out", "a.log")]),
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
fn flags(run: &Run, arguments: &str) -> Vec<String> {
    let subcommand = if arguments.starts_with("merge ") { "merge " } else { "" };
    let help = run.goes_well(&format!("{subcommand}--help")).stdout;
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
    for (name, arguments, wrong) in PROGRAMS {
        let run = Run::of(name);
        std::fs::create_dir(run.path("folder")).unwrap();
        run.write("a.log", &standing_log(1.7e9, 40));
        let mut known: Vec<&str> = wrong.iter().map(|(flag, _)| *flag).collect();
        let mut found = flags(&run, arguments);
        known.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, known, "{name}: each flag needs a wrong value here");
        for (flag, value) in wrong {
            let also = match *flag {
                "--state-every" => "--state s.state",
                "--tour" => "--drive tour",
                _ => "",
            };
            let message = run.refuses(&format!("{arguments} {flag} {value} {also}"));
            assert!(message.contains(flag), "{name} {flag} {value}: {message}");
            assert_eq!(names(&run.path("folder")), [""; 0], "{name} {flag} {value}");
        }
    }
}
