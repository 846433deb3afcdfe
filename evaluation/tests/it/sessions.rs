//! What a robot has learned survives: a run that goes on from its state, and two sessions in one place.

use agent::{Agent, Policy};
use controller::{Controller, DiffDrive};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::trial_state::TrialFacts;
use interfaces::{World, heading_rad, pose};
use mapper::Mapper;
use robot::state::{SavedSettings, Sessions, State, learned, restore};
use robot::{Autonomous, Settings};
use sim::physics::{PhysicsWorld, WorldSpec};
use worldfile::shipped;

type Trial = PhysicsTrial<Autonomous<Agent, Controller<DiffDrive>>>;

fn trial(spec: &WorldSpec, seed: u64, settings: &Settings, policy: &str) -> Trial {
    let agent = settings.agent(&policy.parse::<Policy>().unwrap(), seed).unwrap();
    PhysicsTrial::new(spec, seed, settings, None, settings.pilot(agent, seed).unwrap()).unwrap()
}

/// The state after it was written and read.
fn again(state: &State) -> State {
    State::from_bytes(&state.to_bytes().unwrap()).unwrap()
}

#[test]
fn a_run_that_goes_on_equals_one_that_was_not_interrupted() {
    let curious = ["house", "drifting_house"].map(|name| (name, "curious"));
    let others = [("four_rooms", "information-gain"), ("yard", "fresh-map")];
    for (name, policy) in curious.into_iter().chain(others) {
        let spec = shipped::load(name).unwrap();
        let settings = physics_trial::settings(&spec).unwrap();
        let facts = TrialFacts::new(&spec, 100, &settings, SavedSettings::default());
        let sessions = Sessions::of("trial");
        let mut whole = trial(&spec, 100, &settings, policy);
        whole.run(40.0).unwrap();
        let mut state = State::default();
        // In three parts; the second part is short.
        for end_s in [21.3, 23.0, 40.0] {
            let mut part = trial(&spec, 100, &settings, policy);
            if end_s > 22.0 {
                part.restore(&again(&state), &facts).unwrap();
            }
            part.run(end_s).unwrap();
            state = part.snapshot(&facts, &sessions)();
            if end_s == 40.0 {
                let json = |trial: &Trial| serde_json::to_string(&trial.results()).unwrap();
                assert_eq!(json(&part), json(&whole), "{name}, {policy}");
                assert!(part.robot.mapper.states() == whole.robot.mapper.states());
                assert!(state == whole.snapshot(&facts, &sessions)(), "{name}, {policy}");
            }
        }
    }
}

const GAP_S: f64 = 3.0 * 86_400.0;

/// What a run has learned, as another run with another seed reads it from a file.
fn saved(first: &mut Trial, spec: &WorldSpec, settings: &Settings) -> Trial {
    let state = learned(&mut first.robot, settings, &Sessions::of("trial"))();
    let mut second = trial(spec, 101, settings, "curious");
    restore(&again(&state), &mut second.robot, settings).unwrap();
    assert!(second.robot.mapper.states() == first.robot.mapper.states());
    second
}

/// Another start of the robot.
fn moved(spec: &WorldSpec) -> WorldSpec {
    let mut fleet = spec.fleet().clone();
    fleet.robots[spec.driven_index()].pose = pose(3.5, 4.5, 0.5);
    WorldSpec::driving(fleet, spec.driven_index()).unwrap()
}

/// Over all cells: the time in view free and blocked, and the changes in view.
fn exposure(mapper: &Mapper) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for seen in (0..mapper.frame().len()).map(|index| mapper.statistics(index)) {
        let changes = f64::from(seen.block_events) + f64::from(seen.free_events);
        [seen.watched_free, seen.watched_blocked, changes]
            .iter()
            .zip(&mut sum)
            .for_each(|(one, sum)| *sum += one);
    }
    sum
}

#[test]
fn two_sessions_add_up_with_the_time_between_as_a_gap() {
    let here = shipped::load("house").unwrap();
    let there = moved(&here);
    let settings = physics_trial::settings(&here).unwrap();
    let mut first = trial(&here, 100, &settings, "curious");
    first.run(90.0).unwrap();
    let mut alone = trial(&there, 101, &settings, "curious");
    let Trial { robot: mut both, .. } = saved(&mut first, &there, &settings);
    both.begin_session(0.0, Some(GAP_S));
    while alone.robot.mapper.time() < 90.0 {
        alone.turn().unwrap();
        both.step(alone.world.sense()).unwrap();
    }
    let (first, alone, both) = (first.robot.mapper, alone.robot.mapper, both.mapper);
    let sum = exposure(&first).into_iter().zip(exposure(&alone)).map(|(a, b)| a + b);
    for (found, sum) in exposure(&both).into_iter().zip(sum) {
        // A surface that takes several hits to become known is known from the start in the second session.
        assert!((-0.01..0.06).contains(&(found / sum - 1.0)), "{found} instead of {sum}");
    }
    // The pause is a gap, and no time between readings.
    let seen_twice =
        |&index: &usize| first.statistics(index).watched_free > 5.0 && alone.was_ever_seen(index);
    let cells: Vec<usize> = (0..here.frame.len()).filter(seen_twice).collect();
    assert!(cells.len() > 1000, "{}", cells.len());
    for index in cells {
        let seen = both.statistics(index);
        assert!(seen.unobserved >= GAP_S && (seen.period - 0.1).abs() < 0.001, "{seen:?}");
    }
}

#[test]
fn a_robot_finds_itself_in_the_map_that_it_has_saved() {
    let here = shipped::load("drifting_house").unwrap();
    let settings = physics_trial::settings(&here).unwrap();
    // The frame of the world is that of the map, so that both sessions have the same one.
    let start = |spec: &WorldSpec, seed: u64| {
        let mut world = PhysicsWorld::new(spec, seed);
        let pilot = settings.pilot(settings.agent(&Policy::default(), seed).unwrap(), seed).unwrap();
        let robot = physics_trial::robot(&settings, &mut world, None, pilot).unwrap();
        (world, robot)
    };
    let (mut world, mut robot) = start(&here, 101);
    while world.time_s() <= 150.0 {
        let turn = robot.step(world.sense()).unwrap();
        world.act(&turn.command);
    }
    let state = learned(&mut robot, &settings, &Sessions::of("trial"))();
    let (mut world, mut robot) = start(&moved(&here), 101);
    restore(&again(&state), &mut robot, &settings).unwrap();
    robot.begin_session(0.0, Some(GAP_S));
    let (mut certain, mut first_s, mut error) = (0, f64::INFINITY, 0.0_f64);
    while world.time_s() <= 20.0 {
        let turn = robot.step(world.sense()).unwrap();
        if turn.belief.is_certain() {
            certain += 1;
            first_s = first_s.min(world.time_s());
            let off = world.true_pose().inv_mul(&turn.belief.pose);
            error = error.max(off.translation.vector.norm()).max(heading_rad(&off).abs());
        }
        world.act(&turn.command);
    }
    // It finds itself within a second; fast turns make some of the 200 scans uncertain later.
    assert!(first_s < 1.0 && certain > 170 && error < 0.05, "{first_s}, {certain}, {error}");
    assert!(robot.mapper.time() >= GAP_S + 170.0);
}
