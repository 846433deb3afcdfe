//! Runs a program in a pseudo-terminal.
#![cfg(target_os = "linux")]

use crate::run::{Ended, Run};
use nix::pty::{Winsize, openpty};
use std::fs::File;
use std::io::Read;
use std::process::Stdio;

/// The width of the terminal: half of a screen.
pub(crate) const COLUMNS: u16 = 60;
const SIZE: Winsize = Winsize { ws_row: 24, ws_col: COLUMNS, ws_xpixel: 0, ws_ypixel: 0 };

/// Runs the program; standard error is joined with standard output.
pub(crate) fn run(run: &Run, arguments: &str) -> Ended {
    let terminal = openpty(&SIZE, None).unwrap();
    let mut command = run.command(arguments);
    let screen = || Stdio::from(terminal.slave.try_clone().unwrap());
    command.stdin(screen()).stdout(screen()).stderr(screen());
    let mut child = command.spawn().unwrap();
    // Now only the program holds the terminal: reading ends when the program ends.
    drop((command, terminal.slave));
    let mut screen = File::from(terminal.master);
    let reader = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // On Linux, reading a closed terminal ends with an error.
        _ = screen.read_to_end(&mut bytes);
        bytes
    });
    let status = child.wait().unwrap();
    let stdout = String::from_utf8(reader.join().unwrap()).unwrap();
    Ended { code: status.code(), stdout, stderr: String::new() }
}
