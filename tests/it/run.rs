//! One run of a program, in a separate folder.

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// All programs but those of ROS 2.
pub(crate) const PROGRAMS: [&str; 7] =
    ["four_rooms", "map_log", "predict", "grid_world", "house_trials", "check_world", "state_file"];

/// The file of a program. Those of another package are beside those of this one: `cargo test` builds all.
pub(crate) fn program(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_BIN_EXE_four_rooms")).with_file_name(name);
    assert!(path.exists(), "there is no {}: cargo build --bins", path.display());
    path
}

/// A folder in which a program runs. All output goes to the subfolder `out`, unless the arguments name another
/// folder.
pub(crate) struct Run {
    folder: TempDir,
    program: &'static str,
}

/// The exit status of a run, and its output.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

impl Ended {
    /// Waits for the end of a program.
    pub(crate) fn of(child: Child) -> Self {
        child.wait_with_output().unwrap().into()
    }

    /// Standard output has these texts.
    #[track_caller]
    pub(crate) fn prints(&self, texts: &[&str]) {
        texts.iter().for_each(|text| assert!(self.stdout.contains(text), "{text}: {}", self.stdout));
    }

    /// The error output has these texts.
    #[track_caller]
    pub(crate) fn says(&self, texts: &[&str]) {
        texts.iter().for_each(|text| assert!(self.stderr.contains(text), "{text}: {}", self.stderr));
    }
}

/// Waits until something is so, at most for a minute.
#[track_caller]
pub(crate) fn wait_until(mut is_so: impl FnMut() -> bool) {
    let is_in_time = (0..6000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        is_so()
    });
    assert!(is_in_time, "it does not come to this");
}

impl Run {
    /// A run of `four_rooms`.
    pub(crate) fn new() -> Self {
        Self::of("four_rooms")
    }

    pub(crate) fn of(program: &'static str) -> Self {
        Self { folder: tempfile::tempdir().unwrap(), program }
    }

    /// The same folder, for another program.
    pub(crate) fn with(self, program: &'static str) -> Self {
        Self { program, ..self }
    }

    /// A finished run of `four_rooms` without a recording, which must succeed; arguments are separated by spaces.
    pub(crate) fn quiet(arguments: &str) -> Self {
        let run = Self::new();
        run.goes_well(&format!("--quiet --no-rrd {arguments}"));
        run
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The path of a file in the output folder.
    pub(crate) fn out(&self, name: &str) -> PathBuf {
        self.path("out").join(name)
    }

    /// The path of a recording in the output folder before the run is finished.
    pub(crate) fn unfinished(&self, name: &str) -> PathBuf {
        self.out("unfinished_run").join(name.replace(".rrd", ".unfinished.rrd"))
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// The program with its arguments, not started yet.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(program(self.program));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        let is_on_shards = ["missing ", "merge ", "status "].iter().any(|name| arguments.starts_with(name));
        let has_folder = !["state_file", "check_world"].contains(&self.program);
        if !arguments.contains("--out") && !is_on_shards && has_folder {
            command.args(["--out", "out"]);
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub(crate) fn ends(&self, arguments: &str) -> Ended {
        self.command(arguments).output().unwrap().into()
    }

    #[track_caller]
    pub(crate) fn goes_well(&self, arguments: &str) -> Ended {
        let ended = self.ends(arguments);
        assert_eq!(ended.code, Some(0), "{arguments}: {ended:?}");
        ended
    }

    /// The error output of the program for invalid `arguments`: one error, the exit code 2, and nothing is written.
    #[track_caller]
    pub(crate) fn refuses(&self, arguments: &str) -> String {
        let before = self.names();
        let Ended { code, stdout, stderr } = self.ends(arguments);
        let errors = stderr.lines().filter(|line| line.starts_with("error: ")).count();
        assert_eq!((code, stdout.as_str(), errors), (Some(2), "", 1), "{arguments}: {stderr}");
        assert_eq!(self.names(), before, "something was written");
        stderr
    }

    /// A program that may write files of this number of blocks of 512 bytes.
    pub(crate) fn ends_with_files_up_to(&self, blocks: u32, arguments: &str) -> Ended {
        let program = self.command(arguments);
        let mut limited = Command::new("sh");
        limited.args(["-c", &format!("ulimit -f {blocks} && exec \"$0\" \"$@\"")]).arg(program.get_program());
        limited.args(program.get_args()).current_dir(&self.folder).output().unwrap().into()
    }

    /// Sends Ctrl-C to the program after a line on its error output.
    #[cfg(unix)]
    pub(crate) fn interrupted(&self, arguments: &str, after: impl Fn(&str) -> bool) -> Ended {
        let mut child = self.starts(arguments);
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        let mut stderr = String::new();
        loop {
            let line = lines.next().expect("a line that is waited for");
            stderr += &format!("{line}\n");
            if after(&line) {
                break;
            }
        }
        crate::ending::send(nix::sys::signal::Signal::SIGINT, &child);
        lines.for_each(|line| stderr += &format!("{line}\n"));
        Ended { stderr, ..Ended::of(child) }
    }

    pub(crate) fn starts(&self, arguments: &str) -> Child {
        self.command(arguments).spawn().unwrap()
    }

    pub(crate) fn summary(&self) -> Summary {
        Summary(serde_json::from_slice(&std::fs::read(self.out("summary.json")).unwrap()).unwrap())
    }

    /// The names of the files in the folder of the run, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        names(self.folder.path())
    }

    /// The rows of cell_statistics.csv.
    pub(crate) fn cells(&self) -> Vec<CellRow> {
        let mut table = csv::Reader::from_path(self.out("cell_statistics.csv")).unwrap();
        table.deserialize().map(|row| row.unwrap()).collect()
    }
}

/// The names of the files in a folder, sorted, without hidden ones (the list of the results in `.curious_run.json`).
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    names
}

/// The columns of a row of cell_statistics.csv that the tests read.
#[derive(serde::Deserialize)]
pub(crate) struct CellRow {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    pub(crate) column: usize,
    pub(crate) row: usize,
    pub(crate) state: String,
    block_events: u32,
    free_events: u32,
    block_events_after_gap: u32,
    free_events_after_gap: u32,
    pub(crate) interval_s: f64,
    pub(crate) rate_hz: f64,
    pub(crate) recency_s: f64,
    watched_free_s: f64,
    watched_blocked_s: f64,
}

impl CellRow {
    /// The numbers of block events and of free events, in view or after a gap.
    pub(crate) fn events(&self) -> [u32; 2] {
        let (blocked, freed) = (self.block_events, self.free_events);
        [blocked + self.block_events_after_gap, freed + self.free_events_after_gap]
    }

    pub(crate) fn watched_s(&self) -> f64 {
        self.watched_free_s + self.watched_blocked_s
    }
}

/// The content of summary.json.
#[derive(Clone, Debug)]
pub(crate) struct Summary(pub(crate) Value);

impl Summary {
    /// The value at a path such as `/goals/reached`.
    pub(crate) fn at(&self, path: &str) -> &Value {
        self.0.pointer(path).unwrap_or_else(|| panic!("{path} is not in the summary"))
    }

    pub(crate) fn number(&self, path: &str) -> f64 {
        self.at(path).as_f64().unwrap_or_else(|| panic!("{path} is {}", self.at(path)))
    }

    pub(crate) fn text(&self, path: &str) -> &str {
        self.at(path).as_str().unwrap_or_else(|| panic!("{path} is {}", self.at(path)))
    }

    pub(crate) fn hash(&self) -> &str {
        self.text("/map_hash")
    }

    /// Time, coverage and map quality.
    pub(crate) fn curve(&self) -> Vec<[f64; 3]> {
        let points = self.at("/curve").as_array().unwrap();
        let numbers =
            |point: &Value| ["time_s", "coverage", "map_quality"].map(|k| point[k].as_f64().unwrap());
        points.iter().map(numbers).collect()
    }
}
