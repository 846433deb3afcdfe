//! The programs start; `tests/it` runs them as a user does. With a test of this package, `cargo test` builds its programs.

use std::process::Command;

#[test]
fn both_programs_explain_themselves() {
    for program in [env!("CARGO_BIN_EXE_grid_world"), env!("CARGO_BIN_EXE_house_trials")] {
        let output = Command::new(program).arg("--help").output().unwrap();
        assert!(output.status.success() && output.stdout.len() > 200, "{program}");
    }
}
