//! Arguments → logs → first pass → second pass → results.

mod args;
mod first_pass;
mod logs_in_order;
mod output;
mod report;
mod second_pass;
mod summary;
mod words;

use anyhow::{Context, anyhow};
use args::Args;
use curious::bag::RunBag;
use curious::program::{Failure, INTERRUPTED, input, interrupt_flag, start};
use curious::terminal::{print, say};
use evaluation::output::RunFolder;
use logs_in_order::Source;
use std::io::stderr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use summary::Summary;
use survey::SurveySettings;

fn main() -> ExitCode {
    start(run)
}

/// What both passes need.
struct Job<'a> {
    args: &'a Args,
    sources: Vec<Source>,
    settings: SurveySettings,
    is_interrupted: Arc<AtomicBool>,
}

impl Job<'_> {
    fn is_interrupted(&self) -> bool {
        self.is_interrupted.load(Ordering::Relaxed)
    }

    /// The time of the first reading, in seconds since the epoch; `None` unless every log says when it was recorded.
    fn begin_s(&self) -> Option<f64> {
        let mut begins_s = self.sources.iter().map(|source| source.log.summary().begin_s);
        let first_s = begins_s.next()?;
        if begins_s.all(|begin_s| begin_s.is_some()) { first_s } else { None }
    }

    /// Prints a line about the work to the error output.
    fn say(&self, line: std::fmt::Arguments) {
        if !self.args.quiet {
            say(stderr(), line);
        }
    }
}

fn run(args: &Args) -> Result<ExitCode, Failure> {
    let begin = Instant::now();
    let sources = logs_in_order::open(&args.files, &args.topics()).map_err(input)?;
    let settings = args.settings(&sources).map_err(input)?;
    let is_interrupted = interrupt_flag()?; // before any file is made
    let mut folder = RunFolder::open(&args.out).map_err(anyhow::Error::from)?;
    let mut job = Job { args, sources, settings, is_interrupted };
    let bag = bag(&job, &mut folder)?;
    let Some(routes) = first_pass::routes(&job)? else {
        return Ok(ExitCode::from(INTERRUPTED));
    };
    if args.noise.is_none() {
        job.settings.learn_noise(&routes);
    }
    let learned = second_pass::learn(&job, &routes, bag, folder.unfinished())?;
    let mut summary = Summary::new(&job, &routes, &learned);
    summary.wall_s = begin.elapsed().as_secs_f64();
    output::write(folder, &args.files, &learned, &mut summary)?;
    if !args.quiet {
        print(format_args!("{summary}\n  files     {}", args.out.display()))?;
    }
    Ok(match () {
        () if !learned.is_shown => ExitCode::FAILURE,
        () if learned.is_interrupted => ExitCode::from(INTERRUPTED),
        () => ExitCode::SUCCESS,
    })
}

/// The bag of `--mcap`, before the first pass: an invalid path is found at once.
fn bag(job: &Job, folder: &mut RunFolder) -> Result<Option<RunBag>, Failure> {
    let Some(path) = &job.args.mcap else { return Ok(None) };
    let own = path.canonicalize().ok();
    let is_input = |file: &PathBuf| own.is_some() && file.canonicalize().ok() == own;
    if job.args.files.iter().any(is_input) {
        return Err(input(anyhow!("--mcap {} would replace a log that is read", path.display())));
    }
    folder.adopt(path, "mcap").map_err(input)?;
    let bag = RunBag::create(path, job.begin_s().unwrap_or_default());
    bag.context("cannot write the bag of --mcap").map(Some).map_err(input)
}
