//! Arguments → parts → loop → results.

mod args;
mod output;
mod parts;

use args::{Args, DriveChoice};
use cli::flags::check_distinct;
use cli::program::{Failure, INTERRUPTED, input, interrupt_flag, start};
use cli::terminal::be_quiet;
use curious::worlds::list_physics_worlds;
use evaluation::physics_trial::PhysicsTrial;
use interfaces::Twist;
use output::Outputs;
use parts::{Parts, TrialStateFile};
use robot::Pilot;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::Instant;

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
    be_quiet(args.quiet);
    let Args { rrd, gif, mcap, state, .. } = args;
    let files = [("--rrd", rrd), ("--gif", gif), ("--mcap", mcap), ("--state", state)];
    let files = files.map(|(flag, file)| (flag, file.as_deref()));
    check_distinct(&[&files[..], &[("--out", Some(args.out.as_path()))]].concat()).map_err(input)?;
    let parts = Parts::new(args)?;
    match args.drive {
        DriveChoice::Agent if parts.spec.driven().patrol.is_some() => {
            explore(args, &parts, parts.trial(args, parts.agent_with_day(args)?)?.on_battery())
        }
        DriveChoice::Agent => explore(args, &parts, parts.trial(args, parts.agent(args)?)?),
        DriveChoice::Tour => explore(args, &parts, parts.trial(args, parts.tour(args)?)?),
    }
}

/// Runs the robot in the world, and writes the results.
fn explore(
    args: &Args,
    parts: &Parts,
    mut trial: PhysicsTrial<impl Pilot<Command = Twist>>,
) -> Result<ExitCode, Failure> {
    let state_file = TrialStateFile::open(args, parts, &mut trial)?;
    let is_interrupted = interrupt_flag()?; // before any file is made
    let mut outputs = Outputs::open(args, trial.world.spec(), state_file, trial.robot.mapper.time())?;
    let start = Instant::now();
    let mut ended = end(args, &trial, false);
    while ended.is_none() {
        let turn = trial.turn().map_err(anyhow::Error::from)?;
        ended = end(args, &trial, is_interrupted.load(Ordering::Relaxed));
        outputs.add(&mut trial, &turn, ended.is_some());
        if ended.is_none() {
            outputs.save(&mut trial);
            outputs.keep_pace(turn.reading.time_s, start, &is_interrupted);
        }
    }
    let ended = ended.unwrap_or(Ended::Interrupted);
    let is_complete = outputs.finish(&parts.settings, trial, ended, start.elapsed().as_secs_f64())?;
    Ok(match ended {
        _ if !is_complete => ExitCode::FAILURE,
        Ended::Interrupted => ExitCode::from(INTERRUPTED),
        Ended::Duration | Ended::Pilot => ExitCode::SUCCESS,
    })
}

/// Why the run ends now, if it does.
fn end(
    args: &Args,
    trial: &PhysicsTrial<impl Pilot<Command = Twist>>,
    is_interrupted: bool,
) -> Option<Ended> {
    let reasons = [
        (is_interrupted, Ended::Interrupted),
        (trial.robot.pilot.view().is_done, Ended::Pilot),
        (trial.robot.mapper.time() >= args.duration, Ended::Duration),
    ];
    reasons.into_iter().find_map(|(holds, reason)| holds.then_some(reason))
}
