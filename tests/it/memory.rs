//! The memory of a run does not grow with its length: what is kept is bounded, or thinned.
#![cfg(target_os = "linux")]

use crate::run::Run;
use std::time::Duration;

/// The room of docs/worlds.md with large cells, few beams and a block that moves: a thousand times real time and more.
fn room() -> String {
    let page = include_str!("../../docs/worlds.md");
    let room = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let room = room.replace("cell_m = 0.05", "cell_m = 0.1").replace("beams = 720", "beams = 90");
    let block = "size_m = [0.3, 0.3]\nspeed_mps = 0.3\nrepeat = \"back_and_forth\"\npath_m = [[3.4, 0.5], [3.4, 2.5]]";
    format!("{room}\n[[obstacle]]\nname = \"block\"\nkind = \"block\"\n{block}\n")
}

/// The peak of the memory of a run, MB.
fn peak_mb(arguments: &str) -> f64 {
    let run = Run::new();
    run.write("room.toml", &room());
    let mut child = run.starts(&format!("--quiet {arguments}"));
    let status = format!("/proc/{}/status", child.id());
    let mut peak_kb = 0.0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.strip_suffix("kB"));
        peak_kb = line.map_or(peak_kb, |line| line.trim().parse().unwrap());
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(child.wait().unwrap().success(), "{arguments}");
    println!("{arguments}: {:.1} MB", peak_kb / 1e3);
    peak_kb / 1e3
}

/// Runs with these arguments for two hours and for `hours`, and compares their memory.
fn is_flat(arguments: &str, hours: u32) {
    let [short_mb, long_mb] = [2, hours].map(|hours| peak_mb(&format!("{arguments} --duration {hours}h")));
    let growth = long_mb / short_mb - 1.0;
    assert!(growth.abs() <= 0.02, "{:+.1} % from 2 to {hours} h: {arguments}", 100.0 * growth);
}

#[test]
fn memory_is_flat_for_ten_hours() {
    is_flat("--no-rrd --world room.toml", 10);
}
