//! The second pass: the map and its changes along the trajectories.

use crate::Job;
use crate::logs_in_order::Source;
use anyhow::{Context, anyhow};
use curious::bag::RunBag;
use curious::program::{Failure, input};
use curious::progress::Progress;
use curious::terminal::say;
use evaluation::output::TrajectoryFile;
use interfaces::LaserReading;
use mapper::Mapper;
use robot::{Belief, Localization};
use std::io::stderr;
use std::ops::ControlFlow;
use std::path::Path;
use survey::{ChangeLog, FoundPoses, NoPilot, Replay, Route, frame};
use viewer::recording::Recorder;
use viewer::scene::Scene;
use viewer::show::Show;
use viewer::view::{Measured, View};

/// The name of the recording.
const RECORDING: &str = "map_log.rrd";

/// What the second pass has learned.
pub(crate) struct Learned {
    pub(crate) mapper: Mapper,
    pub(crate) changes: ChangeLog,
    pub(crate) show: Show,
    /// The number of readings of each log that were used; logs that were not begun are missing.
    pub(crate) readings: Vec<usize>,
    /// Whether the pass was interrupted.
    pub(crate) is_interrupted: bool,
    /// Whether the recording and the trajectory are complete.
    pub(crate) is_shown: bool,
}

/// Learns from all logs along their trajectories, and writes what happens to `bag`. The recording and the trajectory are
/// written to `folder`.
pub(crate) fn learn(
    job: &Job,
    routes: &[Route],
    bag: Option<RunBag>,
    folder: &Path,
) -> Result<Learned, Failure> {
    let frame = frame(routes, &job.settings).map_err(input)?;
    let mapper = Mapper::new(&job.settings.mapper, frame).map_err(input)?;
    let first = job.sources[0].log.readings().map_err(input)?.next();
    let first = first.context("the log has no reading").map_err(input)?.map_err(input)?;
    let title = job.sources.iter().map(|source| source.name.as_str()).collect::<Vec<_>>().join(", ");
    let scene = Scene::of_log(&title, frame, &job.settings.filtered(first));
    let recorder = if job.args.no_rrd { None } else { recorder(&folder.join(RECORDING), &scene)? };
    let mut learned = Learned {
        mapper,
        changes: ChangeLog::default(),
        show: Show::new(scene, recorder, None),
        readings: Vec::new(),
        is_interrupted: false,
        is_shown: true,
    };
    let mut trajectory = TrajectoryFile::create(&folder.join("trajectory.tum"));
    let last = job.sources.len() - 1;
    for (number, (source, route)) in job.sources.iter().zip(routes).enumerate() {
        learned.replay(job, source, route, (&mut trajectory, bag.as_ref()), number == last)?;
        if learned.is_interrupted {
            break;
        }
    }
    if let Some(Err(problem)) = bag.map(RunBag::finish) {
        learned.is_shown = false;
        say(stderr(), format_args!("error: cannot write the bag: {problem:#}"));
    }
    if let Err(problem) = trajectory.finish() {
        learned.is_shown = false;
        say(stderr(), format_args!("error: cannot write the trajectory: {problem}"));
    }
    Ok(learned)
}

#[cfg(feature = "recording")]
fn recorder(path: &Path, scene: &Scene) -> anyhow::Result<Option<Recorder>> {
    Ok(Some(Recorder::new(Some(path), &[], scene.clone())?))
}

/// A program without the feature makes no recording.
#[cfg(not(feature = "recording"))]
fn recorder(_: &Path, _: &Scene) -> anyhow::Result<Option<Recorder>> {
    Ok(None)
}

impl Learned {
    /// Learns from one log.
    fn replay(
        &mut self,
        job: &Job,
        source: &Source,
        route: &Route,
        (trajectory, bag): (&mut TrajectoryFile, Option<&RunBag>),
        is_last_log: bool,
    ) -> Result<(), Failure> {
        job.say(format_args!("{}: learning what changes", source.name));
        let readings = source.log.readings().map_err(input)?;
        let replay = Replay::new(readings, &job.settings, source.offset_s).map_err(input)?;
        let changed = || anyhow!("{}: the log has changed since the first pass", source.name);
        let replay = replay.ok_or_else(|| input(changed()))?;
        let found = Box::new(FoundPoses::new(route.poses.clone()));
        let mut poses: Box<dyn Localization<LaserReading>> = match bag {
            Some(bag) => Box::new(bag.recorded(found)),
            None => found,
        };
        let progress = Progress::of_scans(source.log.summary().scans, job.args.quiet);
        let Self { mapper, changes, show, readings, is_interrupted, is_shown } = self;
        readings.push(0);
        let observe = |replay: &Replay<_>, reading: &LaserReading, belief: &Belief| {
            progress.step();
            readings.last_mut().into_iter().for_each(|count| *count += 1);
            changes.note(belief.mapper);
            bag.into_iter().for_each(|bag| bag.add(belief, &NoPilot));
            trajectory.add(reading.time_s, belief.pose);
            *is_interrupted = job.is_interrupted();
            let view = View::new(replay, reading, belief, &NoPilot, Measured::default());
            let is_last = *is_interrupted || replay.is_over() && is_last_log;
            if let Err(problem) = show.add(&view, is_last) {
                *is_shown = false;
                progress.say(format_args!("error: {problem}; the run goes on without it"));
            }
            if *is_interrupted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        survey::learn(replay, poses.as_mut(), mapper, observe).map_err(input)?;
        progress.finish();
        Ok(())
    }
}
