//! Surveys that are saved and go on, against those that were never interrupted.

mod doubts;

use super::{SavedSurvey, Survey};
use crate::settings::SurveySettings;
use crate::surveyed_log::LogEntry;
use crate::tests::{bag_from, drive, exact, learn};
use interfaces::{GridFrame, LaserReading, PoseMode};
use logs::{Log, TopicChoice};
use mapper::{NoReturn, ScanFilterSettings};
use nalgebra::{Isometry2, Point2};
use robot::state::{Sessions, State, learned, restore};
use robot::{NoPilot, Settings, Source};
use std::ops::ControlFlow;
use std::path::Path;

const DAY_S: f64 = 86_400.0;

/// A bag with these readings, recorded some days after the first log.
fn bag(folder: &Path, name: &str, readings: &[LaserReading], days: f64) -> Log {
    bag_from(&folder.join(name), readings, 1e9 + days * DAY_S - readings[0].time_s)
}

fn settings() -> SurveySettings {
    SurveySettings { resolution_m: 0.1, ..SurveySettings::of(PoseMode::Localized) }
}

fn entry(log: &Log, name: &str, days: f64) -> LogEntry {
    let entry = LogEntry::of(name.to_owned(), log, &TopicChoice::default()).unwrap();
    LogEntry { offset_s: days * DAY_S, content: log.content_hash().unwrap(), ..entry }
}

fn add(survey: &mut Survey, log: &Log, name: &str, days: f64) {
    survey.first_pass(log, entry(log, name, days), true, |_| ControlFlow::Continue(())).unwrap();
}

fn restored(survey: Survey) -> Survey {
    let state = survey.saved()();
    Survey::restored(settings(), true, &state).unwrap().0
}

#[test]
fn a_survey_that_is_saved_and_goes_on_equals_one_that_was_never_interrupted() {
    let (readings, _) = drive(2, 120.0);
    let folder = tempfile::tempdir().unwrap();
    // On Tuesday, the robot sees more of the house.
    let monday = bag(folder.path(), "monday", &readings[..100], 0.0);
    let tuesday = bag(folder.path(), "tuesday", &readings[50..], 1.0);

    let mut whole = Survey::new(settings(), true);
    add(&mut whole, &monday, "monday", 0.0);
    let place = whole.place.clone().unwrap();
    add(&mut whole, &tuesday, "tuesday", 1.0);
    assert!(learn(&mut whole, 0, &monday, usize::MAX));
    let small = *whole.mapper().unwrap().frame();
    assert!(learn(&mut whole, 1, &tuesday, usize::MAX));
    assert!(whole.mapper().unwrap().frame().len() > small.len());
    assert_eq!(*whole.mapper().unwrap().frame(), whole.frame_of(1).unwrap());
    let whole_bytes = whole.saved()();

    // A day later, and in parts.
    for parts in [usize::MAX, 170] {
        let mut survey = Survey::new(settings(), true);
        for (number, (log, name)) in [(&monday, "monday"), (&tuesday, "tuesday")].into_iter().enumerate() {
            add(&mut survey, log, name, number as f64);
            survey = restored(survey);
            while !learn(&mut survey, number, log, parts) {
                survey = restored(survey);
            }
            survey = restored(survey);
        }
        assert!(survey.saved()() == whole_bytes, "{parts} readings at once");
    }
    // The place in which later logs find theirs is the same, too.
    let saved = place.clone().snapshot();
    let again = localizer::KnownPlace::restored(&saved).unwrap();
    assert!(again.snapshot() == saved);

    // Without the poses, the sums stay.
    let travelled = whole.logs()[1].travelled;
    whole.forget_poses();
    assert_eq!((whole.logs()[1].travelled, whole.logs()[1].poses().count()), (travelled, 0));
    assert!(travelled.length_m > 5.0 && travelled.duration_s > 100.0, "{travelled:?}");
    let [before, after] = [whole_bytes, whole.saved()()]
        .map(|state| interfaces::to_bytes(&SavedSurvey::of(&state).unwrap().logs).len());
    assert!(after < 2000 && before > 10 * after, "{before} and {after} bytes");
}

#[test]
fn a_map_that_grows_is_the_map_of_the_large_frame() {
    let (readings, truth) = drive(3, 60.0);
    let folder = tempfile::tempdir().unwrap();
    let exact = exact(&readings, &truth);
    let logs = [bag(folder.path(), "a", &exact[..100], 0.0), bag(folder.path(), "b", &exact[100..], 1.0)];
    let settings = SurveySettings { resolution_m: 0.1, ..SurveySettings::of(PoseMode::Exact) };
    let surveyed = || {
        let mut survey = Survey::new(settings.clone(), true);
        for (number, log) in logs.iter().enumerate() {
            let entry = entry(log, "log", number as f64);
            survey.first_pass(log, entry, false, |_| ControlFlow::Continue(())).unwrap();
        }
        survey
    };
    // The same in the large frame from the start.
    let (mut survey, mut large) = (surveyed(), surveyed());
    large.logs[0].frame = survey.frame_of(1).unwrap();
    for survey in [&mut survey, &mut large] {
        logs.iter().enumerate().for_each(|(number, log)| assert!(learn(survey, number, log, usize::MAX)));
    }
    assert!(survey.logs[0].frame.len() < large.logs[0].frame.len());
    let [grown, large] = [survey.mapper().unwrap(), large.mapper().unwrap()];
    assert!(grown.states() == large.states());
    for index in 0..grown.frame().len() {
        assert_eq!(grown.statistics(index), large.statistics(index));
        assert_eq!(grown.is_candidate(index), large.is_candidate(index));
    }
}

#[test]
fn a_log_with_a_silent_hour_shows_what_two_logs_show() {
    const HOUR_S: f64 = 3600.0;
    let (readings, truth) = drive(3, 40.0);
    let folder = tempfile::tempdir().unwrap();
    let mut early = exact(&readings[..200], &truth);
    early.iter_mut().for_each(|reading| reading.velocities.clear());
    let mut late = early.clone();
    late.iter_mut().for_each(|reading| reading.time_s += HOUR_S);
    let filter = ScanFilterSettings { no_return: NoReturn::Free, ..ScanFilterSettings::default() };
    let settings = SurveySettings { resolution_m: 0.1, filter, ..SurveySettings::of(PoseMode::Exact) };
    let surveyed = |logs: &[(Log, f64)]| {
        let mut survey = Survey::new(settings.clone(), false);
        for (number, (log, days)) in logs.iter().enumerate() {
            let entry = entry(log, "log", *days);
            survey.first_pass(log, entry, false, |_| ControlFlow::Continue(())).unwrap();
            assert!(learn(&mut survey, number, log, usize::MAX));
        }
        survey
    };
    let whole = [&early[..], &late].concat();
    let one = surveyed(&[(bag(folder.path(), "one", &whole, 0.0), 0.0)]);
    let days = HOUR_S / DAY_S;
    let two = surveyed(&[
        (bag(folder.path(), "early", &early, 0.0), 0.0),
        (bag(folder.path(), "late", &late, days), days),
    ]);
    let note = "the laser was silent once for more than 8 s, 3580 s in all: this time counts as not observed";
    assert_eq!(one.logs()[0].entry.notes, [note]);
    assert!(two.logs().iter().all(|log| log.entry.notes.is_empty()));
    let [one, two] = [&one, &two].map(|survey| survey.mapper().unwrap());
    assert_eq!(one.frame(), two.frame());
    let mut longest_s = 0.0_f64;
    for index in 0..one.frame().len() {
        let [one, two] = [one, two].map(|mapper| mapper.statistics(index));
        assert!((one.observed() - two.observed()).abs() < 1e-3, "cell {index}: {one:?}, {two:?}");
        assert!((one.unobserved - two.unobserved).abs() < 1e-3, "cell {index}: {one:?}, {two:?}");
        longest_s = longest_s.max(one.observed());
    }
    assert!((10.0..45.0).contains(&longest_s), "{longest_s} s");
}

#[test]
fn a_log_that_was_not_learned_is_forgotten() {
    let (readings, _) = drive(2, 30.0);
    let folder = tempfile::tempdir().unwrap();
    let log = bag(folder.path(), "a", &readings, 0.0);
    let mut survey = Survey::new(settings(), true);
    add(&mut survey, &log, "a", 0.0);
    assert!(survey.place.is_some() && survey.mapper().is_none());
    survey.forget_from(0);
    assert!(survey.place.is_none() && survey.logs().is_empty());
}

#[test]
fn other_bytes_are_no_survey() {
    let (readings, _) = drive(2, 20.0);
    let folder = tempfile::tempdir().unwrap();
    let log = bag(folder.path(), "a", &readings, 0.0);
    let mut survey = Survey::new(settings(), true);
    add(&mut survey, &log, "a", 0.0);
    learn(&mut survey, 0, &log, usize::MAX);
    let whole = survey.saved()();
    let is_read = |change: &dyn Fn(&mut State)| {
        let mut state = whole.clone();
        change(&mut state);
        Survey::restored(settings(), true, &state).is_ok()
    };
    assert!(is_read(&|_| {}));
    let (map, of_survey) = (&whole.map.as_ref().unwrap().bytes, &whole.survey.as_ref().unwrap().bytes);
    for share in [0.0, 0.01, 0.5, 0.99] {
        let cut = |bytes: &[u8]| bytes[..(share * bytes.len() as f64) as usize].to_vec();
        assert!(!is_read(&|state| state.map.as_mut().unwrap().bytes = cut(map)), "{share}");
        assert!(!is_read(&|state| state.survey.as_mut().unwrap().bytes = cut(of_survey)), "{share}");
    }
}

/// `map_log` maps a place, a robot finds itself in the map and goes on, and `map_log` adds another log.
#[test]
fn a_robot_goes_on_in_the_map_of_a_survey_and_the_survey_in_that_of_the_robot() {
    let (readings, _) = drive(2, 120.0);
    let folder = tempfile::tempdir().unwrap();
    let monday = bag(folder.path(), "monday", &readings, 0.0);
    let mut survey = Survey::new(settings(), true);
    add(&mut survey, &monday, "monday", 0.0);
    learn(&mut survey, 0, &monday, usize::MAX);
    let again = |state: State| State::from_bytes(&state.to_bytes().unwrap()).unwrap();
    let state = again(survey.saved()());

    let mut live = Settings::of(&Source { cell_m: 0.1, ..Source::default() });
    live.mapper.max_gap = 7.0;
    let own = GridFrame::new(Point2::new(-20.0, -20.0), 0.1, 400, 400).unwrap();
    let frame = state.map.as_ref().unwrap().frame.union(&own).unwrap();
    let mut robot = live.robot(frame, None, Isometry2::identity(), NoPilot).unwrap();
    let note = restore(&state, &mut robot, &live).unwrap().unwrap();
    assert!(note.contains("mapper.max_gap = `8.0`"), "{note}");
    let mut sessions = Sessions::of("curious_node");
    sessions.go_on(&state, &robot.mapper);
    let before = robot.mapper.readings();
    robot.begin_session(readings[0].time_s, Some(DAY_S));
    let is_certain = |reading: &&LaserReading| robot.step((*reading).clone()).unwrap().belief.is_certain();
    let (certain, count) = (readings.iter().filter(is_certain).count(), readings.len());
    assert!(certain > count / 2 && robot.mapper.readings() > before, "{certain} of {count}");
    let state = again(State { survey: state.survey, ..learned(&mut robot, &live, &sessions)() });
    let forecast = crate::Forecast::of_state(&state).unwrap();
    assert!(forecast.why_undated().is_none() && forecast.now_s() > 1e9 + DAY_S);
    assert_eq!(forecast.mapper().states(), robot.mapper.states());
    let names: Vec<&str> = state.sessions.iter().map(|session| session.name.as_str()).collect();
    assert_eq!(names, ["monday", "curious_node 2"]);

    let (mut survey, _) = Survey::restored(settings(), true, &state).unwrap();
    assert_eq!(survey.logs().len(), 2);
    let friday = bag(folder.path(), "friday", &readings, 4.0);
    add(&mut survey, &friday, "friday", 4.0);
    assert!(learn(&mut survey, 2, &friday, usize::MAX));
    let state = again(survey.saved()());
    let forecast = crate::Forecast::of_state(&state).unwrap();
    assert!(forecast.why_undated().is_none() && forecast.now_s() > 1e9 + 4.0 * DAY_S);
    assert_eq!(forecast.mapper().states(), survey.mapper().unwrap().states());
}
