//! What a robot has learned survives: a run that goes on from its state, and two sessions in one place.

use agent::{Agent, Policy};
use controller::DiffDrive;
use evaluation::physics_trial::{PhysicsSettings, PhysicsTrial, PoseChoice};
use evaluation::trial_state::TrialFacts;
use interfaces::{LaserReading, Twist, World, heading_rad, pose};
use localizer::PoseState;
use mapper::{Mapper, ReadingError};
use robot::{Autonomous, Session, explore};
use sim::physics::{PhysicsWorld, WorldSpec};
use state::{Facts, MindFacts, State};
use std::ops::ControlFlow;

type Trial = PhysicsTrial<Autonomous<Agent, DiffDrive>>;

fn spec(name: &str) -> WorldSpec {
    let file = format!("{}/../worlds/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    worldfile::physics::parse_world(name, &std::fs::read_to_string(file).unwrap()).unwrap()
}

fn trial(spec: &WorldSpec, seed: u64, settings: &PhysicsSettings, policy: &str) -> Trial {
    let agent = settings.agent(&policy.parse::<Policy>().unwrap(), seed).unwrap();
    PhysicsTrial::new(spec, seed, settings, None, settings.pilot(agent, seed).unwrap()).unwrap()
}

/// The state after it was written and read.
fn again(state: &State) -> State {
    State::from_bytes(&state.to_bytes()).unwrap()
}

#[test]
fn a_run_that_goes_on_equals_one_that_was_not_interrupted() {
    let policies = [
        ("house", "curious"),
        ("drifting_house", "progress"),
        ("four_rooms", "information-gain"),
        ("yard", "frontier"),
    ];
    for (name, policy) in policies {
        let spec = spec(name);
        let settings = PhysicsSettings::of(&spec).unwrap();
        let facts = TrialFacts::new(&spec, 100, &settings, Facts::default());
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
            state = part.snapshot(&facts).into_state();
            if end_s == 40.0 {
                let json = |trial: &Trial| serde_json::to_string(&trial.results()).unwrap();
                assert_eq!(json(&part), json(&whole), "{name}, {policy}");
                assert!(part.mapper.states() == whole.mapper.states());
                assert!(state == whole.snapshot(&facts).into_state(), "{name}, {policy}");
            }
        }
    }
}

/// A world whose clock starts after the session before.
struct Later {
    world: PhysicsWorld,
    session: Session,
}

impl World for Later {
    type Reading = LaserReading;
    type Command = Twist;

    fn sense(&mut self) -> LaserReading {
        self.session.shifted(self.world.sense())
    }

    fn poses_are_exact(&self) -> bool {
        self.world.poses_are_exact()
    }

    fn act(&mut self, command: &Twist) {
        self.world.act(command);
    }
}

const GAP_S: f64 = 3.0 * 86_400.0;

/// A session from another start and with another seed, in the place that a first session has learned. Returns the mapper
/// of this session, and the share of the readings with a certain pose, and the largest error of these poses (m, rad).
fn second_session(
    spec: &WorldSpec,
    settings: &PhysicsSettings,
    first: &mut Trial,
    length_s: f64,
) -> (Mapper, f64, f64) {
    let facts = MindFacts::new(
        &settings.mapper,
        &spec.frame,
        settings.pose.name(),
        (settings.pose == PoseChoice::Localized).then_some(&settings.localizer),
    );
    let saved = facts.snapshot(&first.mapper, first.localization.as_mut()).added_to(State::default());
    let Trial { world, mut localization, mut mapper, mut pilot, .. } = trial(spec, 101, settings, "curious");
    facts.restore(&again(&saved), &mut mapper, localization.as_mut()).unwrap();
    assert!(mapper.states() == first.mapper.states());
    let session = Session::next(localization.as_mut(), &mut mapper, 0.0, Some(GAP_S));
    let (end_s, mut world) = (session.offset_s() + length_s, Later { world, session });
    let (mut certain, mut all, mut error) = (0.0, 0.0, 0.0_f64);
    let localization = localization.as_mut();
    explore(
        &mut world,
        localization,
        &mut mapper,
        &mut pilot,
        |world, reading, belief, _| -> Result<_, ReadingError> {
            all += 1.0;
            if belief.estimate.is_none_or(|estimate| estimate.state == PoseState::Tracking) {
                certain += 1.0;
                let off = world.world.true_pose().inv_mul(belief.pose);
                error = error.max(off.translation.vector.norm()).max(heading_rad(&off).abs());
            }
            Ok(if reading.time_s >= end_s { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        },
    )
    .unwrap();
    (mapper, certain / all, error)
}

/// Another start of the robot.
fn moved(spec: &WorldSpec) -> WorldSpec {
    let mut fleet = spec.fleet().clone();
    fleet.robots[spec.driven_index()].pose = pose(9.5, 3.0, 2.0);
    WorldSpec::driving(fleet, spec.driven_index()).unwrap()
}

/// Over all cells: the time in view free and blocked, and the changes in view.
fn exposure(mapper: &Mapper) -> [f64; 3] {
    (0..mapper.frame().len()).map(|index| mapper.statistics(index)).fold(
        [0.0; 3],
        |[free, blocked, events], seen| {
            let changes = f64::from(seen.block_events) + f64::from(seen.free_events);
            [free + seen.watched_free, blocked + seen.watched_blocked, events + changes]
        },
    )
}

#[test]
fn two_sessions_add_up_with_the_time_between_as_a_gap() {
    let here = spec("house");
    let there = moved(&here);
    let settings = PhysicsSettings::of(&here).unwrap();
    let mut first = trial(&here, 100, &settings, "curious");
    first.run(90.0).unwrap();
    let mut alone = trial(&there, 101, &settings, "curious");
    alone.run(90.0).unwrap();
    let (both, ..) = second_session(&there, &settings, &mut first, 90.0);
    let sum: Vec<f64> =
        exposure(&first.mapper).into_iter().zip(exposure(&alone.mapper)).map(|(a, b)| a + b).collect();
    for (found, sum) in exposure(&both).into_iter().zip(&sum) {
        assert!((found / sum - 1.0).abs() < 0.1, "{:?} instead of {sum:?}", exposure(&both));
    }
    // The pause is a gap, and no time between readings.
    let mut seen_in_both = 0;
    for index in 0..here.frame.len() {
        let [one, two] = [first.mapper.statistics(index), both.statistics(index)];
        if first.mapper.was_ever_seen(index) && two.last_seen > GAP_S {
            seen_in_both += 1;
            assert!(two.unobserved >= GAP_S && two.first_seen <= one.last_seen.max(90.0), "{two:?}");
            assert!((two.period - 0.1).abs() < 0.005, "{two:?}");
        }
    }
    assert!(seen_in_both > 1000, "{seen_in_both}");
}

#[test]
fn a_robot_finds_itself_in_the_map_that_it_has_saved() {
    let here = spec("drifting_house");
    let settings = PhysicsSettings::of(&here).unwrap();
    let mut first = trial(&here, 100, &settings, "curious");
    first.run(300.0).unwrap();
    let (both, certain, error) = second_session(&moved(&here), &settings, &mut first, 60.0);
    assert!(certain > 0.8 && error < 0.1, "{certain}, {error}");
    assert!(both.time() > GAP_S + 300.0);
}
