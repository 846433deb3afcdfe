//! Snapshots, copies and resets.

use super::fleet::{hash, robot};
use super::specs::crowd;
use super::*;
use proptest::prelude::*;

/// Every kind of robot, sensor, fault and obstacle, and two robots that collide.
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
        let robot = robot(&format!("r{i}"), *at, 45.0, &format!("kind = {kind}")).replace("[robot.laser]", noisy);
        // One of the driven robots has every sensor and every fault.
        if i != 5 {
            return robot;
        }
        let faults = "distance_noise_m = 0.01\nslip = 0.7\njump = { every_s = 1.0, distance_m = 0.5, turn_deg = 20.0 }\n\
                      carried = { every_s = 5.0, distance_m = 2.0, turn_deg = 90.0 }";
        let lasers = "dropout = 0.3\nsweep_s = 0.1\n[[robot.laser]]\nbeams = 50\nrange_max_m = 10.0\nrate_hz = 2.0\nnoise_std_m = 0.02\n";
        robot
            .replace("distance_noise_m = 0.01", faults)
            .replace("[robot.laser]", "[[robot.laser]]")
            .replace("[robot.behavior]", &format!("{lasers}{}", super::senses::SENSES))
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

/// All poses and readings.
pub(super) fn sensed(fleet: &Fleet) -> (u64, Vec<String>) {
    let others = fleet.robots().map(|robot| {
        format!("{:?} {:?}", robot.lasers().collect::<Vec<_>>(), robot.sonars().collect::<Vec<_>>())
    });
    (hash(fleet), others.collect())
}

#[test]
fn a_restored_fleet_and_a_fork_live_on_bit_by_bit() {
    let (zoo, crowd, busy) = (zoo(), crowd(), super::specs::busy());
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
            let restored = Fleet::restored(spec, &snapshot).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(restored.snapshot(), snapshot, "at {at_s} s");
            assert_eq!(sensed(&restored), sensed(&fleet));
            // A fleet that returns to the snapshot; first it keeps its state, since it cannot.
            let mut returned = Fleet::new(spec, 4);
            returned.run_until(at_s + 2.0, &mut drivers);
            let later = returned.snapshot();
            assert_eq!(returned.restore(&snapshot[..100]), Err(SnapshotError::Damaged));
            assert_eq!(returned.snapshot(), later);
            assert_eq!(returned.restore(&snapshot), Ok(()));
            let mut others = [fleet.clone(), restored, returned];
            for _ in 0..10 {
                fleet.run_until(fleet.time_s() + 3.0, &mut drivers);
                for other in &mut others {
                    other.run_until(other.time_s() + 3.0, &mut drivers);
                    assert_eq!(sensed(other), sensed(&fleet), "from {at_s} s");
                    assert_eq!(other.contacts(), fleet.contacts());
                }
            }
            assert!(others.iter().all(|other| other.snapshot() == fleet.snapshot()), "from {at_s} s");
        }
    }
}

#[test]
fn snapshots_of_other_places_are_refused() {
    let snapshot = Fleet::new(&crowd(), 1).snapshot();
    for (spec, bytes, error) in [
        (zoo(), &snapshot[..], SnapshotError::OtherSpec),
        (zoo(), b"", SnapshotError::Unknown),
        (zoo(), b"something else", SnapshotError::Unknown),
        (zoo(), &snapshot[..8], SnapshotError::Damaged),
        (crowd(), &snapshot[..snapshot.len() - 1], SnapshotError::Damaged),
    ] {
        assert_eq!(Fleet::restored(&spec, bytes).err(), Some(error));
    }
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
