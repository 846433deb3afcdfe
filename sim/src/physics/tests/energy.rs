use super::*;
use interfaces::Twist;

/// Total energy of all bodies after all robots were commanded to stop.
#[test]
fn energy_never_grows_without_a_drive() {
    let mut fleet = Fleet::new(&heap(), 0);
    for (until_s, linear_mps) in [(1.9, 0.5), (2.6, 0.0)] {
        fleet.command(0, Twist { linear_mps, angular_radps: 0.0 });
        fleet.run_until(until_s, &mut ());
    }
    let mut before_j = fleet.bodies.kinetic_j();
    assert!(before_j > 1e-3, "nothing moves: {before_j} J");
    while fleet.time_s() < 62.6 {
        fleet.step(&mut ());
        let now_j = fleet.bodies.kinetic_j();
        assert!(now_j <= before_j * 1.001 + 1e-12, "from {before_j} to {now_j} J at {} s", fleet.time_s());
        before_j = now_j;
    }
}
