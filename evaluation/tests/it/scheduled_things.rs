//! The predicted map is compared with the things of a calendar at all times: also while the robot rests.

use agent::{Agent, Policy};
use controller::{Controller, DiffDrive};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::scheduled_things::ScheduledThings;
use mapper::Mapper;
use robot::PatrolDay;
use sim::physics::{PhysicsWorld, WorldSpec};
use std::collections::BTreeSet;

/// The door closes within seconds after 2 hours and after 8 hours, and opens after 4 hours: the world starts at 7:00.
const SCHEDULE: &str = "hours = [\"Mon 9:00-11:00\", \"Mon 15:00-24:00\"]\nfree_s = 1.0\nblocked_s = 1e9\n\
                        quiet_free_s = 1e9\nquiet_blocked_s = 1.0\nstarts_blocked = false\n";
/// The minutes of 10 hours, from the start on, and those in which the door is open.
const MINUTES: usize = 601;

/// Two rooms of the same size, and a door between them with this schedule; the robot is on patrol for a twentieth of the time.
fn world() -> WorldSpec {
    let page = include_str!("../../../docs/worlds.md");
    let begin = page.find("name = \"two rooms\"").unwrap();
    let text = &page[begin..begin + page[begin..].find("```").unwrap()];
    let (before, rest) = text.split_once("[obstacle.schedule]").unwrap();
    let (_, robot) = rest.split_once("[[robot]]").unwrap();
    let robot = robot.replace("beams = 360", "beams = 90").replace("Wed", "Sun");
    let text = format!("{before}[obstacle.schedule]\n{SCHEDULE}[[robot]]{robot}");
    worldfile::physics::parse_world("rooms.toml", &text).unwrap()
}

/// A map that was never updated predicts ½ for the door: the scores follow from the events alone. The large steps of a rest are not
/// changed by the comparison.
#[test]
fn an_empty_map_has_the_scores_that_follow_from_the_events() {
    let spec = world();
    let mapper = Mapper::new(&physics_trial::settings(&spec).unwrap().mapper, spec.frame).unwrap();
    let mut world = PhysicsWorld::new(&spec, 1);
    let mut unwatched = world.clone();
    let mut things = ScheduledThings::default();
    things.sample(&world, &mapper);
    let mut times_s = Vec::new();
    world.rest_watched(36_000.0, ScheduledThings::EVERY_S, |world| {
        times_s.push(world.time_s());
        things.sample(world, &mapper);
    });
    assert_eq!(times_s.len(), MINUTES - 1);
    assert!(times_s.iter().zip(1..).all(|(time_s, minute)| (time_s - 60.0 * f64::from(minute)).abs() < 1e-6));
    unwatched.rest(36_000.0);
    assert!(world.snapshot().into_bytes() == unwatched.snapshot().into_bytes());
    let scores = things.scores().unwrap();
    assert_eq!((scores.things, scores.samples as usize), (1, MINUTES));
    assert_eq!(scores.fresh.brier, 0.25);
    // Nobody knows: each of the three changes is missed, after 120, 240 and 120 minutes.
    assert_eq!((scores.fresh.lasting_changes, scores.fresh.missed), (3, 1.0));
    let minutes = scores.fresh.detection_delay_s.map(|delay_s| delay_s / 60.0);
    assert!((minutes[0] - 120.0).abs() <= 1.0 && (minutes[1] - 240.0).abs() <= 1.0, "{minutes:?}");
}

/// A robot on patrol in this world.
fn patrol() -> PhysicsTrial<PatrolDay<Agent, Controller<DiffDrive>>> {
    let spec = world();
    let settings = physics_trial::settings(&spec).unwrap();
    let pilot = settings.pilot(settings.agent(&Policy::default(), 1).unwrap(), 1).unwrap();
    let pilot = PatrolDay::new(pilot, physics_trial::day(&spec).unwrap());
    PhysicsTrial::new(&spec, 1, &settings, None, pilot).unwrap().on_battery()
}

/// A robot that rests for most of the time is compared as often as one that never rests.
#[test]
fn a_resting_robot_is_scored_every_minute() {
    let mut trial = patrol();
    let mut seen = BTreeSet::new();
    while trial.turn().unwrap().reading.time_s < 36_000.0 {
        seen.insert((trial.world.time_s() / 60.0) as u64);
    }
    let results = trial.results();
    let scores = results.scheduled.unwrap();
    let minutes = (trial.world.time_s() / 60.0) as u64 + 1;
    assert_eq!(scores.samples, minutes);
    // Minutes with a reading are few.
    assert!(seen.len() < minutes as usize / 4, "readings in {} minutes", seen.len());
    // It leaves its dock about every 100 minutes, and sees the door then.
    assert_eq!((scores.fresh.lasting_changes, scores.fresh.missed), (3, 0.0));
    let late_s = scores.fresh.detection_delay_s[1];
    assert!(late_s > 0.0 && late_s < 6600.0, "{late_s}");
}

/// Strategies are compared over the same time, whenever the robot rests.
#[test]
fn a_run_can_end_exactly_in_a_rest() {
    for end_s in [7200.0, 20_000.0, 36_000.0] {
        let mut trial = patrol();
        trial.run(end_s).unwrap();
        assert!((trial.world.time_s() - end_s).abs() < 0.2, "{} s", trial.world.time_s());
        let scores = trial.results().scheduled.unwrap();
        assert_eq!(scores.samples, (end_s / 60.0) as u64 + 1);
    }
}
