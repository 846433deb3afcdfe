//! The Rerun recording of a run, in a file and in a live viewer.
//!
//! [`Recorder::log`] is called at every tick and decides how often each entity is logged. The rows are sent every
//! second, so that a killed run loses at most one second.
//!
//! To add an entity: write a function in `tracks/`, and add a line to `start` in `tracks/mod.rs`. For data that
//! [`View`] does not have yet, also add a field to [`View`] and set it.

mod file;
mod layout;
mod live;
mod tracks;

pub use live::{Live, LiveError};

use draw::scene::Scene;
use draw::view::View;
use file::Sinks;
use files::UnfinishedFile;
use rerun::log::ChunkBatcherConfig;
use rerun::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tracks::Track;

/// The error for a recording that cannot be made, or cannot continue.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be written.
    #[error("cannot write the recording {}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The message of the operating system.
        why: String,
    },
    /// No viewer can show the run, and there is no file.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// The SDK refused the data.
    #[error("cannot record the run: {0}")]
    Sdk(String),
}

/// The name of this program in the viewer, which keeps its settings under that name.
const APPLICATION: &str = "curious";
/// The maximum time that rows wait before they are sent, in wall time.
const FLUSH_FILE: Duration = Duration::from_secs(1);
/// The maximum time that rows wait before they are sent while a live viewer is connected, in wall time.
const FLUSH_LIVE: Duration = Duration::from_millis(50);

impl From<RecordingStreamError> for RecordingError {
    fn from(error: RecordingStreamError) -> Self {
        sdk(error)
    }
}

/// A recording in progress.
pub struct Recorder {
    stream: RecordingStream,
    sinks: Sinks,
    scene: Scene,
    /// Made at the first view, which shows what can be logged.
    tracks: Option<Vec<Box<dyn Track>>>,
    flushed: Instant,
    /// The simulated time of the last flush, s.
    flushed_at_s: f64,
    live_problem: Option<String>,
}

impl Recorder {
    /// Begins the `.rrd` file (an older recording is replaced when this one is complete) and opens the
    /// viewers that show the run live. A viewer that cannot be reached does not stop a recording with a file:
    /// see [`Recorder::live_problem`].
    ///
    /// # Errors
    ///
    /// When the file cannot be written, or when there is no file and a viewer cannot be reached. Both are
    /// known within five seconds, unless a viewer has to be started.
    pub fn new(file: Option<UnfinishedFile>, live: &[Live], scene: Scene) -> Result<Self, RecordingError> {
        let (sinks, live_problem) = Sinks::open(file, live)?;
        let (_, info, properties, ..) =
            RecordingStreamBuilder::new(APPLICATION).recording_name(scene.title.clone()).into_args();
        // Rows are sent in columns: the SDK has nothing to batch.
        let batching = Some(ChunkBatcherConfig::NEVER);
        let stream =
            RecordingStream::new(info, properties, batching, Default::default(), Box::new(sinks.clone()))?;
        let flushed = Instant::now();
        Ok(Self { stream, sinks, scene, tracks: None, flushed, flushed_at_s: 0.0, live_problem })
    }

    /// Records the present state of the run. The last view has every map, and closes the recording.
    ///
    /// # Errors
    ///
    /// When the file can no longer be written; at the end, when a part of the recording could not be written. The
    /// file is removed then; viewers go on, see [`Recorder::is_live`].
    pub fn log(&mut self, view: &View, is_last: bool) -> Result<(), RecordingError> {
        if self.tracks.is_none() {
            // A viewer's y axis points down.
            self.stream.log_static(tracks::WORLD, &rerun::Transform3D::from_scale([1.0, -1.0, 1.0]))?;
            self.tracks = Some(tracks::start(&self.stream, &self.scene, view)?);
            layout::send(&self.stream, APPLICATION, &self.scene, view)?;
            self.stream.flush_async().map_err(sdk)?;
        }
        self.tracks.iter_mut().flatten().for_each(|track| track.push(view, is_last));
        let wait = if self.sinks.is_live() { FLUSH_LIVE } else { FLUSH_FILE };
        // Maps at hundreds of times real time fill the memory.
        let is_much = view.time_s - self.flushed_at_s >= 60.0;
        if is_last || is_much || self.flushed.elapsed() >= wait {
            self.flushed_at_s = view.time_s;
            self.flush()?;
        }
        if is_last {
            self.stream.flush_blocking().map_err(sdk)?;
            self.sinks.finish()?;
        }
        Ok(())
    }

    /// Whether a viewer shows the run.
    pub fn is_live(&self) -> bool {
        self.sinks.is_live()
    }

    /// Why a viewer does not show the run, or shows it no longer. The file is not affected.
    pub fn live_problem(&self) -> Option<String> {
        self.live_problem.clone().or_else(|| self.sinks.live_problem())
    }

    /// Sends the rows that wait.
    fn flush(&mut self) -> Result<(), RecordingError> {
        self.flushed = Instant::now();
        let stream = &self.stream;
        self.tracks.iter_mut().flatten().try_for_each(|track| track.flush(stream))?;
        self.sinks.check()
    }
}

fn sdk(error: impl std::fmt::Display) -> RecordingError {
    RecordingError::Sdk(error.to_string())
}

#[cfg(test)]
mod tests;
