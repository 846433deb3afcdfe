//! Code that the command-line programs share: exit codes, Ctrl-C, the list of worlds, parsers of arguments.

use anyhow::Context;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use evaluation::output::say;
use interfaces::printable_lines;
use std::error::Error;
use std::fmt::Display;
use std::io::{stderr, stdout};
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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

/// An invalid argument or input file.
pub fn input(error: impl Into<anyhow::Error>) -> Failure {
    Failure::Input(error.into())
}

/// The exit code of a program; a failure is printed to the error output.
pub fn exit_code(result: Result<ExitCode, Failure>) -> ExitCode {
    let (code, error) = match result {
        Ok(code) => return code,
        Err(Failure::Input(error)) => (2, error),
        Err(Failure::Run(error)) => (1, error),
    };
    say(stderr(), format_args!("error: {}", printable_lines(&format!("{error:#}"))));
    ExitCode::from(code)
}

/// A flag that Ctrl-C, SIGTERM and SIGHUP set, instead of ending the program.
///
/// # Errors
///
/// When the operating system does not allow it.
pub fn interrupt_flag() -> anyhow::Result<Arc<AtomicBool>> {
    let is_interrupted = Arc::new(AtomicBool::new(false));
    let flag = is_interrupted.clone();
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("cannot listen for Ctrl-C")?;
    Ok(is_interrupted)
}

/// Prints shipped worlds, one per line: the name, in a column of `width`, and the description.
pub fn list<E: Display>(worlds: &[(&str, &str)], width: usize, describe: impl Fn(&str) -> Result<String, E>) {
    for (name, _) in worlds {
        match describe(name) {
            Ok(description) => say(stdout(), format_args!("{name:<width$} {description}")),
            Err(error) => say(stderr(), error),
        }
    }
}

/// A parser of the name of one of `all`.
pub fn one_of<T>(all: Vec<T>, name: fn(&T) -> &'static str) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Error + Send + Sync> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(all.iter().map(name)).try_map(|name| name.parse::<T>())
}
