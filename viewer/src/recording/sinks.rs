//! The destinations of one recording.

use super::file::RrdFile;
use super::live::LiveFeed;
use super::{LiveError, RecordingError, RecordingOptions};
use rerun::log::LogMsg;
use rerun::sink::{LogSink, SinkFlushError};
use std::sync::Arc;
use std::time::Duration;

/// The file and the viewers; shared with the SDK's thread.
#[derive(Clone)]
pub(super) struct Sinks {
    file: Option<Arc<RrdFile>>,
    live: Vec<Arc<LiveFeed>>,
}

impl Sinks {
    /// Opens every destination. Returns also why a viewer is missing, if one is missing and there is a file.
    pub(super) fn open(options: &RecordingOptions) -> Result<(Self, Option<String>), RecordingError> {
        let create = |path: &std::path::PathBuf| match RrdFile::create(path) {
            Ok(file) => Ok(Arc::new(file)),
            Err(why) => Err(RecordingError::File { path: path.clone(), why }),
        };
        let file = options.file.as_ref().map(create).transpose()?;
        let (mut live, mut problem) = (Vec::new(), None);
        for viewer in &options.live {
            match LiveFeed::open(viewer, &options.viewer) {
                Ok(feed) => live.push(Arc::new(feed)),
                Err(error) if file.is_some() => problem = Some(error.to_string()),
                Err(error) => return Err(LiveError::into(error)),
            }
        }
        Ok((Self { file, live }, problem))
    }

    #[cfg(test)]
    pub(super) fn of_file(file: RrdFile) -> Self {
        Self { file: Some(Arc::new(file)), live: Vec::new() }
    }

    /// Whether a viewer shows the run.
    pub(super) fn is_live(&self) -> bool {
        self.live.iter().any(|feed| !feed.is_lost())
    }

    /// Which viewer went away, if one did.
    pub(super) fn live_problem(&self) -> Option<String> {
        let lost = self.live.iter().find(|feed| feed.is_lost())?;
        Some(format!("the viewer at {} went away", lost.address()))
    }

    /// Whether everything so far was written to the file.
    pub(super) fn check(&self) -> Result<(), RecordingError> {
        self.file_result(RrdFile::check)
    }

    /// Closes everything, once the stream was flushed.
    pub(super) fn finish(&self) -> Result<(), RecordingError> {
        self.live.iter().for_each(|feed| feed.close());
        self.file_result(RrdFile::finish)
    }

    fn file_result(&self, verb: impl Fn(&RrdFile) -> Result<(), String>) -> Result<(), RecordingError> {
        let Some(file) = &self.file else { return Ok(()) };
        verb(file).map_err(|why| RecordingError::File { path: file.path().to_owned(), why })
    }
}

impl LogSink for Sinks {
    fn send(&self, message: LogMsg) {
        if let Some(file) = &self.file {
            file.send(&message);
        }
        for feed in &self.live {
            feed.send(&message);
        }
    }

    fn flush_blocking(&self, _timeout: Duration) -> Result<(), SinkFlushError> {
        Ok(()) // nothing is buffered here; errors are kept for `check` and `finish`
    }
}
