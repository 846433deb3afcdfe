//! Arguments → logs → first pass → second pass → results.

mod args;
mod logs_in_order;
mod output;
mod passes;
mod place_names;
mod report;
mod summary;
mod survey_state_file;

use anyhow::{Context, anyhow};
use args::Args;
use cli::bag::RunBag;
use cli::flags::check_distinct;
use cli::program::{Failure, INTERRUPTED, input, interrupt_flag, results_folder, start};
use cli::terminal::{be_quiet, print_lines, say, tell};
use files::{RunFolder, is_below};
use logs::{Log, TopicChoice};
use logs_in_order::Source;
use owner::words::list;
use std::io::stderr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use summary::Summary;
use survey::{Survey, SurveySettings};
use survey_state_file::SurveyStateFile;

/// The exit code of a run whose map is not usable.
const NOT_USABLE: u8 = 3;

fn main() -> ExitCode {
    start(run)
}

/// What both passes need.
struct Job<'a> {
    args: &'a Args,
    /// The logs to learn from, in the order of their times.
    sources: Vec<Source>,
    /// The number of the first of them in the survey.
    first_log: usize,
    /// The first log that was given: its laser is shown.
    first: Source,
    settings: SurveySettings,
    is_interrupted: Arc<AtomicBool>,
}

impl Job<'_> {
    fn is_interrupted(&self) -> bool {
        self.is_interrupted.load(Ordering::Relaxed)
    }

    /// The names of all logs of the survey.
    fn title(&self, survey: &Survey) -> String {
        list(&survey.logs().iter().map(|log| log.entry.name.clone()).collect::<Vec<_>>())
    }

    /// What to try where no map can be made of the odometry: the poses of another SLAM, if all logs have them.
    fn other_poses(&self) -> &'static str {
        let given = &self.first.entry.choice;
        let other = TopicChoice { is_corrected: true, ..given.clone() };
        if !given.is_corrected && self.args.files.iter().all(|file| Log::open(file, &other).is_ok()) {
            "; the poses of another SLAM are there: try --pose corrected"
        } else {
            ""
        }
    }
}

fn run(args: &Args) -> Result<ExitCode, Failure> {
    be_quiet(args.quiet);
    let begin = Instant::now();
    let (out, mcap, state) = (Some(args.out.as_path()), args.mcap.as_deref(), args.state.as_deref());
    let places = args.places.as_deref();
    check_distinct(&[("--out", out), ("--mcap", mcap), ("--state", state), ("--places", places)])
        .map_err(input)?;
    let names = places.map(place_names::read).transpose().map_err(input)?;
    let (mut state_file, loaded) = SurveyStateFile::open(args.state.as_deref(), args.state_every)?;
    let choice = args.topics(loaded.as_ref()).map_err(input)?;
    let given = logs_in_order::open(&args.files, &choice, state_file.is_kept()).map_err(input)?;
    let settings = args.settings(&given, loaded.as_ref()).map_err(input)?;
    let mut survey = state_file.survey(loaded, &settings, args.noise.is_none())?;
    if let Some(names) = names {
        survey.name_places(names);
    }
    let first = given.first().cloned().context("no log is given").map_err(input)?;
    let sources = logs_in_order::continued(given, &mut survey).map_err(input)?;
    let first_log = survey.logs().iter().take_while(|log| log.is_finished()).count();
    let is_interrupted = interrupt_flag()?; // before any file is made
    let mut folder = results_folder(&args.out)?;
    let job = Job { args, sources, first_log, first, settings, is_interrupted };
    let bag = bag(&job, &survey, &mut folder)?;
    if !passes::routes(&job, &mut survey, &mut state_file)? {
        state_file.finish(&survey);
        let kept = match &args.state {
            Some(state) if state_file.is_written => {
                format!(
                    "; {} keeps the logs that are finished, and the same command goes on",
                    state.display()
                )
            }
            _ => String::new(),
        };
        tell(format_args!("interrupted in the first pass: no results are written{kept}"));
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let learned = passes::learn(&job, &mut survey, &mut state_file, bag, folder.unfinished())?;
    state_file.finish(&survey);
    let mut summary = Summary::new(&survey, &learned, args.accept_map)?;
    summary.wall_s = begin.elapsed().as_secs_f64();
    output::write(&folder, &survey, &learned, &mut summary)?;
    // A log can be the result of an earlier run.
    folder.finish(&args.files.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    if !learned.is_interrupted {
        // The results are complete: no run goes on from within these logs.
        survey.forget_poses();
        state_file.finish(&survey);
    }
    if summary.is_refused {
        let (reasons, other) = (summary.verdict_reasons.join("; "), job.other_poses());
        say(stderr(), format_args!("error: the map is not usable: {reasons}{other}"));
    }
    let (files, page) = (args.out.display(), args.out.join(output::PAGE));
    print_lines(format_args!("{summary}\n  files     {files}: open {}", page.display()))?;
    Ok(if !learned.is_shown || !state_file.is_written {
        ExitCode::FAILURE
    } else if learned.is_interrupted {
        ExitCode::from(INTERRUPTED)
    } else if summary.is_refused {
        ExitCode::from(NOT_USABLE)
    } else {
        ExitCode::SUCCESS
    })
}

/// The bag of `--mcap`, before the first pass: an invalid path is found at once.
fn bag(job: &Job, survey: &Survey, folder: &mut RunFolder) -> Result<Option<RunBag>, Failure> {
    let Some(path) = &job.args.mcap else { return Ok(None) };
    if job.args.files.iter().any(|log| is_below(path, log)) {
        let why = "would replace a log that is read, or be in its folder";
        return Err(input(anyhow!("--mcap {} {why}; choose another name", path.display())));
    }
    folder.adopt(path, "mcap").map_err(input)?;
    let earlier = survey.logs().iter().take(job.first_log).map(|log| &log.entry);
    let begin_s = logs_in_order::begin_s(earlier.chain(job.sources.iter().map(|source| &source.entry)));
    let bag = RunBag::create(path, begin_s.unwrap_or_default());
    bag.context("cannot write the bag of --mcap").map(Some).map_err(input)
}
