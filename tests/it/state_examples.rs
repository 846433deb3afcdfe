//! Examples of states, `tests/states`, for the tests that only read one. A layout that was changed needs new ones:
//! `cargo test --test it write_the_states -- --ignored`

use crate::map_log::standing_log;
use crate::run::Run;
use robot::state::read_state;
use std::fs;
use std::path::PathBuf;

/// What the examples are of. With the same duration or log again, a run only reads the state and writes it.
const RUNS: [(&str, &str); 2] = [("map_log.state", "a.log"), ("undated.state", "b.log")];

fn example(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/states").join(name)
}

fn run() -> Run {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(1.7e9, 120));
    run.write("b.log", &standing_log(10.0, 60));
    run
}

#[test]
fn the_examples_are_read() {
    for (name, arguments) in RUNS {
        let run = run();
        fs::copy(example(name), run.path(name)).unwrap();
        run.goes_well(&format!("{arguments} --quiet --no-rrd --state {name}"));
        read_state(&run.path(name)).unwrap();
    }
}

#[test]
#[ignore = "writes the examples"]
fn write_the_states() {
    for (name, arguments) in RUNS {
        let run = run();
        run.goes_well(&format!("{arguments} --quiet --no-rrd --state {name}"));
        fs::copy(run.path(name), example(name)).unwrap();
    }
}
