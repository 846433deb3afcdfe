//! What the programs of both nodes share: their arguments, and where their sentences go.

use crate::names::Names;
use crate::notes::Output;
use crate::ros_args::RosArgs;
use clap::Parser;
use cli::program::{Failure, finish, input, with_arguments};
use std::io::stderr;
use std::process::ExitCode;

/// Runs a program with its own arguments and those of ROS, and returns its exit code.
pub fn start<A: Parser>(program: impl FnOnce(&A, RosArgs) -> Result<ExitCode, Failure>) -> ExitCode {
    let split = RosArgs::split(std::env::args_os()).map_err(input);
    finish(split.and_then(|(own, ros)| with_arguments(own, |args| program(args, ros))))
}

/// Writes a sentence to the error output.
pub fn say(text: &str) {
    cli::terminal::say(stderr(), text);
}

/// Says which files of parameters have none for a node: the name of the node in them is probably wrong.
pub fn note_unused_files(names: &Names, ros: &RosArgs) {
    let name = names.full_name();
    for file in ros.files_without(&name) {
        say(&format!("[{}] {file} has no parameters for the node {name}", names.node));
    }
}

/// Where the sentences of a node go: to the error output, each with the name of the node.
pub fn output(node: &str) -> Output {
    let node = node.to_owned();
    Box::new(move |text| say(&format!("[{node}] {text}")))
}
