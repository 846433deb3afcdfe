//! Lines for the user. Results go to the standard output; errors, warnings and progress go to the error output. All of them
//! are printable: they hold names and values from files.

use anyhow::Context;
use interfaces::{printable, printable_lines};
use std::fmt::Display;
use std::io::{self, ErrorKind, Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};

/// Prints lines to the error output. A failure is ignored: there is no other place to report it.
pub fn say(mut to: impl Write, what: impl Display) {
    let _ = writeln!(to, "{}", printable_lines(&what.to_string()));
}

/// Whether only errors are printed.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on, only errors are printed, if `is_quiet`: `--quiet`.
pub fn be_quiet(is_quiet: bool) {
    QUIET.store(is_quiet, Ordering::Relaxed);
}

/// Whether only errors are printed.
pub(crate) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints lines about the work to the error output, unless only errors are printed.
pub fn tell(what: impl Display) {
    if !is_quiet() {
        say(stderr(), what);
    }
}

/// The same of a note.
pub fn note(what: impl Display) {
    tell(format_args!("note: {what}"));
}

/// Prints one line to the standard output: a line break in a name forges no other one.
///
/// # Errors
///
/// As [`print_lines`].
pub fn print(what: impl Display) -> anyhow::Result<()> {
    print_lines(printable(&what.to_string()))
}

/// Prints lines to the standard output, unless only errors are printed.
///
/// # Errors
///
/// When the line cannot be written, for example to a file on a full disk. A closed pipe (for example `| head`) is
/// no error.
pub fn print_lines(what: impl Display) -> anyhow::Result<()> {
    if is_quiet() {
        return Ok(());
    }
    let mut to = stdout().lock();
    check_printed(writeln!(to, "{}", printable_lines(&what.to_string())).and_then(|()| to.flush()))
}

/// The outcome of writing to the standard output; see [`print_lines`].
pub(crate) fn check_printed(outcome: io::Result<()>) -> anyhow::Result<()> {
    match outcome {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        outcome => outcome.context("cannot write to the standard output"),
    }
}
