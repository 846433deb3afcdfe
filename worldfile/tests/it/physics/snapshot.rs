//! Snapshots, copies and resets.

use super::fleet::{crowd, hash, robot};
use super::*;
use interfaces::LaserReading;
use proptest::prelude::*;

/// Every kind of robot and obstacle, and two robots that collide.
pub(super) fn zoo() -> FleetSpec {
    let kinds = [
        ("\"wander\"\nspeed_mps = 0.4", [2.0, 2.0]),
        ("\"circle\"\nspeed_mps = 0.4\nturn_radius_m = 1.0", [3.0, 3.0]),
        ("\"waypoints\"\nspeed_mps = 0.4\npoints_m = [[1.0, 1.0], [5.0, 1.0]]", [1.0, 1.0]),
        ("\"standing\"", [4.0, 2.5]),
        ("\"driven\"", [8.0, 2.0]),
        ("\"driven\"", [8.0, 4.0]),
        (
            "\"wall_patrol\"\nspeed_mps = 0.3\nfrom_m = [7.2, 11.5]\nto_m = [11.2, 11.5]\nwall_side = \"left\"",
            [8.0, 11.5],
        ),
    ];
    let robots = kinds.iter().enumerate().map(|(i, (kind, at))| {
        let noisy = "[robot.odometry]\ndistance_noise_m = 0.01\n[robot.laser]";
        robot(&format!("r{i}"), *at, 45.0, &format!("kind = {kind}")).replace("[robot.laser]", noisy)
    });
    let boxes = "[[obstacle]]\nname = \"one\"\nmin_m = [9.0, 8.0]\nmax_m = [9.2, 8.2]\nappears_s = 2.0\ndisappears_s = 9.0\n\
        [[obstacle]]\nname = \"two\"\nmin_m = [9.5, 8.0]\nmax_m = [9.7, 8.2]\ndisappears_s = 12.0\n";
    fleet::house(&robots.collect::<Vec<_>>(), boxes)
}

/// The two driven robots drive toward each other.
fn drivers(robot: &RobotView<'_>, reading: &LaserReading) -> Twist {
    let turn = libm::sin(reading.time_s) * 0.3;
    Twist { linear_mps: if robot.index == 4 { 0.4 } else { -0.4 }, angular_radps: turn }
}

#[test]
fn a_restored_fleet_and_a_fork_live_on_bit_by_bit() {
    let (zoo, crowd, busy) = (zoo(), crowd(), super::things::busy());
    // Steps of both kinds.
    let sliding = FleetSpec { contacts: ContactModel::Sliding, ..zoo.clone() };
    // Robots on waypoints that turn round and make detours, and doors that move back.
    let house = super::standstill::worlds::house(7);
    for spec in [&zoo, &sliding, &crowd, &busy, &house] {
        // Before the first step, between two scans, and after contacts.
        for at_s in [0.0, 0.05, 5.0, 10.0, 31.25] {
            let mut fleet = Fleet::new(spec, 4);
            fleet.run_until(at_s, &mut drivers);
            let snapshot = fleet.snapshot();
            assert_eq!(fleet.snapshot(), snapshot);
            let mut fork = fleet.clone();
            let mut restored = Fleet::restored(spec, &snapshot).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(restored.snapshot(), snapshot, "at {at_s} s");
            for _ in 0..10 {
                for other in [&mut fleet, &mut fork, &mut restored] {
                    other.run_until(other.time_s() + 3.0, &mut drivers);
                }
                assert_eq!(hash(&fork), hash(&fleet), "the fork of {at_s} s");
                assert_eq!(hash(&restored), hash(&fleet), "restored from {at_s} s");
                assert_eq!(restored.contacts(), fleet.contacts());
            }
            assert_eq!(restored.snapshot(), fleet.snapshot());
        }
    }
}

#[test]
fn snapshots_of_other_places_are_refused() {
    let snapshot = Fleet::new(&crowd(), 1).snapshot();
    assert_eq!(Fleet::restored(&zoo(), &snapshot).err(), Some(SnapshotError::OtherSpec));
    assert_eq!(Fleet::restored(&zoo(), b"").err(), Some(SnapshotError::Unknown));
    assert_eq!(Fleet::restored(&zoo(), b"something else").err(), Some(SnapshotError::Unknown));
    assert_eq!(Fleet::restored(&zoo(), &snapshot[..8]).err(), Some(SnapshotError::Damaged));
    assert_eq!(
        Fleet::restored(&crowd(), &snapshot[..snapshot.len() - 1]).err(),
        Some(SnapshotError::Damaged)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_changed_byte_is_noticed(place in 8_usize..40_000, change in 1_u8..=255) {
        let spec = zoo();
        let mut snapshot = Fleet::new(&spec, 1).snapshot();
        let place = 8 + place % (snapshot.len() - 8);
        snapshot[place] ^= change;
        prop_assert_eq!(Fleet::restored(&spec, &snapshot).err(), Some(SnapshotError::Damaged));
    }
}
