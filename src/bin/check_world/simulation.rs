//! What the robots of a world do by themselves.

use evaluation::metrics::Standstills;
use interfaces::printable;
use sim::physics::{BehaviorSpec, Fleet, FleetSpec};

/// A standstill of this time or longer is reported, s.
const LONG_S: f64 = 60.0;
/// The time between two observations, s.
const EVERY_S: f64 = 1.0;
/// The maximum number of robots that are named.
const MAX_NAMED: usize = 10;

/// Simulates a world for `duration_s`, and reports the robots that stood still for a minute or longer, with the place
/// of their longest standstill, and the number of contacts. Driven robots and robots that stand by their specification
/// are not reported.
pub(crate) fn lines(spec: &FleetSpec, seed: u64, duration_s: f64) -> Vec<(&'static str, String)> {
    let (mut fleet, mut standstills, mut contacts) = (Fleet::new(spec, seed), Standstills::default(), 0);
    let mut time_s = 0.0;
    while time_s < duration_s {
        time_s = duration_s.min(time_s + EVERY_S);
        fleet.run_until(time_s, &mut ());
        standstills.observe(time_s, fleet.robots().map(|robot| robot.pose.translation.vector.into()));
        contacts += fleet.contacts().len();
    }
    let moves = |behavior: &BehaviorSpec| !matches!(behavior, BehaviorSpec::Standing | BehaviorSpec::Driven);
    let robots = spec.robots.iter().zip(standstills.longest());
    let moving: Vec<_> = robots.filter(|(robot, _)| moves(&robot.behavior)).collect();
    let longest_s = moving.iter().fold(0.0, |most: f64, (_, (longest_s, _))| most.max(*longest_s));
    let mut lines = vec![
        (
            "simulated",
            format!("{:.1} minutes with seed {seed}; driven robots stand still", duration_s / 60.0),
        ),
        ("contacts", format!("{contacts} of robots with other bodies")),
    ];
    let stood: Vec<_> = moving.iter().filter(|(_, (longest_s, _))| *longest_s >= LONG_S).collect();
    lines.extend(stood.iter().take(MAX_NAMED).map(|(robot, (longest_s, at))| {
        let name = printable(&robot.name);
        ("stood", format!("`{name}` did not move 0.1 m in {longest_s:.0} s, at [{:.2}, {:.2}]", at.x, at.y))
    }));
    match stood.len() {
        0 if moving.is_empty() => {}
        0 => lines.push(("stood", format!("no robot stood longer than {longest_s:.0} s"))),
        count if count > MAX_NAMED => lines.push(("stood", format!("… and {} more", count - MAX_NAMED))),
        _ => {}
    }
    lines
}
