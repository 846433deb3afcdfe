//! `map_log`: the page, names of places, and what changed since the last visit.

use crate::map_log::{standing_line, standing_log};
use crate::run::{Ended, Run};
use serde_json::json;
use std::fs;

const SAVED: &str = "--quiet --no-rrd --state a.state";
const MONDAY_S: f64 = 1.7e9;
const TUESDAY_S: f64 = MONDAY_S + 86_400.0;
/// The laser of the logs is at the origin, and what comes and goes is 1 m before it.
const LAMP: &str = "[[place]]\nname = \"Lamp & chair\"\nx_m = 1.2\ny_m = 0.1\n";

fn page(run: &Run) -> String {
    fs::read_to_string(run.out("report.html")).unwrap()
}

/// A log of the same laser in which nothing comes.
fn quiet_log(begin_s: f64, seconds: u32) -> String {
    (0..seconds).map(|second| standing_line(begin_s + f64::from(second), false)).collect()
}

/// Names of logs and places could reach the terminal and the browser as control characters, and forge lines.
#[test]
fn names_from_outside_are_printable_wherever_they_are_shown() {
    let run = Run::of("map_log");
    let name = "\u{1b}[2J\u{202e}\nforged: a.log";
    run.write(name, &standing_log(MONDAY_S, 600));
    let place = LAMP.replace("Lamp &", "Lamp \\u001b[2J\\u009b\\nforged: &");
    run.write("places.toml", &place);
    let ended = |run: &Run, arguments: &str, last: &[&str]| -> Ended {
        run.command(arguments).args(last).output().unwrap().into()
    };
    let mapped = ended(&run, "--no-rrd --state a.state --places places.toml", &[name]);
    let page = page(&run);
    let predicted = run.with("predict");
    let asked = ended(&predicted, "a.state --place 1", &[]);
    let shown = predicted.with("state_file");
    let listed = [ended(&shown, "show a.state --settings", &[]), ended(&shown, "remove a.state", &[name])];
    let all = [mapped, asked].into_iter().chain(listed);
    for text in all.flat_map(|ended| [ended.stdout, ended.stderr]).chain([page]) {
        let is_safe = |line: &str| {
            !line.trim_start().starts_with("forged") && line.chars().all(interfaces::is_printable)
        };
        assert!(text.lines().all(is_safe), "{text:?}");
    }
}

#[test]
fn the_page_is_one_file_for_people() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 600));
    run.goes_well("a.log --no-rrd --quiet");
    let page = page(&run);
    assert!(page.len() < 200_000, "{} bytes", page.len());
    // Pictures are inside, and nothing else is loaded or run.
    assert!(page.contains("href=\"data:image/png;base64,"));
    for outside in ["<script", "<link", "<img", "src=", "url(", "@import"] {
        assert!(!page.contains(outside), "{outside}");
    }
    for link in page.split("href=\"").skip(1) {
        assert!(link.starts_with('#') || link.starts_with("data:image/png;base64,"), "{link:.40}");
    }
    // The first lines: is the map good, where is it liveliest, how many doors.
    let (_, mut rest) = page.split_once("<body>").unwrap();
    for text in [
        "This map is good",
        "Most often it changes at ",
        "place 1",
        "No door was seen",
        "Where it changes",
        "The places",
        // It goes every 20 s.
        "Something comes and goes about 180 times per hour",
    ] {
        (_, rest) = rest.split_once(text).unwrap_or_else(|| panic!("{text}: {page}"));
    }
}

#[test]
fn names_and_numbers_stay_in_the_state() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 120));
    run.write("b.log", &standing_log(TUESDAY_S, 120));
    let window = "[[place]]\nname = \"Window\"\nx_m = 2\ny_m = 2\nradius_m = 0.3\n";
    run.write("lamp.toml", &format!("{LAMP}{window}"));
    run.goes_well(&format!("a.log {SAVED} --places lamp.toml"));
    let first = run.summary().0["places"][0].clone();
    assert_eq!((&first["name"], &first["number"]), (&"Lamp & chair".into(), &1.into()), "{first}");
    let page_of_a = page(&run);
    assert!(page_of_a.contains("Lamp &amp; chair"));
    assert!(page_of_a.contains("Window: not seen to change in 2 min of observation."));

    let ended = run.goes_well("b.log --no-rrd --state a.state");
    let second = run.summary().0["places"][0].clone();
    assert_eq!((&second["name"], &second["number"]), (&first["name"], &first["number"]), "{second}");
    ended.prints(&["    1.      Lamp & chair, at "]);
    assert_eq!(run.summary().0["names_without_change"][0]["name"], "Window");

    // Another file replaces the names, also for logs that are learned already.
    run.write("other.toml", "[[place]]\nname = \"Chair\"\nx_m = 1\ny_m = 0\n");
    run.goes_well(&format!("b.log {SAVED} --places other.toml"));
    run.goes_well(&format!("b.log {SAVED}"));
    assert_eq!(run.summary().0["places"][0]["name"], "Chair");
}

#[test]
fn an_invalid_file_of_names_is_refused() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 30));
    run.write("names.toml", &LAMP.replace("y_m", "y"));
    insta::assert_snapshot!(run.refuses("a.log --quiet --no-rrd --places names.toml"), @"
    error: names.toml: TOML parse error at line 4, column 1
      |
    4 | y = 0.1
      | ^
    unknown field `y`, expected one of `name`, `x_m`, `y_m`, `radius_m`
    ");
}

#[test]
fn the_second_visit_says_what_changed() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(MONDAY_S, 240));
    // The same visit goes on: within six hours.
    run.write("b.log", &standing_log(MONDAY_S + 3600.0, 120));
    run.write("c.log", &quiet_log(TUESDAY_S, 1200));
    run.goes_well(&format!("a.log {SAVED}"));
    assert!(run.summary().0["since_last_session"].is_null() && !page(&run).contains("last visit"));
    run.goes_well(&format!("b.log {SAVED}"));
    assert!(run.summary().0["since_last_session"].is_null() && !page(&run).contains("last visit"));
    run.goes_well(&format!("c.log {SAVED}"));
    let summary = run.summary();
    let since = &summary.0["since_last_session"];
    assert_eq!((&since["first_log"], &summary.0["session_begin_s"]), (&2.into(), &TUESDAY_S.into()));
    let place = &since["places"][0];
    assert_eq!(
        [&place["number"], &place["trend"], &place["passages"][1]],
        [&json!(1), &json!("gone"), &json!(0)]
    );
    let page = page(&run);
    for text in [
        "What changed since the last visit",
        "This visit: c.log, from 2023-11-15 22:13 UTC on. Before: a.log, b.log.",
        "did not change in 20 min of observation",
    ] {
        assert!(page.contains(text), "{text}: {page}");
    }

    // And one run with all logs writes the same page.
    run.goes_well("a.log b.log c.log --quiet --no-rrd --out whole");
    assert!(fs::read_to_string(run.path("whole").join("report.html")).unwrap() == page);
}

/// The time between logs without a date is not known: no time on the page counts across it.
#[test]
fn times_of_logs_without_a_date_count_from_their_own_first_scan() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(0.0, 300));
    run.write("b.log", &standing_log(5.0, 200));
    run.goes_well("a.log b.log --no-rrd --quiet");
    let page = page(&run);
    assert!(page.contains("the time between them is not known"), "{page}");
    // It came or went at 190 s, of 200.
    let last = page.split("Last change: 3 min 1").nth(1).unwrap_or_else(|| panic!("{page}"));
    assert!(last[1..].starts_with(" s after the first scan of b.log."), "{last}");
}
