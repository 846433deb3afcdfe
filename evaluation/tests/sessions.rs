//! What a robot has learned survives: a run that goes on from its state, and two sessions in one place.

use agent::{Agent, Policy};
use controller::DiffDrive;
use evaluation::physics_trial::{PhysicsSettings, PhysicsTrial, PoseChoice};
use evaluation::trial_state::TrialFacts;
use interfaces::{LaserReading, Twist, World, heading_rad, pose};
use localizer::PoseState;
use mapper::{Mapper, ReadingError};
use robot::state::{Facts, LearnedFacts, State};
use robot::{Autonomous, Belief, Session, explore};
use sim::physics::{PhysicsWorld, WorldSpec};
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
    State::from_bytes(&state.to_bytes().unwrap()).unwrap()
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

fn learned_facts(spec: &WorldSpec, settings: &PhysicsSettings) -> LearnedFacts {
    let localizer = (settings.pose == PoseChoice::Localized).then_some(&settings.localizer);
    LearnedFacts::new(&settings.mapper, &spec.frame, settings.pose.name(), localizer)
}

/// What a run has learned, as another run with another seed reads it from a file.
fn saved(first: &mut Trial, spec: &WorldSpec, settings: &PhysicsSettings) -> Trial {
    let facts = learned_facts(spec, settings);
    let state = facts.snapshot(&first.mapper, first.localization.as_mut()).added_to(State::default());
    let mut second = trial(spec, 101, settings, "curious");
    facts.restore(&again(&state), &mut second.mapper, second.localization.as_mut()).unwrap();
    assert!(second.mapper.states() == first.mapper.states());
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
    let (mut alone, mut readings) = (trial(&there, 101, &settings, "curious"), Vec::new());
    let recorded = alone.run_with(|_, reading, _, _, _| -> Result<_, ReadingError> {
        readings.push(reading.clone());
        Ok(if reading.time_s >= 90.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    });
    recorded.unwrap();

    let Trial { mut localization, mapper: mut both, .. } = saved(&mut first, &there, &settings);
    let session = Session::next(localization.as_mut(), &mut both, readings[0].time_s, Some(GAP_S));
    for reading in readings {
        let posed = localization.localize(session.shifted(reading), &mut both);
        both.update(&posed.reading).unwrap();
    }
    let sum = exposure(&first.mapper).into_iter().zip(exposure(&alone.mapper)).map(|(a, b)| a + b);
    for (found, sum) in exposure(&both).into_iter().zip(sum) {
        // A surface that takes several hits to become known is known from the start in the second session.
        assert!((-0.01..0.06).contains(&(found / sum - 1.0)), "{found} instead of {sum}");
    }
    // The pause is a gap, and no time between readings.
    let seen_twice = |&index: &usize| {
        first.mapper.statistics(index).watched_free > 5.0 && alone.mapper.was_ever_seen(index)
    };
    let cells: Vec<usize> = (0..here.frame.len()).filter(seen_twice).collect();
    assert!(cells.len() > 1000, "{}", cells.len());
    for index in cells {
        let seen = both.statistics(index);
        assert!(seen.unobserved >= GAP_S && (seen.period - 0.1).abs() < 0.001, "{seen:?}");
    }
}

#[test]
fn a_robot_finds_itself_in_the_map_that_it_has_saved() {
    let here = spec("drifting_house");
    let settings = PhysicsSettings::of(&here).unwrap();
    let mut first = trial(&here, 100, &settings, "curious");
    first.run(150.0).unwrap();
    let Trial { world, mut localization, mut mapper, mut pilot, .. } =
        saved(&mut first, &moved(&here), &settings);
    let session = Session::next(localization.as_mut(), &mut mapper, 0.0, Some(GAP_S));
    let mut world = Later { world, session };
    let (mut certain, mut first_s, mut error) = (0, f64::INFINITY, 0.0_f64);
    let step =
        |world: &Later, reading: &LaserReading, belief: &Belief, _: &mut _| -> Result<_, ReadingError> {
            if belief.estimate.is_some_and(|estimate| estimate.state == PoseState::Tracking) {
                certain += 1;
                first_s = first_s.min(reading.time_s - session.offset_s());
                let off = world.world.true_pose().inv_mul(belief.pose);
                error = error.max(off.translation.vector.norm()).max(heading_rad(&off).abs());
            }
            let is_over = reading.time_s >= session.offset_s() + 20.0;
            Ok(if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        };
    explore(&mut world, localization.as_mut(), &mut mapper, &mut pilot, step).unwrap();
    // It finds itself within a second; fast turns make some of the 200 scans uncertain later.
    assert!(first_s < 1.0 && certain > 170 && error < 0.05, "{first_s}, {certain}, {error}");
    assert!(mapper.time() >= GAP_S + 170.0);
}
