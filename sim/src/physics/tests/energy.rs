use super::*;
use interfaces::{LaserReading, Twist};

/// Total energy of all bodies after all robots were commanded to stop.
#[test]
fn energy_never_grows_without_a_drive() {
    let drive =
        |linear_mps| move |_: &RobotView<'_>, _: &LaserReading| Twist { linear_mps, angular_radps: 0.0 };
    let mut fleet = Fleet::new(&heap(), 0);
    fleet.run_until(1.9, &mut drive(0.5));
    fleet.run_until(2.6, &mut drive(0.0));
    let mut before_j = fleet.kinetic_j();
    assert!(before_j > 1e-3, "nothing moves: {before_j} J");
    while fleet.time_s() < 62.6 {
        fleet.step(&mut drive(0.0));
        let now_j = fleet.kinetic_j();
        assert!(now_j <= before_j * 1.001 + 1e-12, "from {before_j} to {now_j} J at {} s", fleet.time_s());
        before_j = now_j;
    }
}
