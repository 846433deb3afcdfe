//! Arguments → logs → first pass → second pass → results.

mod args;
mod first_pass;
mod logs_in_order;
mod output;
mod report;
mod second_pass;
mod summary;
mod words;

use args::Args;
use curious::program::{Failure, INTERRUPTED, input, interrupt_flag, start};
use curious::terminal::{print, say};
use evaluation::output::RunFolder;
use logs_in_order::Source;
use std::io::stderr;
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

    /// The time of the first reading, in seconds since the epoch; 0 if the logs do not say it.
    fn begin_s(&self) -> f64 {
        self.sources.first().and_then(|source| source.log.summary().begin_s).unwrap_or_default()
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
    let folder = RunFolder::open(&args.out).map_err(anyhow::Error::from)?;
    let mut job = Job { args, sources, settings, is_interrupted };
    let Some(routes) = first_pass::routes(&job)? else {
        return Ok(ExitCode::from(INTERRUPTED));
    };
    if args.noise.is_none() {
        job.settings.learn_noise(&routes);
    }
    let learned = second_pass::learn(&job, &routes, folder.unfinished())?;
    let mut summary = Summary::new(&job, &routes, &learned);
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
