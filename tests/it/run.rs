//! One run of a program, in a separate folder.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
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

impl Run {
    /// A run of `four_rooms`.
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), program: "four_rooms" }
    }

    /// A run of `grid_world`.
    pub(crate) fn grid() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), program: "grid_world" }
    }

    /// A run of `house_trials`.
    pub(crate) fn houses() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), program: "house_trials" }
    }

    /// The same folder, for `map_log`.
    pub(crate) fn with_map_log(self) -> Self {
        Self { program: "map_log", ..self }
    }

    /// The same folder, for `predict`.
    pub(crate) fn with_predict(self) -> Self {
        Self { program: "predict", ..self }
    }

    /// The same folder, for `state_file`.
    pub(crate) fn with_state_file(self) -> Self {
        Self { program: "state_file", ..self }
    }

    /// The same folder, for `four_rooms`.
    pub(crate) fn with_four_rooms(self) -> Self {
        Self { program: "four_rooms", ..self }
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
        if !arguments.contains("--out") && !is_on_shards && self.program != "state_file" {
            command.args(["--out", "out"]);
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub(crate) fn ends(&self, arguments: &str) -> Ended {
        self.command(arguments).output().unwrap().into()
    }

    pub(crate) fn goes_well(&self, arguments: &str) -> Ended {
        let ended = self.ends(arguments);
        assert_eq!(ended.code, Some(0), "{arguments}: {ended:?}");
        ended
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
}

impl CellRow {
    /// The numbers of block events and of free events, in view or after a gap.
    pub(crate) fn events(&self) -> [u32; 2] {
        let (blocked, freed) = (self.block_events, self.free_events);
        [blocked + self.block_events_after_gap, freed + self.free_events_after_gap]
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
