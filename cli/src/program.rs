//! Code that the command-line programs share: exit codes, Ctrl-C, the list of worlds, parsers of arguments.

use crate::terminal::{check_printed, note, print, say};
use anyhow::{Context, anyhow};
use clap::Parser;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use files::{OutputError, RunFolder};
use interfaces::PoseMode;
use robot::state::{State, StateFile};
use std::ffi::OsString;
use std::fmt::Display;
use std::io::{ErrorKind, stderr};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The exit code of a run that Ctrl-C or another signal has ended.
pub const INTERRUPTED: u8 = 130;

/// The reason why a program has no result.
#[derive(Debug)]
pub enum Failure {
    /// An argument or an input file is invalid: exit code 2.
    Input(anyhow::Error),
    /// The run failed: exit code 1.
    Run(anyhow::Error),
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Run(error)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        if error.is_refusal() { Self::Input(error.into()) } else { Self::Run(error.into()) }
    }
}

/// The failure for an output that cannot be opened: it needs another name, unless another run or the disk is the reason.
pub fn not_opened(error: OutputError) -> Failure {
    let is_of_kind = matches!(error.why.kind(), ErrorKind::ResourceBusy | ErrorKind::StorageFull);
    // An error of the disk, too little memory, too many open files.
    let is_of_system = matches!(error.why.raw_os_error(), Some(5 | 12 | 23 | 24));
    if is_of_kind || is_of_system { Failure::Run(error.into()) } else { input(error) }
}

/// Opens the folder of `--out`, and tells the user what it has besides the results of an earlier run.
///
/// # Errors
///
/// As [`RunFolder::open`].
pub fn results_folder(out: &Path) -> Result<RunFolder, Failure> {
    let folder = RunFolder::open(out).map_err(not_opened)?;
    folder.notes().iter().for_each(note);
    Ok(folder)
}

/// Opens the file of `--state`, which is saved in intervals of wall time, s, and reads the state in it, if there is one.
///
/// # Errors
///
/// When the file cannot be used or read, or is no state.
pub fn open_state(path: &Path, every_s: f64) -> Result<(StateFile, Option<State>), Failure> {
    let mut file =
        StateFile::open(path).map_err(|why| state_failure(path, format_args!("cannot use it: {why}")))?;
    let state = file.load().map_err(|why| state_failure(path, why))?;
    Ok((file.every(Duration::from_secs_f64(every_s)), state))
}

/// A state file with something invalid.
pub fn state_failure(path: &Path, why: impl Display) -> Failure {
    input(anyhow!("{}: {why}", path.display()))
}

/// The command line without the name of the program; what is no text in it is replaced.
pub fn arguments() -> Vec<String> {
    std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()).collect()
}

/// An invalid argument or input file.
pub fn input(error: impl Into<anyhow::Error>) -> Failure {
    Failure::Input(error.into())
}

/// Runs `program` with its command line, and returns its exit code; a failure is printed to the error output.
pub fn start<A: Parser>(program: impl FnOnce(&A) -> Result<ExitCode, Failure>) -> ExitCode {
    finish(with_arguments(std::env::args_os(), program))
}

/// Runs `program` with a command line, or prints the help that it asks for, or what is invalid.
///
/// # Errors
///
/// Those of the program.
pub fn with_arguments<A: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    program: impl FnOnce(&A) -> Result<ExitCode, Failure>,
) -> Result<ExitCode, Failure> {
    match A::try_parse_from(arguments) {
        Ok(args) => program(&args),
        Err(invalid) if invalid.use_stderr() => {
            say(stderr(), invalid.render().to_string().trim_end()); // with what was given: perhaps not printable
            Ok(ExitCode::from(2))
        }
        Err(help) => check_printed(help.print()).map(|()| ExitCode::SUCCESS).map_err(Failure::Run),
    }
}

/// The exit code of a program; a failure is printed to the error output.
pub fn finish(result: Result<ExitCode, Failure>) -> ExitCode {
    let (code, error) = match result {
        Ok(code) => return code,
        Err(Failure::Input(error)) => (2, error),
        Err(Failure::Run(error)) => (1, error),
    };
    say(stderr(), format_args!("error: {error:#}"));
    ExitCode::from(code)
}

/// A flag that Ctrl-C, SIGTERM and SIGHUP set, instead of ending the program. A file that would be larger than the
/// operating system allows (`ulimit -f`) does not end the program either: its writing fails.
///
/// # Errors
///
/// When the operating system does not allow it.
pub fn interrupt_flag() -> anyhow::Result<Arc<AtomicBool>> {
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default())
        .context("cannot listen for signals")?;
    let is_interrupted = Arc::new(AtomicBool::new(false));
    let flag = is_interrupted.clone();
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("cannot listen for Ctrl-C")?;
    Ok(is_interrupted)
}

/// Prints shipped worlds, one per line: the name, in a column of `width`, and the description.
///
/// # Errors
///
/// When the standard output cannot be written.
pub fn list<E: Display>(
    worlds: &[(&str, &str)],
    width: usize,
    describe: impl Fn(&str) -> Result<String, E>,
) -> anyhow::Result<()> {
    for (name, _) in worlds {
        match describe(name) {
            Ok(description) => print(format_args!("{name:<width$} {description}"))?,
            Err(error) => say(stderr(), error),
        }
    }
    Ok(())
}

/// A parser of the name of one of `all`. `describe` gives the name of a value, and what it means unless that is explained elsewhere.
pub fn one_of<T>(
    all: Vec<T>,
    describe: fn(&T) -> (&'static str, Option<&'static str>),
) -> impl TypedValueParser<Value = T>
where
    T: Clone + Send + Sync + 'static,
{
    let named = |value: &T| {
        let (name, meaning) = describe(value);
        let value = PossibleValue::new(name);
        if let Some(meaning) = meaning { value.help(meaning) } else { value }
    };
    PossibleValuesParser::new(all.iter().map(named)).try_map(move |name| {
        all.iter().find(|value| describe(value).0 == name).cloned().ok_or("not one of the possible values")
    })
}

/// What the ways to know the pose mean in a simulated world.
pub fn pose_in_world(mode: &PoseMode) -> (&'static str, Option<&'static str>) {
    let meaning = match mode {
        PoseMode::Exact => "The true pose",
        PoseMode::Odometry => "The pose by odometry, with its drift: the map becomes wrong",
        PoseMode::Localized => "The pose that fits the scan to the map",
        PoseMode::Corrected => "The poses of another SLAM: of logs only",
    };
    (mode.name(), Some(meaning))
}

/// The longest run, s: 1000 hours.
const MAX_DURATION_S: f64 = 3.6e6;

/// A simulated time, s: a number of seconds, or with a unit.
///
/// # Errors
///
/// When the text is no time, or the time is not above 0 and at most 1000 hours.
pub fn duration_s(text: &str) -> Result<f64, String> {
    let (number, unit_s) = match text.char_indices().next_back() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        Some((at, 'd')) => (&text[..at], 86_400.0),
        _ => (text, 1.0),
    };
    let time_s = number.trim().parse::<f64>().unwrap_or(f64::NAN) * unit_s;
    if time_s > 0.0 && time_s <= MAX_DURATION_S {
        Ok(time_s)
    } else {
        Err("must be a time above 0 and at most 1000h: seconds, or with a unit as in 90s, 20m, 1h".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        assert_eq!(duration_s("1200"), Ok(1200.0));
        assert_eq!(duration_s("20m"), Ok(1200.0));
        assert_eq!(duration_s("0.5h"), Ok(1800.0));
        assert_eq!(duration_s("7d"), Ok(604_800.0));
        for wrong in ["", "m", "-1", "0", "nan", "inf", "1001h", "ten"] {
            assert!(duration_s(wrong).is_err(), "{wrong}");
        }
    }
}
