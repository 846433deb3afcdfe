//! A scripted tour reproduces the paper's Figure 5.

use crate::run::Run;

#[test]
fn the_shipped_tour_finds_high_rates_on_the_dummys_way_and_none_on_walls() {
    let run = Run::quiet("--drive tour");
    let summary = run.summary();
    assert_eq!((summary.text("/drive"), summary.text("/ended_by")), ("tour", "duration"));
    assert!(summary.number("/coverage") > 0.99);
    assert_eq!(summary.number("/collisions"), 0.0);

    // The dummy robot drives between (7.2, 11.5) and (11.2, 11.5); its radius is 0.2 m.
    let (mut way, mut changing_on_way, mut elsewhere) = (0, 0, 0);
    let (mut rates_hz, mut max_elsewhere_hz) = (Vec::new(), 0.0_f64);
    for cell in run.cells() {
        let off_x_m = (cell.x_m - cell.x_m.clamp(7.2, 11.2)).abs();
        let off_m = off_x_m.hypot(cell.y_m - 11.5);
        if off_m < 0.15 {
            way += 1;
            changing_on_way += usize::from(cell.events() != [0, 0]);
            if off_x_m == 0.0 && (8.0..10.4).contains(&cell.x_m) {
                rates_hz.push(cell.rate_hz);
            }
        } else if off_m > 0.3 {
            elsewhere += usize::from(cell.events() != [0, 0]);
            max_elsewhere_hz = cell.rate_hz.max(max_elsewhere_hz);
        }
    }
    assert!(way > 400, "{way}");
    assert!(changing_on_way as f64 > 0.95 * way as f64, "{changing_on_way} of {way} cells on the way change");
    assert_eq!(elsewhere, 0, "cells change where nothing moves");
    // Back and forth over 4 m at 0.3 m/s takes about 30 s including the turns, with two passages.
    rates_hz.sort_by(f64::total_cmp);
    let median_hz = rates_hz[rates_hz.len() / 2];
    assert!((0.04..0.1).contains(&median_hz), "{median_hz} Hz");
    // By the shared prior no free cell has rate 0.
    assert!(max_elsewhere_hz < 0.1 * median_hz, "{max_elsewhere_hz} Hz where nothing moves");
}

#[test]
fn a_tour_of_ones_own_ends_the_run() {
    let run = Run::new();
    run.write("mine.toml", "waypoints_m = [[4.0, 2.0], [4.0, 4.0]]\nrepeat = false\n");
    run.goes_well("--quiet --no-rrd --drive tour --tour mine.toml");
    let summary = run.summary();
    assert_eq!(summary.text("/ended_by"), "tour");
    assert_eq!(summary.number("/goals/reached"), 2.0);
    assert!((4.0..30.0).contains(&summary.number("/simulated_s")), "{}", summary.number("/simulated_s"));
}

/// A door is closed for 5 s of 20, and the way round takes 30 s: on that, the robot is in the upper rooms.
#[test]
fn the_robot_waits_for_a_door_that_opens_soon() {
    let run = Run::new();
    let door = "[[obstacle]]\nname = \"door\"\nkind = \"hinged_door\"\nfrom_m = [6.0, 2.5]\nto_m = [6.0, 3.5]\n\
        thickness_m = 0.05\nopen_deg = 90.0\nopening = \"random\"\nclosed_s = 5.0\nopen_s = 15.0\n";
    let rooms = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/four_rooms.toml"));
    run.write("doors.toml", &format!("{}\n{door}", rooms.unwrap()));
    run.write("mine.toml", "waypoints_m = [[4.0, 3.0], [8.0, 3.0]]\nrepeat = true\n");
    run.goes_well(
        "--quiet --no-rrd --world doors.toml --drive tour --tour mine.toml --duration 40m --seed 1",
    );
    let goals = run.summary().number("/goals/reached");
    // At once 8 s for each goal, or 287 × ⅔ with a robot that always takes the way round.
    assert!((210.0..300.0).contains(&goals), "{goals}");
}
