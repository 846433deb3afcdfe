//! The memory of a run does not grow with its length: what is kept is bounded, or thinned.
#![cfg(target_os = "linux")]

use crate::run::Run;
use std::time::Duration;

/// A small room with a second robot: a thousand times real time and more.
const ROOM: &str = r#"
name = "small room"

[map]
size_m = [4.0, 3.0]
cell_m = 0.1

[[wall]]
from_m = [2.0, 0.0]
to_m = [2.0, 1.5]
thickness_m = 0.1

[[robot]]
name = "curious"
radius_m = 0.15
pose_m = [1.0, 1.0]
[robot.drive]
max_linear_mps = 0.8
max_angular_degps = 150.0
max_linear_acceleration_mps2 = 1.5
max_angular_acceleration_degps2 = 600.0
[robot.laser]
beams = 90
range_max_m = 5.0
rate_hz = 10.0
[robot.behavior]
kind = "driven"

[[robot]]
name = "cleaner"
radius_m = 0.15
pose_m = [3.0, 1.0]
[robot.drive]
max_linear_mps = 0.4
max_angular_degps = 120.0
max_linear_acceleration_mps2 = 1.0
max_angular_acceleration_degps2 = 360.0
[robot.laser]
beams = 30
range_max_m = 3.0
rate_hz = 10.0
[robot.behavior]
kind = "wander"
speed_mps = 0.3
"#;

/// The peak of the memory of a run, MB.
fn peak_mb(arguments: &str) -> f64 {
    let run = Run::new();
    run.write("room.toml", ROOM);
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
