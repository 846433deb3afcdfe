//! Runs the program in a terminal that `script` of util-linux makes up.
#![cfg(target_os = "linux")]

use crate::run::{Ended, Run};
use std::io::Write;
use std::process::{ChildStdin, Command, Stdio};
use std::time::Duration;

/// Runs the program while `person` presses keys; standard error comes on standard output. `None`
/// without `script`.
pub(crate) fn run(run: &Run, arguments: &str, person: impl FnOnce(&mut Keys)) -> Option<Ended> {
    let line = format!("'{}' --out out {arguments}", run.program());
    let mut script = Command::new("script");
    script.args(["-qec", &line, "/dev/null"]).current_dir(run.path(""));
    script.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = match script.spawn() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: there is no `script` here");
            return None;
        }
        child => child.unwrap(),
    };
    let mut keys = Keys(child.stdin.take().unwrap());
    person(&mut keys);
    let ended = child.wait_with_output().unwrap().into();
    drop(keys); // not before: a terminal that hangs up ends the program
    Some(ended)
}

/// The keys of the terminal.
pub(crate) struct Keys(ChildStdin);

impl Keys {
    pub(crate) fn press(&mut self, key: &str) {
        self.0.write_all(key.as_bytes()).unwrap();
        self.0.flush().unwrap();
        wait(50);
    }
}

pub(crate) fn wait(milliseconds: u64) {
    std::thread::sleep(Duration::from_millis(milliseconds));
}
