//! The file of a recording.

use super::live::LiveFeed;
use super::{Live, RecordingError};
use files::UnfinishedFile;
use rerun::external::re_log_encoding::rrd::{EncodeError, Encoder, EncodingOptions};
use rerun::log::LogMsg;
use rerun::sink::{LogSink, SinkFlushError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The number of messages that the footer of a file can list, about 1.5 simulated hours at full speed. The encoder keeps
/// about 2 kB per message until the end; the file of a longer run has no footer. A viewer then reads the whole file
/// before it shows everything.
const MAX_LISTED: usize = 4096;

/// An `.rrd` file that is written during the run, under a temporary name that a viewer can open: a killed run leaves a
/// readable file.
///
/// The file sink of the SDK reports a failed write only to its logger, and drops everything after it. This sink
/// keeps the first error for [`RrdFile::check`]. Every message is passed to the operating system at once, without a
/// buffer.
pub(super) struct RrdFile {
    path: PathBuf,
    encoder: Encoder<Output>,
    /// The file of `encoder`; `None` in tests, and when it has its name.
    unfinished: Option<UnfinishedFile>,
    /// The number of messages so far.
    messages: usize,
    /// The first error.
    written: Result<(), String>,
}

type Output = Box<dyn Write + Send>;

impl RrdFile {
    /// Writes the header of the file. An older recording stays until this one is complete.
    pub(super) fn new(unfinished: UnfinishedFile) -> Result<Self, RecordingError> {
        let path = unfinished.path();
        let failed = |why| RecordingError::File { path: path.to_owned(), why };
        let output = unfinished.file().try_clone().map_err(|error| failed(error.to_string()))?;
        let mut file = Self::with_output(path, Box::new(output)).map_err(failed)?;
        file.unfinished = Some(unfinished);
        Ok(file)
    }

    /// Like [`RrdFile::new`], with an `output`; `path` is used only in errors.
    pub(super) fn with_output(path: &Path, output: Output) -> Result<Self, String> {
        let version = rerun::build_info().version;
        let encoder = Encoder::new_eager(version, EncodingOptions::PROTOBUF_COMPRESSED, output);
        let encoder = encoder.map_err(why)?;
        Ok(Self { path: path.to_owned(), encoder, unfinished: None, messages: 0, written: Ok(()) })
    }

    pub(super) fn send(&mut self, message: &LogMsg) {
        if self.written.is_ok() {
            self.messages += 1;
            if self.messages > MAX_LISTED {
                self.encoder.do_not_emit_footer();
            }
            self.written = self.encoder.append(message).map(drop).map_err(why);
        }
    }

    /// Writes the footer, unless there are too many messages for it, and gives the file its name.
    pub(super) fn finish(&mut self) {
        if self.written.is_ok() {
            self.written = self.encoder.finish().map_err(why);
        }
        if let (Ok(()), Some(unfinished)) = (&self.written, self.unfinished.take()) {
            self.written = unfinished.finish().map_err(|error| error.why.to_string());
        }
    }

    /// Whether everything so far was written.
    pub(super) fn check(&self) -> Result<(), RecordingError> {
        self.written.clone().map_err(|why| RecordingError::File { path: self.path.clone(), why })
    }
}

/// The message of the operating system, without the context of the SDK.
fn why(error: EncodeError) -> String {
    match error {
        EncodeError::Write(error) => error.to_string(),
        other => other.to_string(),
    }
}

// The destinations of one recording.

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
        file: Option<UnfinishedFile>,
        viewers: &[Live],
    ) -> Result<(Self, Option<String>), RecordingError> {
        let file = file.map(RrdFile::new).transpose()?;
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
