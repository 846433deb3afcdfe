//! The output of the program on standard output and standard error.

use crate::recording::Recording;
use crate::run::Run;
use std::net::TcpListener;

#[test]
fn quiet_is_silent() {
    let ended = Run::new().goes_well("--quiet --no-rrd --duration 30");
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
}

#[test]
fn the_end_is_reported_in_sentences_and_progress_in_plain_lines() {
    let ended = Run::new().goes_well("--no-rrd --duration 120 --speed 100");
    ended.prints(&["agent in four rooms: 2 min simulated in "]);
    for word in ["seen", "map", "rates", "goals", "contacts", "files"] {
        ended.prints(&[&format!("\n  {word}")]);
    }
    let progress: Vec<&str> = ended.stderr.lines().collect();
    assert!(!progress.is_empty());
    for line in progress {
        assert!(line.contains(" of 120 s at ") && line.contains(" x, seen "), "{line:?}");
        assert!(line.ends_with(" s left"), "{line:?}");
        assert!(line.chars().all(|character| !character.is_control()), "{line:?}");
    }
}

/// The map is scored every ten simulated seconds; what is shown is newer.
#[test]
fn progress_is_up_to_date_in_a_slow_run() {
    let ended = Run::new().goes_well("--no-rrd --duration 9 --speed 1.5");
    let seen = |line: &str| line.split_once(" seen ").unwrap().1.to_owned();
    let texts: Vec<String> = ended.stderr.lines().map(seen).collect();
    assert!(texts.len() >= 2 && texts[0] != texts[1], "{texts:?}");
}

#[test]
fn worlds_are_listed() {
    insta::assert_snapshot!(Run::new().goes_well("--list-worlds").stdout, @"
    four_rooms         The paper's four rooms; a dummy robot drives back and forth along a wall of the upper right room.
    toy_on_the_floor   The four rooms; one box appears after 5 minutes, another disappears after 10 minutes.
    turned_house       The four rooms rotated by 10 degrees, with 1 cm of range noise; a box disappears after 5 minutes. A test for false changes.
    house              Six rooms around a hallway, with furniture and six doors that open and close. A vacuum cleaner wanders, a cat walks from room to room.
    drifting_house     The house, for a robot with bad odometry and a laser that takes 0.1 s for a scan. Six rooms around a hallway, with furniture and six doors that open and close. A vacuum cleaner wanders, a cat walks from room to room.
    office             Ten rooms with desks along a corridor; the walls come from a picture. Two cleaning robots wander.
    warehouse          Long shelves with aisles of about 2 m. Thirty-two carriers drive around the shelves, eight wander.
    cave               A cave with pillars and dead ends; the walls come from a picture. Three robots wander.
    yard               Two tugs that drive in circles push boxes, a shuttle moves back and forth through a gate, three carriers wander.
    office_week        Six rooms at a corridor, with a calendar: doors by hours and weekdays, a cart, a delivery robot; the robot patrols for 5 % of the time.
    ");
}

/// A port on which no program listens.
fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

#[test]
fn a_missing_viewer_is_one_note_and_the_run_goes_on() {
    let (run, port) = (Run::new(), free_port());
    let ended = run.goes_well(&format!("--duration 30 --connect 127.0.0.1:{port}"));
    let notes: Vec<&str> = ended.stderr.lines().filter(|line| line.starts_with("note: ")).collect();
    assert_eq!(notes.len(), 1, "{}", ended.stderr);
    let says = format!("note: no viewer answers at rerun+http://127.0.0.1:{port}/proxy: ");
    assert!(notes[0].starts_with(&says), "{}", notes[0]);
    assert!((Recording::read(&run.out("four_rooms.rrd")).end_s() - 30.0).abs() < 1e-6);
}

#[test]
fn a_missing_viewer_without_a_recording_is_an_error() {
    let ended = Run::new().ends(&format!("--no-rrd --duration 30 --connect 127.0.0.1:{}", free_port()));
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.stderr.starts_with("error: no viewer answers at "), "{ended:?}");
    assert_eq!(ended.stderr.lines().count(), 1, "{ended:?}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_terminal_shows_a_bar_that_goes_away() {
    let run = Run::new();
    let ended = crate::terminal::run(&run, "--no-rrd --duration 300 --speed 200");
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let (before, after) = ended.stdout.split_once("agent in four rooms: 5 min").unwrap();
    assert!(before.contains("█") && before.contains(" of 300 s at "), "{before:?}");
    assert!(!after.contains("█"), "{after:?}");
    // The code `[2K` clears the line.
    for line in before.split(['\r', '\n', '\u{1b}']).filter(|line| line.contains("█")) {
        let line = line.trim_start_matches("[2K");
        assert!(line.chars().count() <= usize::from(crate::terminal::COLUMNS), "{line:?}");
        assert!(line.contains(" %, ") && line.ends_with(" left"), "{line:?}");
    }
}

/// Like `| head`: both ends of the pipe exist, and then one is closed.
#[test]
fn a_run_goes_on_when_nobody_listens() {
    let run = Run::new();
    let mut child = run.starts("--no-rrd --duration 30");
    drop((child.stdout.take(), child.stderr.take()));
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(run.summary().number("/simulated_s"), 30.0);

    let mut child = run.starts("--list-worlds");
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}
