//! The file of a recording.

use super::RecordingError;
use rerun::external::re_log_encoding::rrd::{EncodeError, Encoder, EncodingOptions};
use rerun::log::LogMsg;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The number of messages that the footer of a file can list, about 1.5 simulated hours at full speed. The encoder keeps
/// about 2 kB per message until the end; the file of a longer run has no footer. A viewer then reads the whole file
/// before it shows everything.
const MAX_LISTED: usize = 4096;

/// An `.rrd` file with its final name from the start, so that a viewer can follow it, and a killed run leaves a
/// readable file.
///
/// The file sink of the SDK reports a failed write only to its logger, and drops everything after it. This sink
/// keeps the first error for [`RrdFile::check`]. Every message is passed to the operating system at once, without a
/// buffer.
pub(super) struct RrdFile {
    path: PathBuf,
    encoder: Encoder<Output>,
    /// The number of messages so far.
    messages: usize,
    /// The first error.
    written: Result<(), String>,
}

type Output = Box<dyn Write + Send>;

impl RrdFile {
    /// Creates the file, over an older one, and writes its header.
    pub(super) fn create(path: &Path) -> Result<Self, RecordingError> {
        let failed = |why| RecordingError::File { path: path.to_owned(), why };
        let file = File::create(path).map_err(|error| failed(error.to_string()))?;
        Self::with_output(path, Box::new(file)).map_err(failed)
    }

    /// Like [`RrdFile::create`], with an `output`; `path` is used only in errors.
    pub(super) fn with_output(path: &Path, output: Output) -> Result<Self, String> {
        let version = rerun::build_info().version;
        let encoder = Encoder::new_eager(version, EncodingOptions::PROTOBUF_COMPRESSED, output);
        Ok(Self { path: path.to_owned(), encoder: encoder.map_err(why)?, messages: 0, written: Ok(()) })
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

    /// Writes the footer, unless there are too many messages for it.
    pub(super) fn finish(&mut self) {
        if self.written.is_ok() {
            self.written = self.encoder.finish().map_err(why);
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
