//! Arguments that are no text, as a user gives them.
#![cfg(unix)]

use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt;
use std::process::Command;

#[test]
fn an_argument_that_is_no_text_is_one_error_with_exit_code_2() {
    let bytes = || OsString::from_vec(b"\xff".to_vec());
    for program in [env!("CARGO_BIN_EXE_curious_node"), env!("CARGO_BIN_EXE_sim_node")] {
        for before in [vec!["--mode", "map"], vec!["--ros-args"], vec!["--ros-args", "-p"]] {
            let ended = Command::new(program).args(&before).arg(bytes()).output().unwrap();
            let text = String::from_utf8(ended.stderr).unwrap();
            assert!(ended.status.code() == Some(2), "{program} {before:?}: {text}");
            assert!(text.starts_with("error: ") && text.matches("error").count() == 1, "{text}");
        }
    }
}
