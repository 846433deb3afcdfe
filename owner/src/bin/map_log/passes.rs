//! The two passes over the logs: the route of every log in one frame, then the map and its changes along the routes.

use crate::Job;
use crate::survey_state_file::SurveyStateFile;
use anyhow::{Context, Error, anyhow};
use cli::bag::RunBag;
use cli::program::{Failure, input};
use cli::progress::Progress;
use cli::terminal::{note, say, tell};
use draw::scene::Scene;
use draw::view::View;
use mapper::{NoReturnDistrust, NoReturnEvidence};
use results::TrajectoryFile;
use results::numbers::percent;
use robot::NoPilot;
use std::io::stderr;
use std::ops::ControlFlow;
use std::path::Path;
use survey::{Stage, Survey, SurveyError, Verdict};
use viewer::recording::Recorder;
use viewer::show::Show;

// First pass

/// Finds the routes of all logs of which the survey has none. Returns false if interrupted.
pub(crate) fn routes(job: &Job, survey: &mut Survey, state: &mut SurveyStateFile) -> Result<bool, Failure> {
    for (number, source) in job.sources.iter().enumerate() {
        let log = job.first_log + number;
        if log < survey.logs().len() {
            continue;
        }
        let can_align = source.entry.stands || job.settings.pose.is_consistent();
        let is_followed = can_align && (state.is_kept() || number + 1 < job.sources.len());
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
        for what in notes.iter().flat_map(|notes| notes.iter()) {
            note(format_args!("{}: {what}", source.entry.name));
        }
        match found {
            Ok(()) if survey.verdict() == Verdict::NotUsable && !job.args.accept_map => {
                if state.is_kept() {
                    tell(format_args!("the map is not usable: the state stays as it was (--accept-map)"));
                }
                state.leave();
            }
            Ok(()) => state.save(survey),
            Err(SurveyError::Interrupted) => return Ok(false),
            Err(SurveyError::Alignment(why)) => {
                let why = Error::from(why).context(format!("cannot use {}", source.entry.name));
                if state.is_kept() {
                    let way_out = "if it is of another place, it needs a --state of its own";
                    tell(format_args!("{} is not added to the state: {way_out}", source.entry.name));
                }
                return Err(input(why));
            }
            Err(other) => return Err(input(anyhow!("{other}{}", job.other_poses()))),
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
    tell(format_args!("{}: {what}", source.entry.name));
    match stage {
        Stage::Loops => Progress::of_work(format!("{}: {what}", source.entry.name)),
        _ => Progress::of_count(source.log.summary().scans, "scans"),
    }
}

// Second pass

/// The name of the recording.
const RECORDING: &str = "map_log.rrd";

/// How the second pass has ended.
pub(crate) struct Learned {
    pub(crate) show: Show,
    /// The evidence about beams without a return, for each scanner of each log that has such beams.
    pub(crate) no_return: Vec<NoReturnEvidence>,
    /// Whether the pass was interrupted.
    pub(crate) is_interrupted: bool,
    /// Whether the recording and the trajectory are complete.
    pub(crate) is_shown: bool,
}

/// Learns from all logs along their trajectories, and writes what happens to `bag`. The recording and the trajectory are
/// written to `folder`.
pub(crate) fn learn(
    job: &Job,
    survey: &mut Survey,
    state_file: &mut SurveyStateFile,
    mut bag: Option<RunBag>,
    folder: &Path,
) -> Result<Learned, Failure> {
    let frame = survey.frame_of(survey.logs().len() - 1).map_err(input)?;
    let first = job.first.log.readings().map_err(input)?.next();
    let first = first.context("the log has no reading").map_err(input)?.map_err(input)?;
    let scene = Scene::of_log(&job.title(survey), frame, &job.settings.scan_filter().filter(first));
    let is_recorded = !job.args.no_rrd && !job.sources.is_empty();
    let recorder = if is_recorded { recorder(&folder.join(RECORDING), &scene)? } else { None };
    let mut learned = Learned {
        show: Show::new(scene, recorder, None),
        no_return: Vec::new(),
        is_interrupted: false,
        is_shown: true,
    };
    let mut trajectory = TrajectoryFile::create(&folder.join("trajectory.tum"));
    // Where an interrupted run has been before.
    for at in survey.logs().iter().flat_map(|log| log.poses()) {
        trajectory.add(at.time_s, &at.pose);
        learned.show.pass(&at.pose);
    }
    for number in 0..job.sources.len() {
        learned.replay(job, number, survey, (state_file, &mut trajectory, bag.as_mut()))?;
        if learned.is_interrupted {
            break;
        }
    }
    if let Some(mapper) = survey.mapper() {
        learned.show.end_in(*mapper.frame());
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
    let file = files::UnfinishedFile::create(path)?;
    Ok(Some(Recorder::new(Some(file), &[], scene.clone())?))
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
        number: usize,
        survey: &mut Survey,
        (state_file, trajectory, mut bag): (&mut SurveyStateFile, &mut TrajectoryFile, Option<&mut RunBag>),
    ) -> Result<(), Failure> {
        let (source, is_last_log) = (&job.sources[number], number + 1 == job.sources.len());
        let (name, log) = (&source.entry.name, job.first_log + number);
        let used = survey.logs().get(log).map_or(0, |log| log.used);
        match used {
            0 => tell(format_args!("{name}: learning what changes")),
            _ => tell(format_args!("{name}: learning what changes, from scan {} on", used + 1)),
        }
        let busy = Progress::of_work(format!("{name}: what beams without a return mean"));
        let replay = survey.replay(log, &source.log).map_err(input);
        drop(busy);
        let replay = replay?;
        let changed = || input(anyhow!("{name}: the log has changed since the first pass"));
        let mut replay = replay.ok_or_else(changed)?;
        for scanner in survey.no_returns().into_iter().filter(|scanner| scanner.silent > 0) {
            if let Some(ignored) = ignored(&scanner) {
                tell(format_args!("{name}: {ignored}"));
            }
            self.no_return.push(scanner);
        }
        let progress = Progress::of_count(source.log.summary().scans.saturating_sub(used), "scans");
        while let Some(turn) = survey.turn(&mut replay).map_err(input)? {
            progress.step();
            self.is_interrupted = job.is_interrupted();
            let Some(mapper) = survey.mapper() else { break };
            if let Some((bag, raw)) = bag.as_deref_mut().zip(replay.last()) {
                bag.add(raw, &turn, mapper, &NoPilot);
            }
            trajectory.add(turn.reading.time_s, &turn.belief.pose);
            let is_last = self.is_interrupted || replay.is_over() && is_last_log;
            if let Err(problem) = self.show.add(&View::of_log(&turn, mapper), is_last) {
                self.is_shown = false;
                progress.say(format_args!("error: {problem}; the run goes on without it"));
            }
            if replay.is_over() || state_file.is_due() {
                state_file.save(survey);
            }
            if self.is_interrupted {
                break;
            }
        }
        Ok(())
    }
}

/// What the user should know of a scanner that is not trusted.
pub(crate) fn ignored(scanner: &NoReturnEvidence) -> Option<String> {
    let why = match scanner.distrust()? {
        NoReturnDistrust::SeenShortly => {
            format!("{:.0} s of the scanner are too little to learn what they mean", scanner.learned_s)
        }
        NoReturnDistrust::SeldomJudged => {
            let beams = scanner.passing + scanner.ending;
            format!("only {beams} beams met surfaces that were hit before, too few to learn what they mean")
        }
        NoReturnDistrust::Swallows => {
            format!("surfaces swallow {} of the beams", percent(scanner.swallowed()))
        }
    };
    Some(format!("beams without a return are ignored: {why} (--no-return)"))
}
