//! The trajectory of a robot from a log, a CARMEN log or a bag of ROS 2: matching, loops, pose graph.
//!
//! `turned=RAD` turns the frame of the odometry: the result must not depend on it.
//!
//! Writes `trajectory.tum` (the TUM format) and `trajectory.png` (all points that the laser hit, drawn along the
//! trajectory) beside each other in a folder, and prints the time per scan. Where the FLASER lines of a CARMEN log contain
//! the result of an earlier estimation, its difference to ours is printed, after a rigid alignment, and the sharpness of
//! both maps. The estimation never sees these poses. Last is the verdict on the map along the trajectory, along the odometry, and along
//! these poses.
//!
//! ```text
//! cargo run -p curious-evaluation --example log_trajectory -- LOG [FOLDER] [no-loops] [turned=RAD]
//! ```

mod alignment;
mod comparison;
mod picture;
mod verdict;

use localizer::{DistanceScale, LocalizerSettings, PoseState, Trajectory, TrajectoryFinder};
use logs::{Log, TopicChoice};
use results::TrajectoryFile;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (switches, paths): (Vec<_>, Vec<_>) =
        arguments.iter().partition(|argument| *argument == "no-loops" || argument.starts_with("turned="));
    let no_loops = switches.iter().any(|switch| *switch == "no-loops");
    let turned_rad = switches.iter().find_map(|switch| switch.strip_prefix("turned="));
    let turn = nalgebra::Isometry2::rotation(turned_rad.map_or(Ok(0.0), str::parse::<f64>)?);
    let Some(file) = paths.first() else {
        return Err("usage: log_trajectory LOG [FOLDER] [no-loops] [turned=RAD]".into());
    };
    let folder = paths.get(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    let log = Log::open(Path::new(file), &TopicChoice::default())?;
    print_summary(&log);
    let finder = || TrajectoryFinder::new(&LocalizerSettings::of_logs());
    let mut readings = Vec::new();
    for reading in log.readings()? {
        let mut reading = reading?;
        reading.pose = turn * reading.pose;
        readings.push(reading);
    }
    let begin = Instant::now();
    let mut local = Vec::new();
    let mut pass_over = |mut finder: TrajectoryFinder| {
        local.clear();
        for reading in &readings {
            finder.add(reading.clone());
            local.push(finder.local_pose());
        }
        finder.finish()
    };
    let mut trajectory = pass_over(finder()?);
    if let Some(scale) = trajectory.distance_scale {
        println!("true distance per distance of the odometry: {:.4} +- {:.4}", scale.scale, scale.std);
    }
    if let Some(scale) = trajectory.distance_scale.filter(DistanceScale::is_significant) {
        trajectory = pass_over(finder()?.with_distance_scale(&scale));
    }
    if no_loops {
        trajectory.poses.iter_mut().zip(local).for_each(|(found, local)| found.pose = local);
    }
    let per_scan_ms = begin.elapsed().as_secs_f64() * 1e3 / readings.len() as f64;
    print_trajectory(&trajectory, per_scan_ms);
    comparison::print(&log, &trajectory, &readings)?;
    verdict::print("the trajectory", &readings, trajectory.poses.iter().map(|found| Some(found.pose)))?;
    verdict::print("the odometry", &readings, readings.iter().map(|reading| Some(reading.pose)))?;
    if let Some(reference) = log.reference_poses()? {
        let poses = reference.into_iter().zip(&readings);
        verdict::print(
            "the FLASER lines",
            &readings,
            poses.map(|(laser, reading)| Some(laser? * reading.mount.inverse())),
        )?;
    }
    files::make_folder(&folder)?;
    let mut file = TrajectoryFile::create(&folder.join("trajectory.tum"));
    trajectory.poses.iter().for_each(|pose| file.add(pose.time_s, &pose.pose));
    file.finish()?;
    picture::write(&folder.join("trajectory.png"), &trajectory, &readings)?;
    Ok(())
}

fn print_summary(log: &Log) {
    let summary = log.summary();
    println!(
        "{} scans in {:.0} s, {} poses of the odometry",
        summary.scans, summary.duration_s, summary.odometry_poses
    );
    for note in &summary.notes {
        println!("note: {note}");
    }
}

fn print_trajectory(trajectory: &Trajectory, per_scan_ms: f64) {
    let poses = &trajectory.poses;
    let step_m = |pair: &[localizer::TrajectoryPose]| {
        (pair[1].pose.translation.vector - pair[0].pose.translation.vector).norm()
    };
    let length_m: f64 = poses.windows(2).map(step_m).sum();
    let uncertain = poses.iter().filter(|pose| pose.state != PoseState::Tracking).count();
    println!(
        "trajectory: {length_m:.0} m, {} places recognized, {uncertain} scans without support, {per_scan_ms:.2} ms per scan",
        trajectory.loops
    );
    if let Some(residual_m) = trajectory.residual_m {
        println!(
            "97 % of the points are within {:.1} cm of the surfaces of other passes",
            residual_m * 100.0
        );
    }
}
