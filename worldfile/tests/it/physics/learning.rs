//! What users need who run many episodes: resets, fresh scans, all scans at once, free poses.

use super::fleet::hash;
use super::specs::crowd;
use super::*;
use interfaces::{Purpose, RandomStream, heading_rad};
use proptest::prelude::*;

/// Commands that depend on the robot and the time.
fn drivers(robot: &RobotView<'_>, reading: &LaserReading) -> Twist {
    let phase = reading.time_s + robot.index as f64;
    Twist { linear_mps: 0.4 * libm::cos(phase), angular_radps: libm::sin(phase) }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_reset_is_the_same_as_a_new_fleet(
        world in 0_u64..10_000,
        kind in 0..5,
        seeds: [u64; 2],
        ran_s in 0.0..20.0,
    ) {
        let spec = match kind {
            0 => super::snapshot::zoo(),
            1 => super::specs::busy(),
            2 => super::standstill::worlds::house(world),
            3 => super::random::world(world),
            _ => worldfile::shipped::load("drifting_house").unwrap().fleet().clone(),
        };
        let mut fleet = Fleet::new(&spec, seeds[0]);
        fleet.run_until(ran_s, &mut drivers);
        fleet.look_all();
        let mut of_a_clone = fleet.clone();
        let mut new = Fleet::new(&spec, seeds[1]);
        fleet.reset(seeds[1]);
        of_a_clone.reset(seeds[1]);
        prop_assert!(fleet.snapshot() == new.snapshot());
        for fleet in [&mut fleet, &mut of_a_clone, &mut new] {
            fleet.run_until(12.0, &mut drivers);
        }
        prop_assert_eq!(hash(&fleet), hash(&new));
        prop_assert!(fleet.snapshot() == new.snapshot());
        prop_assert!(of_a_clone.snapshot() == new.snapshot());
    }

    #[test]
    fn a_reset_is_the_same_as_a_new_world(house in 0_u64..1000, seeds: [u64; 2], ticks in 0..100) {
        let spec = WorldSpec::generate_house(house);
        let run = |world: &mut PhysicsWorld, ticks: i32| {
            for tick in 0..ticks {
                let angular_radps = libm::sin(f64::from(tick) * 0.1);
                world.act(&Twist { linear_mps: 0.5, angular_radps });
                world.sense();
            }
        };
        let mut world = PhysicsWorld::new(&spec, seeds[0]);
        run(&mut world, ticks);
        world.reset(seeds[1]);
        let mut new = PhysicsWorld::new(&spec, seeds[1]);
        for world in [&mut world, &mut new] {
            run(world, 100);
        }
        prop_assert!(world.snapshot().into_bytes() == new.snapshot().into_bytes());
        prop_assert_eq!(world.truth().changes(), new.truth().changes());
        prop_assert_eq!(world.sense(), new.sense());
    }
}

#[test]
fn a_look_is_of_the_same_instant_as_the_pose() {
    let spec = super::snapshot::zoo();
    let mut fleet = Fleet::new(&spec, 4);
    fleet.step(&mut drivers);
    let before = fleet.robot(4).unwrap().reading().unwrap().clone();
    assert_eq!(before.time_s, 0.0);
    let pose = fleet.robot(4).unwrap().pose;
    let seen = fleet.look(4).unwrap().reading().unwrap().clone();
    assert_eq!((seen.time_s, fleet.robot(4).unwrap().pose), (fleet.time_s(), pose));
    // The odometry of this robot is noisy, its velocity is not.
    assert_ne!(seen.pose, before.pose);
    // A second look is the same reading, and so is the look of all robots.
    assert_eq!(fleet.look(4).unwrap().reading(), Some(&seen));
    fleet.look_all();
    assert_eq!(fleet.robot(4).unwrap().reading(), Some(&seen));
    assert!(fleet.robots().all(|robot| robot.reading().unwrap().time_s == fleet.time_s()));
    assert!(fleet.look(99).is_none() && fleet.robot(99).is_none());
}

#[test]
fn a_look_when_a_scan_is_due_changes_nothing() {
    let run = |looks: bool| {
        let mut fleet = Fleet::new(&crowd(), 3);
        for _ in 0..100 {
            fleet.step(&mut ());
            fleet.step(&mut ());
            if looks {
                fleet.look_all();
            }
        }
        fleet.step(&mut ());
        hash(&fleet)
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn scans_and_poses_of_all_robots_are_copied() {
    let mut fleet = Fleet::new(&crowd(), 3);
    let mut ranges_m = vec![0.0; fleet.beams()];
    assert_eq!(ranges_m.len(), 36 * 90);
    fleet.copy_scans(&mut ranges_m).unwrap();
    assert!(ranges_m.iter().all(|range_m| range_m.is_nan()));
    fleet.run_until(1.0, &mut ());
    fleet.look_all();
    fleet.copy_scans(&mut ranges_m).unwrap();
    let mut poses = vec![[0.0; 3]; 36];
    fleet.copy_poses(&mut poses).unwrap();
    for (robot, (scan, pose)) in fleet.robots().zip(ranges_m.chunks(90).zip(&poses)) {
        assert_eq!(robot.reading().unwrap().scan.ranges_m, scan);
        let at = robot.pose.translation;
        assert_eq!([at.x, at.y, heading_rad(&robot.pose)], *pose);
    }
    let error = fleet.copy_scans(&mut ranges_m[1..]).unwrap_err().to_string();
    assert_eq!(error, "the slice for the scans of all robots has 3239 values, and must have 3240");
    let error = fleet.copy_poses(&mut poses[1..]).unwrap_err().to_string();
    assert_eq!(error, "the slice for the poses of all robots has 35 values, and must have 36");
}

#[test]
fn a_robot_fits_at_free_poses() {
    let spec = WorldSpec::generate_house(11);
    let (robot, radius_m) = (spec.driven_index(), spec.driven().radius_m);
    let mut fleet = Fleet::new(&spec, 0);
    fleet.run_until(30.0, &mut ());
    let poses = FreePoses::reachable(&spec, robot).unwrap();
    let space = FreeSpace::new(&spec, radius_m);
    let start = space.region_near(&spec.driven().pose.translation.vector.into(), radius_m);
    let draw = |seed| {
        let mut random = RandomStream::new(seed, Purpose::Task);
        (0..50).map(|_| fleet.draw_pose(&poses, robot, &mut random).unwrap()).collect::<Vec<_>>()
    };
    let drawn = draw(1);
    for pose in &drawn {
        let cell = spec.frame.cell_at(&pose.translation.vector.into());
        assert_eq!(space.regions()[spec.frame.index(cell).unwrap()], start);
        assert_eq!(fleet.clone().teleport(robot, pose), Ok(()));
    }
    assert_eq!(draw(1), drawn);
    assert_ne!(draw(2), drawn);
    assert!(FreePoses::reachable(&spec, 99).is_none());
}
