//! The programs start; `tests/it` runs them as a user does. With a test of this package, `cargo test` builds its programs.

use std::process::Command;

#[test]
fn every_program_explains_itself() {
    for program in
        [env!("CARGO_BIN_EXE_map_log"), env!("CARGO_BIN_EXE_predict"), env!("CARGO_BIN_EXE_state_file")]
    {
        let output = Command::new(program).arg("--help").output().unwrap();
        assert!(output.status.success() && output.stdout.len() > 200, "{program}");
    }
}
