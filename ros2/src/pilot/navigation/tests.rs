//! The agent selects the same goals with every driver; permissions hold.

use super::*;
use crate::parameters::{Mode, Navigator, Parameters};
use crate::pilot::LivePilot;
use agent::{Features, Policy};
use controller::Driver;
use interfaces::{PoseMode, World};
use mapper::Mapper;
use nalgebra::Isometry2;
use robot::{Belief, GoalCount, Permission, Pilot, Settings, Source};
use sim::physics::PhysicsWorld;

fn settings(policy: &Policy, navigator: Navigator) -> (Parameters, Settings) {
    let parameters = Parameters {
        mode: Mode::Explore,
        strategy: policy.name().to_owned(),
        navigator,
        seed: 3,
        ..Parameters::default()
    };
    let source = Source { pose: PoseMode::Exact, range_max_m: 10.0, ..Source::default() };
    (parameters, Settings::of(&source))
}

fn live(policy: &Policy, navigator: Navigator) -> LivePilot {
    let (parameters, settings) = settings(policy, navigator);
    LivePilot::new(&parameters, &settings).unwrap()
}

fn navigation(pilot: &mut LivePilot) -> &mut Navigation {
    pilot.explorer.as_mut().unwrap().driver.navigation.as_mut().unwrap()
}

/// What Nav2 says in a turn in which the controller of the other robot has finished its goal.
fn news(before: GoalCount, after: GoalCount, target: Option<Target>) -> Option<link::Navigation> {
    let stays = target.is_some_and(|target| target.stay_s > 0.0);
    if after.given_up > before.given_up {
        Some(link::Navigation::GivenUp)
    } else {
        (after != before && !stays).then_some(link::Navigation::Reached)
    }
}

#[test]
fn every_strategy_selects_the_same_goals_whoever_drives() {
    let spec = worldfile::shipped::load("house").unwrap();
    for policy in Policy::built_in() {
        let (_, settings) = settings(policy, Navigator::CmdVel);
        let mut world = PhysicsWorld::new(&spec, 1);
        world.correct_odometry();
        let own = settings.pilot(settings.agent(policy, 3).unwrap(), 3).unwrap();
        let mut robot = settings.robot(spec.frame, None, *world.true_pose(), own).unwrap();
        let mut by_velocities = live(policy, Navigator::CmdVel);
        let mut by_nav2 = live(policy, Navigator::Nav2);
        let mut goals = Vec::new();
        while world.time_s() < 60.0 {
            let before = robot.pilot.view().goals;
            let turn = robot.step(world.sense()).unwrap();
            let goal = robot.pilot.view().goal;
            let command = by_velocities.command(&turn.belief, turn.features, &robot.mapper);
            assert_eq!(command, Order::Velocity(turn.command), "{}", policy.name());
            let target = navigation(&mut by_nav2).target;
            if let Some(news) = news(before, robot.pilot.view().goals, target) {
                by_nav2.navigated(news);
            }
            let order = by_nav2.command(&turn.belief, turn.features, &robot.mapper);
            let is_watching = robot.pilot.driver.view().status == Status::Exploring;
            if let Some(target) = &mut navigation(&mut by_nav2).target {
                // Nav2 makes progress, however long the controller explores around its goal, and is there when it is.
                target.nearest_s = turn.reading.time_s;
                if is_watching && target.stay_s > 0.0 {
                    target.reached_s.get_or_insert(turn.reading.time_s);
                }
            }
            assert_eq!((by_velocities.view().goal, by_nav2.view().goal), (goal, goal), "{}", policy.name());
            if goals.last() != Some(&goal) {
                goals.push(goal);
                assert!(matches!(order, Order::Goal(_)), "{}: {order:?}", policy.name());
            }
            world.act(&turn.command);
        }
        assert!(goals.len() > 3, "{}: {goals:?}", policy.name());
    }
}

/// A map of a free room of 8 × 8 m.
fn room() -> Mapper {
    let frame = interfaces::GridFrame::new(Point2::new(-4.0, -4.0), 0.1, 80, 80).unwrap();
    let free = interfaces::Grid::filled(frame, interfaces::CellState::Free);
    Mapper::with_prior(&Default::default(), free).unwrap()
}

#[test]
fn permissions_hold_for_nav2() {
    let (mut pilot, map) = (live(&Policy::default(), Navigator::Nav2), room());
    let mut order = |permission| {
        let belief = Belief { permission, ..Belief::exact(Isometry2::identity()) };
        pilot.command(&belief, Features::default(), &map)
    };
    assert_eq!(order(Permission::Rest), Order::None);
    let goal = order(Permission::Drive);
    assert!(matches!(goal, Order::Goal(_)));
    assert_eq!(order(Permission::Drive), Order::None);
    assert_eq!(order(Permission::Rest), Order::Cancel);
    assert_eq!(order(Permission::Rest), Order::None);
    // The same goal goes on.
    assert_eq!(order(Permission::Drive), goal);
    // A robot that is lost turns in place.
    let Order::Goal(turned) = order(Permission::LookAround) else { panic!() };
    assert!((heading_rad(&turned) - LOOK_RAD).abs() < 1e-9 && turned.translation.vector.norm() < 1e-9);
    assert_eq!(order(Permission::LookAround), Order::None);
    assert_eq!(order(Permission::Drive), goal);
}
