//! The dummy robot waits while the curious robot is in its way, and the map shows it.

use agent::Features;
use interfaces::{CellState, Twist};
use mapper::{Mapper, MapperSettings};
use nalgebra::Point2;
use robot::{Belief, ExactPoses, Pilot, Robot};
use sim::physics::PhysicsWorld;

const STANDS_UNTIL_S: f64 = 30.0;
const END_S: f64 = 60.0;

/// A robot that stands still for a while, and then drives away.
struct Visitor;

impl Pilot for Visitor {
    type Command = Twist;

    fn command(&mut self, belief: &Belief, _: Features, mapper: &Mapper) -> Twist {
        let goes = mapper.time() > STANDS_UNTIL_S && belief.pose.translation.y > 9.0;
        Twist { linear_mps: if goes { 0.5 } else { 0.0 }, angular_radps: 0.0 }
    }
}

/// The shipped house, with the curious robot in the middle of the dummy robot's path, pointing down.
fn world() -> PhysicsWorld {
    let (name, text) = curious::worlds::SHIPPED[0];
    let text = text.replacen("pose_m = [2.0, 2.0]", "pose_m = [9.5, 11.5]", 1);
    let text = text.replacen("heading_deg = 0.0", "heading_deg = 270.0", 1);
    PhysicsWorld::new(&worldfile::physics::parse_world(name, &text).unwrap(), 0)
}

#[test]
fn it_waits_and_goes_on() {
    let mut world = world();
    let mapper = Mapper::new(&MapperSettings::default(), world.spec().frame).unwrap();
    let mut robot = Robot::new(Box::new(ExactPoses), mapper, Visitor);
    let mut way: Vec<(f64, f64)> = Vec::new();
    let mut seen_waiting = Vec::new();
    let (mut command, mut time_s) = (None, 0.0);
    while time_s < END_S {
        let turn = robot::turn(&mut world, &mut robot, &mut command).unwrap();
        time_s = turn.reading.time_s;
        let dummy = world.fleet().robots().find(|robot| !robot.is_driven).unwrap().pose.translation;
        way.push((time_s, dummy.x));
        assert_eq!(world.contacts(), []);
        if time_s < STANDS_UNTIL_S {
            // The front of the dummy's body, which the robot observes.
            let front = Point2::new(dummy.x + 0.18, dummy.y);
            seen_waiting.push(robot.mapper.states().get(robot.mapper.frame().cell_at(&front)).copied());
        }
    }
    let mapper = &robot.mapper;

    let x_at = |time_s: f64| way.iter().find(|(at_s, _)| *at_s >= time_s).unwrap().1;
    let waits_at = x_at(20.0);
    assert!((8.0..9.1).contains(&waits_at), "it waits at x = {waits_at}");
    assert_eq!(x_at(STANDS_UNTIL_S), waits_at, "it stands still meanwhile");
    assert!(way.iter().any(|&(_, x)| x > 11.0), "it never went on");
    assert_eq!(seen_waiting.last().unwrap(), &Some(CellState::Blocked), "the map knows where it waits");
    let there = mapper.frame().cell_at(&Point2::new(waits_at + 0.18, 11.5));
    assert_eq!(mapper.states().get(there), Some(&CellState::Free), "and that it has gone");
}
