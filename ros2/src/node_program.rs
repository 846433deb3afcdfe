//! What the programs of both nodes share: exit codes, messages, signals.

use crate::names::Names;
use crate::notes::Output;
use crate::ros_args::RosArgs;
use clap::Parser;
use interfaces::printable_lines;
use std::io::Write;
use std::process::ExitCode;

/// The reason why a program ends without a result.
#[derive(Debug)]
pub enum Failure {
    /// An argument or a file is not valid: exit code 2.
    Input(anyhow::Error),
    /// The run failed: exit code 1.
    Run(anyhow::Error),
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Run(error)
    }
}

/// An argument or a file that is not valid.
pub fn input(error: impl Into<anyhow::Error>) -> Failure {
    Failure::Input(error.into())
}

/// Runs a program with its own arguments and those of ROS, and returns its exit code.
pub fn start<A: Parser>(program: impl FnOnce(A, RosArgs) -> Result<(), Failure>) -> ExitCode {
    let run = || {
        let (own, ros) = RosArgs::split(std::env::args_os()).map_err(input)?;
        match A::try_parse_from(own) {
            Ok(args) => program(args, ros),
            Err(message) if message.use_stderr() => message.exit(),
            Err(help) => help.print().map_err(|why| Failure::Run(why.into())),
        }
    };
    let (code, error) = match run() {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Input(error)) => (2, error),
        Err(Failure::Run(error)) => (1, error),
    };
    say(&format!("error: {}", printable_lines(&format!("{error:#}"))));
    ExitCode::from(code)
}

/// Writes a sentence to the error output.
pub fn say(text: &str) {
    // Nobody reads it: the node goes on.
    writeln!(std::io::stderr(), "{text}").ok();
}

/// Says which files of parameters have none for a node: the name of the node in them is probably wrong.
pub fn note_unused_files(names: &Names, ros: &RosArgs) {
    let name = names.full_name();
    for file in ros.files_without(&name) {
        say(&format!("[{}] {file} has no parameters for the node {name}", names.node()));
    }
}

/// Where the sentences of a node go: to the error output, each with the name of the node.
pub fn output(node: &str) -> Output {
    let node = node.to_owned();
    Box::new(move |text| say(&format!("[{node}] {text}")))
}
