//! The first pass: the trajectory of every log, in one frame.

use crate::Job;
use crate::logs_in_order::Source;
use anyhow::Context;
use curious::program::{Failure, input};
use curious::progress::Progress;
use interfaces::LaserReading;
use survey::{Aligner, FirstPass, PoseMode, Session};

/// The trajectories of all logs, in the frame of the first one. `None` if the user has interrupted the pass.
pub(crate) fn sessions(job: &Job) -> Result<Option<Vec<Session>>, Failure> {
    let mut sessions: Vec<Session> = Vec::new();
    let mut aligner = None;
    for source in &job.sources {
        let mut pass = FirstPass::new(&job.settings).map_err(input)?;
        let add = |reading| {
            pass.add(reading);
            Ok(())
        };
        if !each_reading(job, source, "first pass", add)? {
            return Ok(None);
        }
        if job.settings.pose == PoseMode::Localized {
            job.say(format_args!("{}: closing loops", source.name));
        }
        let session = pass.finish();
        if job.is_interrupted() {
            return Ok(None);
        }
        if job.settings.pose != PoseMode::Localized || job.sources.len() == 1 {
            sessions.push(session);
            continue;
        }
        let Some(aligner) = &aligner else {
            let mut first = Aligner::new(&job.settings, &session).map_err(input)?;
            let mut poses = session.poses.iter();
            let add = |reading| match poses.next() {
                Some(found) => first.add(reading, found).map_err(input),
                None => Ok(()),
            };
            if !each_reading(job, source, "map for the logs that follow", add)? {
                return Ok(None);
            }
            aligner = Some(first);
            sessions.push(session);
            continue;
        };
        let mut search = aligner.search().map_err(input)?;
        let mut poses = session.poses.iter();
        let add = |reading| {
            poses.next().into_iter().for_each(|found| search.add(&reading, found));
            Ok(())
        };
        if !each_reading(job, source, "search for its place", add)? {
            return Ok(None);
        }
        let at = search.finish().with_context(|| format!("cannot use {}", source.name)).map_err(input)?;
        sessions.push(session.moved(&at));
    }
    Ok(Some(sessions))
}

/// Calls `use_reading` with every reading of a log, and shows the progress. Returns `false` if the user has interrupted
/// it.
fn each_reading(
    job: &Job,
    source: &Source,
    what: &str,
    mut use_reading: impl FnMut(LaserReading) -> Result<(), Failure>,
) -> Result<bool, Failure> {
    let summary = source.log.summary();
    job.say(format_args!("{}: {what}", source.name));
    let progress = Progress::of_scans(summary.scans, job.args.quiet);
    for reading in source.log.readings().map_err(input)? {
        if job.is_interrupted() {
            return Ok(false);
        }
        use_reading(reading.map_err(input)?)?;
        progress.step();
    }
    progress.finish();
    Ok(true)
}
