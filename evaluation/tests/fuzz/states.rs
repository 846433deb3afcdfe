//! States from a stranger: parts that were changed, with a checksum that fits. What is read of them is used, as the
//! programs use it.

use super::Random;
use agent::{Agent, Policy};
use controller::{Controller, DiffDrive};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::trial_state::TrialFacts;
use interfaces::{GridFrame, LaserReading, PoseMode};
use logs::{Log, TopicChoice};
use mapper::{Mapper, MapperSettings, ScanFilterSettings};
use nalgebra::Point2;
use robot::Autonomous;
use robot::state::{SavedMap, SavedSettings, Sessions, State};
use sim::physics::WorldSpec;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::Path;
use survey::{Forecast, LogEntry, Survey, SurveySettings};

type Trial = PhysicsTrial<Autonomous<Agent, Controller<DiffDrive>>>;

/// The states as programs write them, and what goes on with them.
pub(crate) struct States {
    /// Runs of a robot that knows its pose, and of one that localizes itself.
    trials: [(Trial, TrialFacts, State); 2],
    survey: State,
    weeks: State,
    log: Log,
}

impl States {
    pub(crate) fn new(house: &WorldSpec, log: &Path, reading: &LaserReading) -> Self {
        let log = Log::open(log, &TopicChoice::default()).unwrap();
        let trials = [(PoseMode::Exact, 60.0), (PoseMode::Localized, 8.0)];
        Self {
            trials: trials.map(|(pose, end_s)| trial(house, pose, end_s)),
            survey: survey(&log),
            weeks: weeks(reading),
            log,
        }
    }

    pub(crate) fn run(&mut self, random: &mut Random) {
        let number = random.below(self.trials.len());
        let (trial, facts, whole) = &mut self.trials[number];
        match random.below(8) {
            0 => {
                let bytes = whole.to_bytes().unwrap();
                let mutated = random.mutated(&bytes);
                assert!(mutated == bytes || State::from_bytes(&mutated).is_err(), "a damaged state was read");
            }
            1..4 => {
                let state = changed(whole, random);
                if trial.restore(&state, facts).is_ok() {
                    let end_s = trial.robot.mapper.time() + 0.3;
                    trial.run(end_s).ok();
                    drop(trial.snapshot(facts, &Sessions::of("trial"))());
                }
            }
            _ => {
                let states = [&*whole, &self.survey, &self.weeks];
                let state = changed(states[random.below(3)], random);
                foretell(&state);
                // To find the place of a log in a map takes most of the time.
                go_on(&state, &self.log, random.below(8) == 0);
            }
        }
    }
}

/// The state with one part that was changed, or with other bytes anywhere.
fn changed(whole: &State, random: &mut Random) -> State {
    let mut state = whole.clone();
    let State { map, surfaces, filter, localization, survey, run, .. } = &mut state;
    let bytes =
        [map.as_mut().map(|map| &mut map.bytes), Some(&mut localization.bytes), Some(surfaces), Some(filter)];
    let others = [survey, run].map(|part| part.as_mut().map(|part| &mut part.bytes));
    let mut parts: Vec<&mut Vec<u8>> =
        bytes.into_iter().chain(others).flatten().filter(|part| !part.is_empty()).collect();
    match random.below(8) {
        0 => {
            let mutated = random.mutated(&interfaces::to_bytes(&state));
            return interfaces::from_bytes(&mutated).unwrap_or(state);
        }
        1 => {
            if let Some(map) = &mut state.map {
                map.settings = other_settings(&map.settings, random);
            }
        }
        2 => {
            if let Some(map) = &mut state.map {
                map.epoch_s = Some(random.number());
            }
            state.sessions.iter_mut().for_each(|session| session.offset_s = random.number());
        }
        _ => {
            let part = random.below(parts.len());
            *parts[part] = random.mutated_part(parts[part]);
        }
    }
    state
}

/// The settings, whose texts were changed.
fn other_settings(settings: &SavedSettings, random: &mut Random) -> SavedSettings {
    let mut texts: Vec<(String, String)> = interfaces::from_bytes(&interfaces::to_bytes(settings)).unwrap();
    let number = random.below(texts.len());
    if let Some((_, text)) = texts.get_mut(number) {
        *text = String::from_utf8_lossy(&random.mutated_text(text.as_bytes())).into_owned();
    }
    interfaces::from_bytes(&interfaces::to_bytes(&texts)).unwrap()
}

/// Everything that `predict` computes.
fn foretell(state: &State) {
    drop(state.map.as_ref().map(|map| map.settings.fields()));
    let Ok(forecast) = Forecast::of_state(state) else { return };
    let (mapper, outlook, now_s) = (forecast.mapper(), forecast.outlook(), forecast.now_s());
    drop(black_box((forecast.map(now_s + 4000.0), forecast.masks(now_s))));
    drop(black_box((outlook.worth(), forecast.why_undated())));
    let ends =
        [mapper.frame().origin(), mapper.frame().center(mapper.frame().cell(mapper.frame().len() - 1))];
    black_box(outlook.stops(ends, 0.2, |way_m| now_s + way_m));
    for door in mapper.doors() {
        black_box((door.openings_per_hour(), door.closed.length_m(), forecast.door_at(door.closed.ends[0])));
    }
    let of_doors = mapper.doors().iter().map(|door| &door.clock);
    for clock in mapper.tiles().map(mapper::Tile::clock).chain(of_doors) {
        drop(black_box((clock.week(forecast.calendar()), clock.interval_90(now_s, forecast.calendar()))));
    }
    mapper.objects().for_each(|object| drop(black_box(object)));
    mapper.changed().for_each(|index| _ = black_box(mapper.statistics(index)));
}

/// What `map_log` does, also with one more log.
fn go_on(state: &State, log: &Log, has_log: bool) {
    let settings = SurveySettings::of(PoseMode::Exact);
    let Ok((mut survey, _)) = Survey::restored(settings, true, state) else { return };
    let places = survey.places();
    drop(black_box((survey.since(&places), survey.verdict(), survey.no_returns())));
    let number = survey.logs().len();
    let end_s = survey.logs().iter().map(|log| log.entry.offset_s + log.entry.duration_s).fold(0.0, f64::max);
    let mut entry = LogEntry::of("next".to_owned(), log, &TopicChoice::default()).unwrap();
    entry.offset_s = end_s + 1000.0;
    if has_log
        && survey.first_pass(log, entry, false, |_| ControlFlow::Continue(())).is_ok()
        && let Ok(Some(mut replay)) = survey.replay(number, log)
    {
        while !replay.is_over() && survey.turn(&mut replay).is_ok_and(|turn| turn.is_some()) {}
        let places = survey.places();
        drop(black_box(survey.since(&places)));
    }
    drop(survey.saved()());
}

fn trial(spec: &WorldSpec, pose: PoseMode, end_s: f64) -> (Trial, TrialFacts, State) {
    let mut settings = physics_trial::settings(spec).unwrap();
    (settings.pose, settings.mapper.clocks) = (pose, true);
    let agent = settings.agent(&"curious".parse::<Policy>().unwrap(), 1).unwrap();
    let pilot = settings.pilot(agent, 1).unwrap();
    let mut trial: Trial = PhysicsTrial::new(spec, 1, &settings, None, pilot).unwrap();
    trial.run(end_s).unwrap();
    let facts = TrialFacts::new(spec, 1, &settings, SavedSettings::default());
    let state = trial.snapshot(&facts, &Sessions::of("trial"))();
    (trial, facts, state)
}

fn survey(log: &Log) -> State {
    let mut survey = Survey::new(SurveySettings::of(PoseMode::Exact), true);
    for number in 0..2 {
        let mut entry = LogEntry::of(format!("log {number}"), log, &TopicChoice::default()).unwrap();
        entry.offset_s = 90_000.0 * number as f64;
        survey.first_pass(log, entry, true, |_| ControlFlow::Continue(())).unwrap();
        let mut replay = survey.replay(number, log).unwrap().unwrap();
        while !replay.is_over() {
            survey.turn(&mut replay).unwrap();
        }
    }
    survey.saved()()
}

/// A map with hours: something stands in a room at some hours of twenty days.
fn weeks(reading: &LaserReading) -> State {
    let settings =
        MapperSettings { clocks: true, time_zone: Some("UTC".to_owned()), ..MapperSettings::default() };
    let frame = GridFrame::new(Point2::new(-1.0, -1.0), 0.1, 140, 140).unwrap();
    let mut mapper = Mapper::new(&settings, frame).unwrap();
    mapper.set_epoch(1.7e9, true);
    let mut there = reading.clone();
    let beams = there.scan.ranges_m.len();
    there.scan.ranges_m[..beams / 8].iter_mut().for_each(|range_m| *range_m = range_m.min(1.0));
    let scans = [reading.clone(), there];
    for half_day in 0..40 {
        let begin_s = 43_200.0 * f64::from(half_day);
        mapper.pause(begin_s);
        for tick in 0..120 {
            let is_there = (half_day + tick / 60) % 2 == 0;
            let scan = scans[usize::from(is_there)].clone();
            mapper.update(&LaserReading { time_s: begin_s + f64::from(tick), ..scan }).unwrap();
        }
    }
    let map = SavedMap::of(mapper, &ScanFilterSettings::default());
    State { build: robot::BUILD.to_owned(), map: Some(map), ..State::default() }
}
