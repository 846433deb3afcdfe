//! Lines for the user. Results go to the standard output; errors, warnings and progress go to the error output.

use anyhow::Context;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write, stdout};

/// Prints a line to the error output. A failure is ignored: there is no other place to report it.
pub fn say(mut to: impl Write, what: impl Display) {
    let _ = writeln!(to, "{what}");
}

/// Prints a line to the standard output.
///
/// # Errors
///
/// When the line cannot be written, for example to a file on a full disk. A closed pipe (for example `| head`) is
/// no error.
pub fn print(what: impl Display) -> anyhow::Result<()> {
    let mut to = stdout().lock();
    check_printed(writeln!(to, "{what}").and_then(|()| to.flush()))
}

/// The outcome of writing to the standard output; see [`print`].
pub(crate) fn check_printed(outcome: io::Result<()>) -> anyhow::Result<()> {
    match outcome {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        outcome => outcome.context("cannot write to the standard output"),
    }
}
