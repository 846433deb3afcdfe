//! Arguments → parts → loop → results.

mod args;
mod combination;
mod output;
mod parts;
mod saves;

use agent::Policy;
use anyhow::{Context, anyhow};
use args::{Args, DriveChoice};
use curious::bag::RunBag;
use curious::flags::check_distinct;
use curious::program::{
    BEST_STRATEGY_GAIN, Failure, INTERRUPTED, input, interrupt_flag, results_folder, start,
};
use curious::progress::Progress;
use curious::terminal::{print, say};
use curious::worlds::list_physics_worlds;
use evaluation::metrics::map_scores;
use evaluation::physics_trial::PhysicsTrial;
use interfaces::{Reading, Twist};
use mapper::ReadingError;
use parts::Parts;
use results::file_name;
use results::output::{RunFolder, TrajectoryFile, UnfinishedFile, is_another_kind};
use robot::{ExactPoses, Pilot};
use saves::Saves;
use std::io::stderr;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use viewer::pictures::Film;
use viewer::recording::{Live, Recorder};
use viewer::scene::Scene;
use viewer::show::Show;
use viewer::view::{Measured, View};

/// The longest time for which a run that keeps to real time does not look for Ctrl-C.
const NAP: Duration = Duration::from_millis(50);

fn main() -> ExitCode {
    start(|args: &Args| {
        if args.list_worlds {
            list_physics_worlds()?;
            return Ok(ExitCode::SUCCESS);
        }
        run(args)
    })
}

/// The reason for the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ended {
    Duration,
    Pilot,
    Interrupted,
}

fn run(args: &Args) -> Result<ExitCode, Failure> {
    let Args { rrd, gif, mcap, state, .. } = args;
    let files = [("--rrd", rrd), ("--gif", gif), ("--mcap", mcap), ("--state", state)];
    let files = files.map(|(flag, file)| (flag, file.as_deref()));
    check_distinct(&[&files[..], &[("--out", Some(args.out.as_path()))]].concat()).map_err(input)?;
    let parts = Parts::new(args)?;
    match args.drive {
        DriveChoice::Agent => explore(args, &parts, parts.agent(args)?),
        DriveChoice::Tour => explore(args, &parts, parts.tour(args)?),
        DriveChoice::Keyboard => explore(args, &parts, parts.keyboard()?),
    }
}

/// Runs the robot in the world, and writes the results.
fn explore(args: &Args, parts: &Parts, pilot: impl Pilot<Command = Twist>) -> Result<ExitCode, Failure> {
    let Parts { spec, settings, prior } = parts;
    let trial = PhysicsTrial::new(spec, args.seed, settings, prior.clone(), pilot);
    let mut trial = trial.context("cannot make the mapper").map_err(input)?;
    let mut saves = Saves::open(args, parts, &mut trial)?;
    let began_s = trial.mapper.time();
    let is_interrupted = interrupt_flag()?; // before any file is made
    let mut folder = results_folder(&args.out)?;
    args.mcap.iter().try_for_each(|path| folder.adopt(path, "mcap")).map_err(input)?;
    let bag = args.mcap.as_deref().map(|path| RunBag::create(path, 0.0)).transpose();
    let bag = bag.context("cannot write the bag of --mcap").map_err(input)?;
    let mut show = show(args, Scene::from(spec.fleet()), &mut folder)?;
    if let Some(bag) = &bag {
        let inner = std::mem::replace(&mut trial.localization, Box::new(ExactPoses));
        trial.localization = Box::new(bag.recorded(inner));
    }
    let file = |name| TrajectoryFile::create(&folder.unfinished().join(name));
    let (mut used, mut truth) = (file("trajectory.tum"), file("trajectory_true.tum"));
    let reported = show.live_problem();
    reported.iter().for_each(|problem| say(stderr(), format_args!("note: {problem}")));

    let is_keyboard = args.drive == DriveChoice::Keyboard;
    if is_keyboard && !args.quiet {
        say(stderr(), "arrows or WASD drive, space stops, Q ends the run\r");
    }
    let speed = args.speed.unwrap_or(if is_keyboard { 1.0 } else { f64::INFINITY });
    let progress = Progress::of_time(args.duration, args.quiet, is_keyboard).from(began_s);
    if began_s > 0.0 && !args.quiet {
        progress.say(format_args!("the run goes on from {began_s:.1} s"));
    }
    let mut ended = match () {
        () if trial.pilot.is_done() => Some(Ended::Pilot),
        () if began_s >= args.duration => Some(Ended::Duration),
        () => None,
    };
    let mut is_shown = true;
    let start = Instant::now();
    while ended.is_none() {
        let went = trial.run_with(|world, reading, belief, pilot, observer| -> Result<_, ReadingError> {
            let show_progress =
                || progress.show(reading.time(), || map_scores(belief.mapper, world.truth()).coverage);
            show_progress();
            bag.iter().for_each(|bag| bag.add(belief, pilot));
            used.add(reading.time_s, belief.pose);
            truth.add(reading.time_s, world.true_pose());
            ended = match () {
                () if is_interrupted.load(Ordering::Relaxed) => Some(Ended::Interrupted),
                () if pilot.is_done() => Some(Ended::Pilot),
                () if reading.time() >= args.duration => Some(Ended::Duration),
                () => None,
            };
            let measured =
                Measured { scores: observer.scores(), rate_errors: None, messages: &observer.messages };
            if let Err(problem) =
                show.add(&View::new(world, reading, belief, pilot, measured), ended.is_some())
            {
                is_shown = false;
                progress.say(format_args!("error: {problem}; the run goes on without it"));
            }
            if ended.is_some() || saves.as_ref().is_some_and(Saves::is_due) {
                return Ok(ControlFlow::Break(()));
            }
            if speed.is_finite() {
                let due = Duration::from_secs_f64((reading.time() - began_s).max(0.0) / speed);
                // In short naps: an interrupted run ends soon.
                while start.elapsed() < due && !is_interrupted.load(Ordering::Relaxed) {
                    std::thread::sleep(due.saturating_sub(start.elapsed()).min(NAP));
                    show_progress();
                }
            }
            Ok(ControlFlow::Continue(()))
        });
        went.map_err(anyhow::Error::from)?;
        if ended.is_none()
            && let Some(saves) = &mut saves
            && let Err(problem) = saves.save(&mut trial)
        {
            is_shown = false;
            progress.say(format_args!("error: cannot save the state: {problem}; the run goes on"));
        }
    }
    let ended = ended.unwrap_or(Ended::Interrupted);
    let wall_s = start.elapsed().as_secs_f64();
    progress.finish();
    if let Some(problem) = show.live_problem().filter(|problem| Some(problem) != reported.as_ref()) {
        say(stderr(), format_args!("note: {problem}"));
    }

    if let Some(Err(problem)) = saves.map(|saves| saves.finish(&mut trial)) {
        is_shown = false;
        say(stderr(), format_args!("error: cannot save the state: {problem}"));
    }
    if let Some(Err(problem)) = bag.map(RunBag::finish) {
        is_shown = false;
        say(stderr(), format_args!("error: cannot write the bag: {problem:#}"));
    }
    for problem in [used, truth].into_iter().filter_map(|file| file.finish().err()) {
        is_shown = false;
        say(stderr(), format_args!("error: cannot write a trajectory: {problem}"));
    }

    let mut summary = output::summary(args, settings, &trial, ended, began_s, wall_s);
    let PhysicsTrial { mapper, pilot, observer, .. } = trial;
    drop(pilot); // restores the terminal before anything is printed
    output::write(&folder, &mapper, &show, &observer.goals, &mut summary)?;
    if let Err(problem) = show.write_film() {
        is_shown = false;
        say(stderr(), format_args!("error: {problem}"));
    }
    folder.finish(&[])?;
    if !args.quiet {
        let is_default = args.drive == DriveChoice::Agent && args.strategy() == Policy::default();
        let hint = if is_default { format!("\n  hint      {BEST_STRATEGY_GAIN}") } else { String::new() };
        print(format_args!("{summary}{hint}\n  files     {}", args.out.display()))?;
    }
    Ok(match ended {
        _ if !is_shown => ExitCode::FAILURE,
        Ended::Interrupted => ExitCode::from(INTERRUPTED),
        Ended::Duration | Ended::Pilot => ExitCode::SUCCESS,
    })
}

/// Opens everything that shows the run: the recording, viewers, the moving picture.
fn show(args: &Args, scene: Scene, folder: &mut RunFolder) -> Result<Show, Failure> {
    for (path, ending) in [(&args.rrd, "rrd"), (&args.gif, "gif")] {
        path.iter().try_for_each(|path| folder.adopt(path, ending)).map_err(input)?;
    }
    if let Some(path) = args.gif.as_ref().filter(|path| is_another_kind(path, b"GIF8")) {
        let path = path.display();
        return Err(input(anyhow!("there is a file {path} that is not a GIF picture; choose another name")));
    }
    let mut live = Vec::from_iter(args.connect.clone());
    live.extend(args.view.then_some(Live::Spawn));
    let named = || folder.reserve(&format!("{}.rrd", file_name::of(&scene.title)));
    let file = (!args.no_rrd).then(|| args.rrd.clone().map_or_else(named, Ok)).transpose()?;
    let recorder = match &file {
        None if live.is_empty() => None,
        file => Some(Recorder::new(file.as_deref(), &live, scene.clone()).map_err(anyhow::Error::from)?),
    };
    let gif = args.gif.as_deref().map(UnfinishedFile::create).transpose().map_err(anyhow::Error::from)?;
    let film = gif.map(|file| Film::new(file, scene.clone(), args.duration));
    Ok(Show::new(scene, recorder, film))
}
