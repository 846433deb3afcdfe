use super::*;

const BOX: &str = "[[obstacle]]\nname = \"box\"\nmin_m = [3.0, 1.8]\nmax_m = [3.4, 2.2]\n";
const BACK: Twist = Twist { linear_mps: -0.4, angular_radps: 0.0 };

#[test]
fn it_comes_and_goes_on_time_and_is_solid_meanwhile() {
    let spec = four_rooms_but(&[], &format!("{BOX}appears_s = 1.0\ndisappears_s = 2.05"));
    let mut world = PhysicsWorld::new(&spec, 0);
    let ahead = |world: &mut PhysicsWorld| world.sense().scan.ranges_m[360];
    for tick in 1..=30 {
        world.act(&Twist::STOP);
        let standing = (10..21).contains(&tick);
        assert_eq!(world.fleet().obstacles().count(), usize::from(standing), "at {} s", world.time_s());
        assert!((ahead(&mut world) - if standing { 1.0 } else { 3.95 }).abs() < 1e-5);
        let expected = if standing { TrueState::Blocked } else { TrueState::Free };
        assert_eq!(state_at(&world, 3.21, 2.01), expected);
    }
    let events = world.obstacle_events();
    let reported: Vec<_> = events.iter().map(|e| (e.name.as_str(), e.appeared, e.cells.len())).collect();
    assert_eq!(reported, [("box", true, 64), ("box", false, 64)]);
    assert!((events[0].time_s - 1.0).abs() < 1e-9 && (events[1].time_s - 2.05).abs() < 1e-9);
}

#[test]
fn it_waits_for_its_place() {
    let here = BOX.replace("[3.0, 1.8]", "[2.1, 1.8]");
    let mut world = PhysicsWorld::new(&four_rooms_but(&[], &format!("{here}appears_s = 1.0")), 0);
    drive(&mut world, Twist::STOP, 3.0, |_| ());
    assert_eq!(world.obstacle_events(), []);
    let contacts = drive(&mut world, BACK, 1.0, |_| ());
    let event = &world.obstacle_events()[0];
    assert!(event.appeared && event.time_s > 3.0);
    assert_eq!(contacts, []);

    // An obstacle that never finds a free place does not appear late.
    let late = four_rooms_but(&[], &format!("{here}appears_s = 1.0\ndisappears_s = 2.0"));
    let mut world = PhysicsWorld::new(&late, 0);
    drive(&mut world, Twist::STOP, 3.0, |_| ());
    drive(&mut world, BACK, 2.0, |_| ());
    assert_eq!(world.obstacle_events(), []);
}
