//! What the command-line programs share: exit codes, Ctrl-C, parsers of arguments, lines for the user, progress, and a run
//! as a bag. It must not know the simulator.

pub mod bag;
pub mod flags;
pub mod program;
pub mod progress;
pub mod terminal;
