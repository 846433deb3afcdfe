//! The destinations of one recording.

use super::file::RrdFile;
use super::live::LiveFeed;
use super::{Live, RecordingError};
use rerun::log::LogMsg;
use rerun::sink::{LogSink, SinkFlushError};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The file and the viewers; shared with the SDK's thread.
#[derive(Clone)]
pub(super) struct Sinks(Arc<Mutex<Outputs>>);

struct Outputs {
    file: Option<RrdFile>,
    live: Vec<LiveFeed>,
}

impl Sinks {
    /// Opens every destination. Returns also why a viewer is missing, if one is missing and there is a file.
    pub(super) fn open(
        file: Option<&Path>,
        viewers: &[Live],
    ) -> Result<(Self, Option<String>), RecordingError> {
        let file = file.map(RrdFile::create).transpose()?;
        let (mut live, mut problem) = (Vec::new(), None);
        for viewer in viewers {
            match LiveFeed::open(viewer) {
                Ok(feed) => live.push(feed),
                Err(error) if file.is_some() => problem = Some(error.to_string()),
                Err(error) => return Err(error.into()),
            }
        }
        Ok((Self(Arc::new(Outputs { file, live }.into())), problem))
    }

    #[cfg(test)]
    pub(super) fn of_file(file: RrdFile) -> Self {
        Self(Arc::new(Outputs { file: Some(file), live: Vec::new() }.into()))
    }

    /// Whether a viewer shows the run.
    pub(super) fn is_live(&self) -> bool {
        self.outputs().live.iter().any(|feed| !feed.is_lost())
    }

    /// Which viewer went away, if one did.
    pub(super) fn live_problem(&self) -> Option<String> {
        let outputs = self.outputs();
        let lost = outputs.live.iter().find(|feed| feed.is_lost())?;
        Some(format!("the viewer at {} went away", lost.address))
    }

    /// Whether everything so far was written to the file. An error is returned once: the file is closed and removed,
    /// so that the results have its space on a full disk.
    pub(super) fn check(&self) -> Result<(), RecordingError> {
        let mut outputs = self.outputs();
        let checked = outputs.file.as_ref().map_or(Ok(()), RrdFile::check);
        if checked.is_err() {
            outputs.file = None;
        }
        checked
    }

    /// Closes everything, once the stream was flushed.
    pub(super) fn finish(&self) -> Result<(), RecordingError> {
        let mut outputs = self.outputs();
        outputs.live.iter_mut().for_each(LiveFeed::close);
        if let Some(file) = &mut outputs.file {
            file.finish();
        }
        drop(outputs);
        self.check()
    }

    fn outputs(&self) -> MutexGuard<'_, Outputs> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl LogSink for Sinks {
    fn send(&self, message: LogMsg) {
        let mut outputs = self.outputs();
        if let Some(file) = &mut outputs.file {
            file.send(&message);
        }
        outputs.live.iter_mut().for_each(|feed| feed.send(&message));
    }

    fn flush_blocking(&self, _timeout: Duration) -> Result<(), SinkFlushError> {
        Ok(()) // nothing is buffered here; errors are kept for `check` and `finish`
    }
}
