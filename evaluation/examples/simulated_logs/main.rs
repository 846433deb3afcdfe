//! Logs of generated buildings with known truth: how right are their trajectories, and does the verdict on the map say so?
//!
//! The building (houses and offices with people and doors), the laser (180 to 360 beams), the odometry (drift, glitches), the way (50
//! to 400 m) and its length between two scans (0.1 to 1.0 m) are drawn from a seed. Each log is judged along the trajectory that is
//! found, and along its odometry. Columns: distances from the truth after a rigid alignment (median, 95 %, maximum; m), the verdict, and
//! its figures (`survey::Quality`): contradicting scans, the worst stretch, weak links, scans left out, surfaces seen once; and the share
//! of the surfaces that are ghosts (`ghosts`). With FOLDER, every log is written there as a bag of ROS 2, with its true poses in the TUM
//! format.
//!
//! ```text
//! cargo run -p curious-evaluation --example simulated_logs -- FIRST_SEED LOGS [FOLDER]
//! ```

#[path = "../log_trajectory/alignment.rs"]
mod alignment;
mod drive;
mod ghosts;

use alignment::alignment;
use drive::{LogSpec, SimulatedLog};
use evaluation::metrics::quantile;
use files::{UnfinishedFile, make_folder};
use interfaces::PoseMode;
use logs::McapWriter;
use nalgebra::{Isometry2, Point2};
use results::TrajectoryFile;
use std::error::Error;
use std::path::Path;
use survey::{Route, SurveyError, SurveySettings, Verdict};

/// A trajectory is right if 95 % of its positions are this near to the truth, m.
const RIGHT_M: f64 = 0.3;
/// What is asked of the front end, m.
const PRECISE_M: f64 = 0.1;

/// What was counted over all logs.
#[derive(Default)]
struct Counts {
    logs: usize,
    precise: usize,
    /// Trajectories that are right or wrong, each with those called good among them.
    right: [usize; 2],
    wrong: [usize; 2],
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [first, logs, folder @ ..] = &arguments[..] else {
        return Err("usage: simulated_logs FIRST_SEED LOGS [FOLDER]".into());
    };
    let first: u64 = first.parse()?;
    let mut counts = Counts::default();
    for seed in first..first + logs.parse::<u64>()? {
        let spec = LogSpec::drawn(seed);
        let log = spec.record(seed)?;
        if let Some(folder) = folder.first() {
            write(Path::new(folder), seed, &log)?;
        }
        let ours = route(&log, PoseMode::Localized)?;
        println!("     true scale {:.4}", 1.0 / (1.0 + spec.gains[0]));
        println!(
            "{seed:4} {:12} a scan per {:.2} m, {:.0} m, {} scans, {:.0} glitches per 100 m, {} loops",
            spec.building,
            spec.step_m,
            log.way_m,
            log.readings.len(),
            100.0 * spec.glitches_per_m,
            ours.trajectory.loops
        );
        let p95_m = counts.add("found", &ours, &log);
        counts.logs += 1;
        counts.precise += usize::from(p95_m <= PRECISE_M);
        counts.add("odometry", &route(&log, PoseMode::Odometry)?, &log);
    }
    let Counts { logs, precise, right, wrong } = counts;
    println!(
        "95 % of the positions within {PRECISE_M} m of the truth: {precise} of {logs} trajectories that were found"
    );
    println!(
        "called good: {} of {} trajectories that are right (95 % within {RIGHT_M} m), {} of {} that are wrong",
        right[1], right[0], wrong[1], wrong[0]
    );
    Ok(())
}

impl Counts {
    /// Prints and counts a trajectory. Gives the 95 % quantile of its errors, m.
    fn add(&mut self, name: &str, route: &Route, log: &SimulatedLog) -> f64 {
        let poses: Vec<Isometry2<f64>> = route.trajectory.poses.iter().map(|at| at.pose).collect();
        let to_truth = to_truth(&poses, &log.truth);
        let ([median_m, p95_m, max_m], quality) = (errors_m(&to_truth, &poses, &log.truth), &route.quality);
        let (verdict, ghosts) = (quality.verdict(), ghosts::share(&to_truth, &poses, log));
        let of = if p95_m <= RIGHT_M { &mut self.right } else { &mut self.wrong };
        of[0] += 1;
        of[1] += usize::from(verdict == Verdict::Good);
        println!(
            "     {name:8} {median_m:6.3} {p95_m:6.3} {max_m:6.3}  {:16} {:.3} {:.3} {:2} {:.3} {:.2} {ghosts:.4}",
            verdict.name(),
            quality.contradicting,
            quality.worst_stretch,
            quality.weak_links,
            quality.left_out,
            quality.seen_once
        );
        p95_m
    }
}

fn write(folder: &Path, seed: u64, log: &SimulatedLog) -> Result<(), Box<dyn Error>> {
    make_folder(folder)?;
    let mut bag = McapWriter::new(UnfinishedFile::create(&folder.join(format!("{seed}.mcap")))?, "bag", 1e9)?;
    let mut truth = TrajectoryFile::create(&folder.join(format!("{seed}.tum")));
    for (reading, pose) in log.readings.iter().zip(&log.truth) {
        bag.reading(reading)?;
        truth.add(reading.time_s, pose);
    }
    bag.finish()?.finish()?;
    truth.finish()?;
    Ok(())
}

fn route(log: &SimulatedLog, mode: PoseMode) -> Result<Route, SurveyError> {
    Route::of_passes(&SurveySettings::of(mode), |mut pass| {
        log.readings.iter().for_each(|reading| pass.add(reading.clone()));
        let route = pass.finish();
        if let Some(scale) = route.trajectory.distance_scale {
            println!("     scale {:.4} +- {:.4}", scale.scale, scale.std);
        }
        Ok(route)
    })
}

/// The rigid motion that brings the positions nearest to the true ones.
fn to_truth(poses: &[Isometry2<f64>], truth: &[Isometry2<f64>]) -> Isometry2<f64> {
    let position = |at: &Isometry2<f64>| at.translation.vector;
    let pairs: Vec<_> =
        poses.iter().zip(truth).map(|(found, truth)| (position(found), position(truth))).collect();
    alignment(&pairs)
}

/// Median, 95 % and maximum of the distances from the truth after a rigid alignment, m.
fn errors_m(to_truth: &Isometry2<f64>, poses: &[Isometry2<f64>], truth: &[Isometry2<f64>]) -> [f64; 3] {
    let at = |pose: &Isometry2<f64>| Point2::from(pose.translation.vector);
    let error =
        |(found, truth): (&Isometry2<f64>, &Isometry2<f64>)| (to_truth * at(found) - at(truth)).norm();
    let errors: Vec<f64> = poses.iter().zip(truth).map(error).collect();
    [0.5, 0.95, 1.0].map(|share| quantile(&errors, share).unwrap_or(f64::NAN))
}
