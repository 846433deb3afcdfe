//! The first pass: the route of every log, in one frame.

use crate::Job;
use anyhow::Error;
use curious::program::{Failure, input};
use curious::progress::Progress;
use logs::Log;
use std::ops::ControlFlow;
use survey::{PassError, Route, RouteProgress, Stage};

/// The routes of all logs, in the frame of the first one. `None` if the user has interrupted the pass.
pub(crate) fn routes(job: &Job) -> Result<Option<Vec<Route>>, Failure> {
    let logs: Vec<&Log> = job.sources.iter().map(|source| &source.log).collect();
    let mut bar = None;
    let watch = |RouteProgress { log, stage, readings }| {
        match readings {
            0 => bar = begin(job, log, stage, bar.take()),
            _ => bar.iter().for_each(Progress::step),
        }
        if job.is_interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let found = survey::routes(&logs, &job.settings, watch);
    bar.iter().for_each(Progress::finish);
    match found {
        Ok(routes) => Ok(Some(routes)),
        Err(PassError::Interrupted) => Ok(None),
        Err(PassError::Alignment { log, why }) => {
            Err(input(Error::from(why).context(format!("cannot use {}", job.sources[log].name))))
        }
        Err(other) => Err(input(other)),
    }
}

/// Reports that a stage begins, below the finished bar of the stage before. Gives the bar of this stage.
fn begin(job: &Job, log: usize, stage: Stage, before: Option<Progress>) -> Option<Progress> {
    before.iter().for_each(Progress::finish);
    let what = match stage {
        Stage::Trajectory => "first pass",
        Stage::Loops => "closing loops",
        Stage::Map => "map for the logs that follow",
        Stage::Search => "search for its place",
    };
    let source = &job.sources[log];
    job.say(format_args!("{}: {what}", source.name));
    (stage != Stage::Loops).then(|| Progress::of_scans(source.log.summary().scans, job.args.quiet))
}
