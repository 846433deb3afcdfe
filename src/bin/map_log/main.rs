//! Arguments → log → first pass → second pass → results.

mod args;
mod output;
mod report;
mod summary;

use anyhow::{Context, anyhow};
use args::Args;
use curious::program::{Failure, INTERRUPTED, input, interrupt_flag, start};
use curious::progress::Progress;
use curious::terminal::{print, say};
use evaluation::output::{RunFolder, TrajectoryFile};
use interfaces::Reading;
use logs::CarmenLog;
use mapper::{Mapper, ReadingError};
use robot::explore;
use std::io::stderr;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use summary::Summary;
use survey::{ChangeLog, FirstPass, FoundPoses, Passenger, Replay, Route, SurveySettings};
use viewer::recording::Recorder;
use viewer::scene::Scene;
use viewer::show::Show;
use viewer::view::{Measured, View};

/// The name of the recording.
const RECORDING: &str = "map_log.rrd";

fn main() -> ExitCode {
    start(run)
}

/// What the second pass has learned.
struct Learned {
    mapper: Mapper,
    changes: ChangeLog,
    show: Show,
    /// Whether the pass was interrupted.
    is_interrupted: bool,
    /// Whether the recording and the trajectory are complete.
    is_shown: bool,
}

fn run(args: &Args) -> Result<ExitCode, Failure> {
    let begin = Instant::now();
    let log = CarmenLog::open(&args.file).map_err(input)?;
    let settings = args.settings(log.summary().odometry_poses == 0);
    if !args.quiet {
        let summary = log.summary();
        say(
            stderr(),
            format_args!("{}: {} scans in {:.0} s", args.file.display(), summary.scans, summary.duration_s),
        );
    }
    log.summary().notes.iter().for_each(|note| say(stderr(), format_args!("note: {note}")));
    let is_interrupted = interrupt_flag()?; // before any file is made
    let folder = RunFolder::open(&args.out).map_err(anyhow::Error::from)?;
    let Some(route) = first_pass(args, &log, &settings, &is_interrupted)? else {
        return Ok(ExitCode::from(INTERRUPTED));
    };
    let learned = second_pass(args, &log, &settings, &route, &folder, &is_interrupted)?;
    let mut summary = Summary::new(args, &log, &settings, &route, &learned);
    summary.wall_s = begin.elapsed().as_secs_f64();
    output::write(folder, &learned, &mut summary)?;
    if !args.quiet {
        print(format_args!("{summary}\n  files     {}", args.out.display()))?;
    }
    Ok(match () {
        () if !learned.is_shown => ExitCode::FAILURE,
        () if learned.is_interrupted => ExitCode::from(INTERRUPTED),
        () => ExitCode::SUCCESS,
    })
}

/// Finds the trajectory and the extent of the place. `None` if the user has interrupted it.
fn first_pass(
    args: &Args,
    log: &CarmenLog,
    settings: &SurveySettings,
    is_interrupted: &AtomicBool,
) -> Result<Option<Route>, Failure> {
    let mut pass = FirstPass::new(settings).map_err(input)?;
    let progress = Progress::of_time(log.summary().duration_s, args.quiet, false);
    for reading in log.readings().map_err(input)? {
        let reading = reading.map_err(input)?;
        if is_interrupted.load(Ordering::Relaxed) {
            return Ok(None);
        }
        progress.show(reading.time(), || 0.0);
        pass.add(reading);
    }
    progress.finish();
    if !args.quiet && settings.pose == survey::PoseMode::Localized {
        say(stderr(), "closing loops");
    }
    pass.finish().map(Some).map_err(input)
}

/// Learns the map and its changes along the trajectory.
fn second_pass(
    args: &Args,
    log: &CarmenLog,
    settings: &SurveySettings,
    route: &Route,
    folder: &RunFolder,
    is_interrupted: &AtomicBool,
) -> Result<Learned, Failure> {
    let mut mapper = Mapper::new(&settings.mapper, route.frame).map_err(input)?;
    let mut readings = log.readings().map_err(input)?.peekable();
    let Some(Ok(first)) = readings.peek() else {
        return Err(input(anyhow!("{}: the log has changed since the first pass", args.file.display())));
    };
    let title = args.file.file_name().unwrap_or_default().to_string_lossy();
    let scene = Scene::of_log(&title, route.frame, &settings.filtered(first.clone()));
    let recording = folder.unfinished().join(RECORDING);
    let recorder = (!args.no_rrd).then(|| Recorder::new(Some(&recording), &[], scene.clone()));
    let mut show = Show::new(scene, recorder.transpose().map_err(anyhow::Error::from)?, None);
    let mut trajectory = TrajectoryFile::create(&folder.unfinished().join("trajectory.tum"));
    let replay = Replay::new(readings, settings).map_err(input)?;
    let mut replay = replay.context("the log has no reading").map_err(input)?;
    let mut poses = FoundPoses::new(route.poses.clone());
    let progress = Progress::of_time(log.summary().duration_s, args.quiet, false);
    let (mut changes, mut was_interrupted, mut is_shown) = (ChangeLog::default(), false, true);
    let went =
        explore(&mut replay, &mut poses, &mut mapper, &mut Passenger, |replay, reading, belief, pilot| {
            progress.show(reading.time(), || 1.0);
            changes.note(belief.mapper);
            trajectory.add(reading.time_s, belief.pose);
            was_interrupted = is_interrupted.load(Ordering::Relaxed);
            let is_last = was_interrupted || replay.is_over();
            let view = View::new(replay, reading, belief, pilot, Measured::default());
            if let Err(problem) = show.add(&view, is_last) {
                is_shown = false;
                progress.say(format_args!("error: {problem}; the run goes on without it"));
            }
            Ok::<_, ReadingError>(if is_last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        });
    progress.finish();
    went.map_err(input)?;
    if let Some(problem) = replay.into_problem() {
        return Err(input(problem));
    }
    if let Err(problem) = trajectory.finish() {
        is_shown = false;
        say(stderr(), format_args!("error: cannot write the trajectory: {problem}"));
    }
    Ok(Learned { mapper, changes, show, is_interrupted: was_interrupted, is_shown })
}
