//! The file of a recording.

use super::RecordingError;
use files::{OutputError, UnfinishedFile, is_another_kind};
use rerun::external::re_log_encoding::rrd::{EncodeError, Encoder, EncodingOptions};
use rerun::log::LogMsg;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The first bytes of every recording, before the version of the format.
const MAGIC: &[u8] = b"RRF";
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
    /// Creates the file, and writes its header. An older recording stays until this one is complete; a file that is
    /// no recording is not replaced.
    pub(super) fn create(path: &Path) -> Result<Self, RecordingError> {
        let failed = |why| RecordingError::File { path: path.to_owned(), why };
        if is_another_kind(path, MAGIC) {
            return Err(failed(
                "there is a file with this name that is not a recording; choose another name".into(),
            ));
        }
        let unfinished =
            UnfinishedFile::create(path).map_err(|OutputError { why, .. }| failed(why.to_string()))?;
        let output = unfinished.file().try_clone().map_err(|error| failed(error.to_string()))?;
        let mut file = Self::with_output(path, Box::new(output)).map_err(failed)?;
        file.unfinished = Some(unfinished);
        Ok(file)
    }

    /// Like [`RrdFile::create`], with an `output`; `path` is used only in errors.
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
