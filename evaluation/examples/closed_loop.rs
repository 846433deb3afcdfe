//! From a robot to a map of changes, against the truth: a robot with bad odometry drives in a simulated house, by its
//! own estimate, and its scans and odometry are written to several bags. From these the trajectories are found and
//! aligned, and the rates are learned, as `map_log` does it, but in the frame of the robot, and with the noise of all bags
//! (or `NOISE_M`, in m). The frame of a survey is that of its first pose; for the comparison, one rigid motion of all routes
//! brings them as near to the true poses as possible.
//!
//! Printed: the log error of the rates, of a mapper that gets the same scans with their true poses, of the live run, of the
//! survey of the bags, and of the same survey with the true poses; the error of the poses, and how far the frame of the first
//! pose is turned.
//!
//! ```text
//! cargo run -p curious-evaluation --example closed_loop -- [WORLD [SEED [MINUTES [SESSIONS [NOISE_M]]]]]
//! ```

#[path = "log_trajectory/alignment.rs"]
mod alignment;

use agent::Policy;
use alignment::alignment;
use evaluation::metrics::{RateScores, quantile, rate_scores};
use evaluation::physics_trial::{self, PhysicsTrial};
use files::UnfinishedFile;
use interfaces::{GridFrame, LaserReading, PoseMode, World, heading_rad};
use localizer::TrajectoryPose;
use logs::{Log, McapWriter, TopicChoice};
use mapper::{Mapper, NoReturn, ScanFilter, ScanFilterSettings};
use robot::{NoPilot, Robot, Settings};
use std::error::Error;
use std::io::BufWriter;
use std::ops::ControlFlow;
use std::path::PathBuf;
use survey::{FoundPoses, LogEntry, Survey, SurveySettings};

/// The poses of a bag.
type Route = Vec<TrajectoryPose>;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default| arguments.get(index).map_or(Ok(default), |text| text.parse::<u64>());
    let path = arguments.first().map_or("worlds/drifting_house.toml", String::as_str);
    let (seed, minutes, sessions) = (number(1, 100)?, number(2, 60)?, number(3, 4)?);
    let folder = tempfile::tempdir()?;

    let spec = worldfile::physics::load_world(path)?;
    let settings = physics_trial::settings(&spec)?;
    let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
    let mut trial = PhysicsTrial::new(&spec, seed, &settings, None, pilot)?;
    // The robot has a frame of its own, and the world is given in it.
    let frame = *trial.robot.mapper.frame();
    let same_robot = Settings { pose: PoseMode::Exact, ..settings.clone() };
    let mut exact = same_robot.robot(frame, None, *trial.world.true_pose(), NoPilot)?;
    let mut truth = vec![Vec::new(); sessions as usize];
    let bags: Vec<PathBuf> = (0..sessions).map(|bag| folder.path().join(format!("{bag}.mcap"))).collect();
    for (number, bag) in bags.iter().enumerate() {
        let mut writer = McapWriter::new(BufWriter::new(UnfinishedFile::create(bag)?), "bag", 1e9)?;
        let end_s = (number + 1) as f64 * minutes as f64 * 60.0;
        while trial.world.time_s() < end_s {
            trial.turn()?;
            let (raw, pose) = (trial.world.sense(), *trial.world.true_pose());
            writer.reading(&raw)?;
            truth[number].push(pose);
            exact.step(LaserReading { pose, ..raw })?;
        }
        writer.finish()?.into_inner()?.finish()?;
    }

    let mut settings = SurveySettings::of(PoseMode::Localized);
    settings.resolution_m = spec.frame.resolution_m();
    let (mut survey, mut logs) = (Survey::new(settings, true), Vec::new());
    for (number, bag) in bags.iter().enumerate() {
        let log = Log::open(bag, &TopicChoice::default())?;
        let entry = LogEntry::of(bag.display().to_string(), &log, &TopicChoice::default())?;
        survey.first_pass(&log, entry, number + 1 < bags.len(), |_| ControlFlow::Continue(()))?;
        logs.push(log);
    }
    let mut settings = survey.settings_of(logs.len());
    if let Some(noise_m) = arguments.get(4) {
        settings.set_noise(noise_m.parse()?);
    }
    let mut routes: Vec<Route> = survey.logs().iter().map(|log| log.route().to_vec()).collect();
    let found = routes.iter().flatten().map(|at| at.pose.translation.vector);
    let true_positions = truth.iter().flatten().map(|at| at.translation.vector);
    let to_world = alignment(&found.zip(true_positions).collect::<Vec<_>>());
    let turn_rad = heading_rad(&(to_world.inverse() * truth[0][0]));
    routes.iter_mut().flatten().for_each(|at| at.pose = to_world * at.pose);
    let mapper = learned(&logs, &routes, &settings, frame)?;
    let mut true_routes = routes.clone();
    for (route, truth) in true_routes.iter_mut().zip(&truth) {
        route.iter_mut().zip(truth).for_each(|(at, truth)| at.pose = *truth);
    }
    let mapper_of_truth = learned(&logs, &true_routes, &settings, frame)?;

    println!(
        "{path}, seed {seed}, {sessions} bags of {minutes} min, noise {:.3} m",
        settings.mapper.steady.range_noise_std_m
    );
    print("same scans, true poses", &rate_scores(&exact.mapper, trial.world.truth()));
    print("live, localized       ", &rate_scores(&trial.robot.mapper, trial.world.truth()));
    print("survey of the bags    ", &rate_scores(&mapper, trial.world.truth()));
    print("survey, true poses    ", &rate_scores(&mapper_of_truth, trial.world.truth()));
    println!("the first pose is turned by {:.2}° against the rest", turn_rad.to_degrees());
    for (number, (route, truth)) in routes.iter().zip(&truth).enumerate() {
        let errors_m: Vec<f64> = route
            .iter()
            .zip(truth)
            .map(|(found, truth)| (found.pose.translation.vector - truth.translation.vector).norm())
            .collect();
        let at = |share: f64| quantile(&errors_m, share).unwrap_or(f64::NAN) * 1000.0;
        println!(
            "poses of bag {number}: median {:.0}, 95 % {:.0}, largest {:.0} mm",
            at(0.5),
            at(0.95),
            at(1.0)
        );
    }
    Ok(())
}

/// What a robot learns from bags along these routes.
fn learned(
    logs: &[Log],
    routes: &[Route],
    settings: &SurveySettings,
    frame: GridFrame,
) -> Result<Mapper, Box<dyn Error>> {
    let mut mapper = Mapper::new(&settings.mapper, frame)?;
    let begin_s = |log: &Log| log.summary().begin_s.unwrap_or_default();
    for (log, route) in logs.iter().zip(routes) {
        let poses = FoundPoses::new(route.clone());
        let filter =
            ScanFilter::new(&ScanFilterSettings { no_return: NoReturn::Free, ..settings.filter.clone() })?;
        let mut robot = Robot::new(Box::new(poses), mapper, NoPilot).with_filter(filter);
        robot.begin_session(0.0, Some(begin_s(log) - begin_s(&logs[0]) - robot.mapper.time()));
        for reading in log.readings()? {
            robot.step(reading?)?;
        }
        mapper = robot.mapper;
    }
    Ok(mapper)
}

fn print(what: &str, scores: &RateScores) {
    let text = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"));
    println!(
        "{what}: log error {}, AUC {}, false changes {} ({} in the map)",
        text(scores.log_error),
        text(scores.rate_auc),
        scores.false_change_events,
        scores.false_map_changes
    );
}
