//! A person at the keyboard, in a terminal that `script` makes up.
#![cfg(target_os = "linux")]

use crate::run::{Ended, Run};
use std::io::Write;
use std::process::{ChildStdin, Command, Stdio};
use std::time::Duration;

/// Runs the program in a terminal of its own while `person` presses keys.
fn drive(run: &Run, arguments: &str, person: impl FnOnce(&mut ChildStdin)) -> Option<Ended> {
    let program = env!("CARGO_BIN_EXE_four_rooms");
    let line = format!("'{program}' --drive keyboard --no-rrd --out out {arguments}");
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
    let mut keys = child.stdin.take().unwrap();
    person(&mut keys);
    let ended = child.wait_with_output().unwrap().into();
    drop(keys); // not before: a terminal that is hung up ends the program
    Some(ended)
}

fn press(keys: &mut ChildStdin, key: &str, times: usize) {
    for _ in 0..times {
        keys.write_all(key.as_bytes()).unwrap();
        keys.flush().unwrap();
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn keys_drive_and_q_ends() {
    let run = Run::new();
    let ended = drive(&run, "--speed 4", |keys| {
        press(keys, "w", 20);
        press(keys, "q", 1);
    });
    let Some(ended) = ended else { return };
    assert_eq!(ended.code, Some(0), "{ended:?}");
    assert!(ended.stdout.contains("Q ends the run"), "{ended:?}");
    assert!(ended.stdout.contains("keyboard in four rooms"), "{ended:?}");
    let summary = run.summary();
    assert_eq!((summary.text("/drive"), summary.text("/ended_by")), ("keyboard", "person"));
    // From (2, 2) to the right, as long as the key is pressed: it has seen the cells that its own
    // start hid, or stood before a wall.
    assert!(summary.number("/coverage") > 0.3);
    assert_ne!(summary.hash(), stands(summary.number("/simulated_s")), "it did not move");
}

/// The hash of a robot that stands for as long.
fn stands(simulated_s: f64) -> String {
    let run = Run::new();
    run.write("stay.toml", "waypoints_m = [[2.0, 2.0]]\nrepeat = true\n");
    run.goes_well(&format!("-q --no-rrd --drive tour --tour stay.toml --duration {simulated_s}"));
    run.summary().hash().to_owned()
}

#[test]
fn without_a_key_it_stands_and_ctrl_c_is_a_key() {
    let run = Run::new();
    let ended = drive(&run, "--speed 4 --quiet", |keys| {
        std::thread::sleep(Duration::from_secs(1));
        press(keys, "\u{3}", 1);
    });
    let Some(ended) = ended else { return };
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(0), ""), "{ended:?}");
    let summary = run.summary();
    assert_eq!(summary.text("/ended_by"), "person");
    assert_eq!(summary.hash(), stands(summary.number("/simulated_s")), "it moved by itself");
}
