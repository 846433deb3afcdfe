//! The first pass: the route of every log, in one frame.

use crate::Job;
use crate::survey_state_file::SurveyStateFile;
use anyhow::Error;
use cli::program::{Failure, input};
use cli::progress::Progress;
use cli::terminal::say;
use std::io::stderr;
use std::ops::ControlFlow;
use survey::{Stage, Survey, SurveyError, Verdict};

/// Finds the routes of all logs of which the survey has none. Returns false if interrupted.
pub(crate) fn routes(
    job: &Job,
    survey: &mut Survey,
    state_file: &mut SurveyStateFile,
) -> Result<bool, Failure> {
    for (number, source) in job.sources.iter().enumerate() {
        let log = job.first_log + number;
        if log < survey.logs().len() {
            continue;
        }
        let can_align = source.entry.stands || job.settings.pose.is_consistent();
        let is_followed = can_align && (state_file.is_kept() || number + 1 < job.sources.len());
        let mut shown: Option<Progress> = None;
        let watch = |(stage, readings)| {
            match (readings, &shown) {
                (0, _) => {
                    drop(shown.take()); // below the finished bar of the stage before
                    shown = Some(begin(job, number, stage));
                }
                (_, Some(bar)) => bar.step(),
                _ => {}
            }
            if job.is_interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let found = survey.first_pass(&source.log, source.entry.clone(), is_followed, watch);
        drop(shown);
        let notes = survey.logs().get(log).map(|log| &log.entry.notes[source.entry.notes.len()..]);
        for note in notes.iter().flat_map(|notes| notes.iter()) {
            say(stderr(), format_args!("note: {}: {note}", source.entry.name));
        }
        match found {
            Ok(()) if survey.verdict() == Verdict::NotUsable && !job.args.accept_map => {
                if state_file.is_kept() {
                    job.say(format_args!("the map is not usable: the state stays as it was (--accept-map)"));
                }
                state_file.leave();
            }
            Ok(()) => state_file.save(survey),
            Err(SurveyError::Interrupted) => return Ok(false),
            Err(SurveyError::Alignment(why)) => {
                let why = Error::from(why).context(format!("cannot use {}", source.entry.name));
                if state_file.is_kept() {
                    let way_out = "if it is of another place, it needs a --state of its own";
                    job.say(format_args!("{} is not added to the state: {way_out}", source.entry.name));
                }
                return Err(input(why));
            }
            Err(other) => return Err(input(other)),
        }
    }
    Ok(true)
}

/// Reports that a stage begins, and shows it.
fn begin(job: &Job, number: usize, stage: Stage) -> Progress {
    let what = match stage {
        Stage::Trajectory => "first pass",
        Stage::Loops => "closing loops",
        Stage::Map => "map for the logs that follow",
        Stage::Search => "search for its place",
    };
    let source = &job.sources[number];
    job.say(format_args!("{}: {what}", source.entry.name));
    match stage {
        Stage::Loops => Progress::of_work(format!("{}: {what}", source.entry.name), job.args.quiet),
        _ => Progress::of_count(source.log.summary().scans, "scans", job.args.quiet),
    }
}
