//! A user who drives with the keyboard.
#![cfg(target_os = "linux")]

use crate::run::{Run, wait_until};
use crate::terminal::{self, wait};

const DRIVE: &str = "--drive keyboard --no-rrd --speed 4";

#[test]
fn keys_drive_and_q_ends() {
    let run = Run::new();
    let ended = terminal::run(&run, DRIVE, |keys| {
        starts(&run);
        (0..20).for_each(|_| keys.press("w"));
        keys.press("q");
    });
    assert_eq!(ended.code, Some(0), "{ended:?}");
    ended.prints(&["Q ends the run", "keyboard in four rooms, ended by the user: "]);
    let summary = run.summary();
    assert_eq!((summary.text("/drive"), summary.text("/ended_by")), ("keyboard", "person"));
    assert_ne!(summary.hash(), stands(summary.number("/simulated_s")), "it did not move");
}

#[test]
fn without_a_key_it_stands_and_ctrl_c_is_a_key() {
    let run = Run::new();
    let ended = terminal::run(&run, &format!("{DRIVE} --quiet"), |keys| {
        starts(&run);
        wait(1000);
        keys.press("\u{3}");
    });
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(0), ""), "{ended:?}");
    let summary = run.summary();
    assert_eq!(summary.text("/ended_by"), "person");
    assert_eq!(summary.hash(), stands(summary.number("/simulated_s")), "it moved by itself");
}

/// Waits until the program reads the keys: it creates its folder next.
fn starts(run: &Run) {
    wait_until(|| run.path("out").exists());
}

/// The hash of a robot that stands still for the same time.
fn stands(simulated_s: f64) -> String {
    let run = Run::new();
    run.write("stay.toml", "waypoints_m = [[2.0, 2.0]]\nrepeat = true\n");
    run.goes_well(&format!("-q --no-rrd --drive tour --tour stay.toml --duration {simulated_s}"));
    run.summary().hash().to_owned()
}
