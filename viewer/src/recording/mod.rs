//! The recording of a run, and the live view of it. The only place that knows Rerun.
//!
//! [`Recorder::log`] is called at every tick and decides by itself what to log how often; the rows
//! are handed on every second, so that a killed run loses no more than that.

mod blueprint;
mod columns;
mod entity;
mod file;
mod live;
mod outline;
mod pace;
mod scenery;
mod sight;
mod sinks;
mod tracks;

pub use live::{Live, LiveError};

use crate::view::{Scene, View};
use pace::Pace;
use rerun::log::ChunkBatcherConfig;
use rerun::{RecordingStream, RecordingStreamBuilder};
use sinks::Sinks;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tracks::Tracks;

/// Where a recording goes: to a file, to viewers, or to all of them at once.
#[derive(Clone, Debug)]
pub struct RecordingOptions {
    /// The `.rrd` file to write; an older one is replaced.
    pub file: Option<PathBuf>,
    /// The viewers to show the run in while it goes on.
    pub live: Vec<Live>,
    /// The viewer's program, for [`Live::Spawn`].
    pub viewer: String,
}

impl Default for RecordingOptions {
    fn default() -> Self {
        Self { file: None, live: Vec::new(), viewer: live::PROGRAM.into() }
    }
}

/// Why a recording cannot be made, or go on.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be written.
    #[error("cannot write the recording {}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        why: String,
    },
    /// The viewer cannot be shown anything, and there is no file either.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// The SDK refused what it was given.
    #[error("cannot record the run: {0}")]
    Sdk(String),
}

/// The name under which a viewer keeps what belongs to this program.
const APPLICATION: &str = "curious";
/// How long rows may wait before they are handed on, in wall time.
const FLUSH_FILE: Duration = Duration::from_secs(1);
/// The same while a viewer watches.
const FLUSH_LIVE: Duration = Duration::from_millis(50);

/// A recording being made.
pub struct Recorder {
    stream: RecordingStream,
    sinks: Sinks,
    scene: Scene,
    /// Built at the first view, which tells who takes part.
    tracks: Option<Tracks>,
    flushed: Instant,
    /// In the unit of the scene.
    flushed_at: f64,
    live_problem: Option<String>,
}

impl Recorder {
    /// Opens the file and the viewers. A viewer that cannot be reached does not stop a recording
    /// that has a file: [`Recorder::live_problem`] tells about it.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, or there is no file and a viewer cannot be reached. Both
    /// are known within two seconds, unless a viewer has to be started.
    pub fn new(options: &RecordingOptions, scene: Scene) -> Result<Self, RecordingError> {
        let (sinks, live_problem) = Sinks::open(options)?;
        let (_, info, properties, ..) =
            RecordingStreamBuilder::new(APPLICATION).recording_name(scene.title.clone()).into_args();
        // Rows come in columns: there is nothing to batch.
        let batching = Some(ChunkBatcherConfig::NEVER);
        let stream =
            RecordingStream::new(info, properties, batching, Default::default(), Box::new(sinks.clone()))
                .map_err(|error| RecordingError::Sdk(error.to_string()))?;
        let flushed = Instant::now();
        Ok(Self { stream, sinks, scene, tracks: None, flushed, flushed_at: 0.0, live_problem })
    }

    /// Records the run as it is now.
    ///
    /// # Errors
    ///
    /// When the file could not be written any more.
    pub fn log(&mut self, view: &View) -> Result<(), RecordingError> {
        self.record(view, false).map_err(RecordingError::Sdk)?;
        let wait = if self.sinks.is_live() { FLUSH_LIVE } else { FLUSH_FILE };
        let is_much = view.time - self.flushed_at >= Pace::of(self.scene.unit).flush;
        if is_much || self.flushed.elapsed() >= wait {
            self.flushed_at = view.time;
            self.flush()?;
        }
        Ok(())
    }

    /// Records the end of the run, every map as it is now, and closes the recording.
    ///
    /// # Errors
    ///
    /// When not all of the recording could be written to the file.
    pub fn finish(mut self, view: &View) -> Result<(), RecordingError> {
        self.record(view, true).map_err(RecordingError::Sdk)?;
        self.flush()?;
        self.stream.flush_blocking().map_err(|error| RecordingError::Sdk(error.to_string()))?;
        self.sinks.finish()
    }

    /// Why a viewer is not shown the run, or not any more; the file is not affected.
    pub fn live_problem(&self) -> Option<String> {
        self.live_problem.clone().or_else(|| self.sinks.live_problem())
    }

    fn record(&mut self, view: &View, is_last: bool) -> Result<(), String> {
        let tracks = match &mut self.tracks {
            Some(tracks) => tracks,
            none => {
                let sdk = |error: rerun::RecordingStreamError| error.to_string();
                scenery::send(&self.stream, &self.scene, view).map_err(sdk)?;
                blueprint::send(&self.stream, APPLICATION, &self.scene, view).map_err(sdk)?;
                self.stream.flush_async().map_err(|error| error.to_string())?;
                none.insert(Tracks::new(view, self.scene.unit))
            }
        };
        tracks.push(view, is_last);
        Ok(())
    }

    /// Hands on what waits.
    fn flush(&mut self) -> Result<(), RecordingError> {
        self.flushed = Instant::now();
        if let Some(tracks) = &mut self.tracks {
            tracks.flush(&self.stream).map_err(RecordingError::Sdk)?;
        }
        self.sinks.check()
    }
}

#[cfg(test)]
mod tests;
