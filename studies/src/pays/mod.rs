//! Where curiosity pays: buildings of rooms in which things come and go, and what a strategy gains in them by choosing where to look.
//!
//! The same [`Place`] is an [`IdealWorld`] (views and travel, some thousand times faster than real time) and a physics world with a
//! laser; robots, maps and strategies are those of the product in both. The ideal world predicts what the physics world measures: the
//! things of both change at the same times.

mod figure;
mod ideal;
mod oracle;
mod place;
mod table;

pub use figure::figure;
pub use ideal::IdealWorld;
pub use oracle::Oracle;
pub use place::{Item, Place, Setting};
pub use table::{Ratio, Row, compare, ratio, table};

use agent::{Agent, AgentSettings, BestTrip, Policy};
use anyhow::Context;
use controller::{CellDrive, Controller};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::scheduled_things::presence;
use interfaces::{Purpose, RandomStream};
use mapper::{EstimatorChoice, Mapper, MapperSettings};
use robot::{Autonomous, DaySettings, ExactPoses, PatrolDay, Pilot, Robot};
use sim::physics::PatrolDaySpec;

/// What was learned in the first hour judges nothing, s.
const FROM_S: f64 = 3600.0;
/// The time from one comparison with the truth to the next, s.
const EVERY_S: f64 = 10.0;
/// How long a robot that charges is on patrol, s.
const BATTERY_S: f64 = 300.0;
/// The longest local exploration, steps.
const LOCAL_STEPS: u32 = 42;

/// The result of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The Brier score of “it is there” over all things at all times after the first hour.
    pub brier: f64,
    /// The way of the robot, m: the distances from where it was ten seconds before.
    pub way_m: f64,
}

/// The Brier score over all things at all times after the first hour.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    due: u64,
    sum: f64,
    count: f64,
}

impl Score {
    fn is_due(&mut self, time_s: f64) -> bool {
        let is_due = time_s + 1e-6 >= FROM_S + self.due as f64 * EVERY_S;
        self.due += u64::from(is_due);
        is_due
    }

    fn add<'a>(&mut self, mapper: &Mapper, ahead_s: f64, things: impl Iterator<Item = (&'a [usize], bool)>) {
        for (cells, is_there) in things {
            let apart = presence(mapper, cells, ahead_s) - f64::from(u8::from(is_there));
            self.sum += apart * apart;
            self.count += 1.0;
        }
    }
}

/// The policy of a name: one of the product, or `oracle`, which knows the rates of these things by their cells.
///
/// # Errors
///
/// When there is no policy with this name.
fn policy(name: &str, place: &Place, cells: Vec<Vec<usize>>) -> anyhow::Result<Policy> {
    if name != "oracle" {
        return Ok(name.parse::<Policy>()?);
    }
    let stays = place.things.iter().map(|thing| thing.stays_s);
    let oracle = Oracle { things: cells.into_iter().zip(stays).collect() };
    Ok(Policy::single("oracle", "what fresh-map does, with true rates", move |settings| {
        BestTrip::new(oracle.clone(), settings)
    }))
}

/// A run in the ideal world: the prediction.
///
/// # Errors
///
/// When there is no such strategy.
pub fn predict(place: &Place, strategy: &str, seed: u64, hours: f64) -> anyhow::Result<Outcome> {
    let mut world = IdealWorld::new(place, seed)?;
    let policy = policy(strategy, place, world.things().map(<[usize]>::to_vec).collect())?;
    let agent = AgentSettings { sensor_radius_m: place.setting.laser_m, ..AgentSettings::default() };
    let agent = Agent::new(&agent, &policy, RandomStream::new(seed, Purpose::Agent))?;
    let stream = RandomStream::new(seed, Purpose::Controller);
    let pilot = Autonomous::new(agent, Controller::new(CellDrive, LOCAL_STEPS, stream));
    let day = DaySettings {
        dock: world.position(),
        battery_s: BATTERY_S,
        share: place.setting.duty,
        busy: calendar::Hours::never(),
        starts_s: 0.0,
    };
    let settings = MapperSettings { estimator: shared_prior()?, ..MapperSettings::default() };
    let mapper = Mapper::new(&settings, *world.frame())?;
    let mut robot = Robot::new(Box::new(ExactPoses), mapper, PatrolDay::new(pilot, day));
    let (mut score, mut command, mut way_m) = (Score::default(), None, 0.0);
    let mut before = world.position();
    while world.time_s() < hours * 3600.0 {
        if robot
            .pilot
            .battery()
            .rests_until_s()
            .is_some_and(|until_s| until_s > world.time_s() + ideal::STEP_S)
        {
            world.pass();
        } else {
            robot::turn(&mut world, &mut robot, &mut command)?;
            robot.pilot.take_messages();
        }
        if world.time_s() % EVERY_S < 1e-6 {
            way_m += (world.position() - std::mem::replace(&mut before, world.position())).norm();
        }
        if score.is_due(world.time_s()) {
            let ahead_s = world.time_s() - robot.mapper.time();
            let are_there = world.are_there();
            score.add(&robot.mapper, ahead_s, world.things().zip(are_there));
        }
    }
    Ok(Outcome { brier: score.sum / score.count, way_m })
}

fn shared_prior() -> anyhow::Result<EstimatorChoice> {
    "shared-prior".parse().map_err(anyhow::Error::msg)
}

/// A run in the physics world: the measurement.
///
/// # Errors
///
/// When there is no such strategy.
pub fn measure(place: &Place, strategy: &str, seed: u64, hours: f64) -> anyhow::Result<Outcome> {
    let patrol = PatrolDaySpec { battery_s: BATTERY_S, ..PatrolDaySpec::of_share(place.setting.duty) };
    let spec = place.world()?.with_patrol(patrol);
    let settings = physics_trial::settings(&spec)?;
    let cells: Vec<Vec<usize>> = spec.things().iter().map(|thing| thing.places[0].clone()).collect();
    let agent = settings.agent(&policy(strategy, place, cells.clone())?, seed)?;
    let day = physics_trial::day(&spec).context("the robot has no patrol")?;
    let pilot = PatrolDay::new(settings.pilot(agent, seed)?, day);
    let mut trial = PhysicsTrial::new(&spec, seed, &settings, None, pilot)?.on_battery();
    let things = spec.things();
    let (mut score, mut way_m) = (Score::default(), 0.0);
    let position = |trial: &PhysicsTrial<_>| trial.world.true_pose().translation.vector;
    let mut time_s = 0.0;
    while time_s < hours * 3600.0 {
        let before = position(&trial);
        time_s += EVERY_S;
        trial.run(time_s)?;
        way_m += (position(&trial) - before).norm();
        if score.is_due(trial.world.time_s()) {
            let ahead_s = (trial.world.time_s() - trial.robot.mapper.time()).max(0.0);
            let is_there = |thing| trial.world.fleet().place_of(thing).is_some();
            let states = things.iter().zip(&cells).map(|(thing, cells)| (cells.as_slice(), is_there(thing)));
            score.add(&trial.robot.mapper, ahead_s, states);
        }
    }
    Ok(Outcome { brier: score.sum / score.count, way_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::World;
    use sim::physics::PhysicsWorld;

    const SETTING: Setting =
        Setting { rooms: 3, side_m: 4.0, laser_m: 3.0, things: 2, alike: true, spread: 2.0, duty: 1.0 };

    #[test]
    fn things_change_at_the_same_times_in_both_worlds() {
        let place = Place::generate(SETTING, 4);
        let spec = place.world().unwrap();
        let (mut ideal, mut physics) = (IdealWorld::new(&place, 9).unwrap(), PhysicsWorld::new(&spec, 9));
        let things = spec.things();
        assert!(things.len() == place.things.len() && things.len() == ideal.things().count());
        let mut changes = 0;
        let mut before = ideal.are_there();
        for _ in 0..1200 {
            ideal.pass();
            while physics.time_s() < ideal.time_s() - 1e-6 {
                physics.act(&interfaces::Twist::default());
            }
            let now = ideal.are_there();
            let in_physics: Vec<bool> =
                things.iter().map(|thing| physics.fleet().place_of(thing).is_some()).collect();
            assert_eq!(now, in_physics, "at {} s", ideal.time_s());
            changes += usize::from(now != before);
            before = now;
        }
        assert!(changes > 3, "{changes}");
        let [first, second] = [place.things[0], place.things[1]];
        assert!(first.room == second.room && first.stays_s == second.stays_s, "alike within a room");
    }

    #[test]
    fn who_knows_the_rates_is_better_than_who_looks_everywhere() {
        let place = Place::generate(Setting { rooms: 4, ..SETTING }, 3);
        let brier = |strategy: &str| predict(&place, strategy, 1, 2.0).unwrap().brier;
        let [oracle, random] = ["oracle", "random"].map(brier);
        assert!(oracle < 0.9 * random, "{oracle} {random}");
        assert!(predict(&place, "oracel", 1, 2.0).is_err());
    }
}
