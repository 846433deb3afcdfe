//! The file of a recording.

use rerun::external::re_log_encoding::rrd::{EncodeError, Encoder, EncodingOptions};
use rerun::log::LogMsg;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// An `.rrd` file under its final name from the start, so that a viewer can follow it and a killed run leaves
/// a readable file.
///
/// The file sink of the SDK reports a failed write to its logger only, and drops everything after it. This
/// sink keeps the first error for [`RrdFile::finish`]. Every message is passed to the operating system at
/// once, without a buffer.
pub(super) struct RrdFile {
    path: PathBuf,
    state: Mutex<State>,
}

type Output = Box<dyn Write + Send>;

enum State {
    Open(Box<Encoder<Output>>),
    Failed(String),
    Finished,
}

impl RrdFile {
    /// Creates the file, over an older one, and writes its header.
    pub(super) fn create(path: &Path) -> Result<Self, String> {
        let file = File::create(path).map_err(|error| error.to_string())?;
        Self::with_output(path, Box::new(file))
    }

    /// As [`RrdFile::create`], into `output`; `path` is only for errors.
    pub(super) fn with_output(path: &Path, output: Output) -> Result<Self, String> {
        let version = rerun::build_info().version;
        let encoder = Encoder::new_eager(version, EncodingOptions::PROTOBUF_COMPRESSED, output);
        let encoder = Box::new(encoder.map_err(why)?);
        Ok(Self { path: path.to_owned(), state: Mutex::new(State::Open(encoder)) })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn send(&self, message: &LogMsg) {
        let mut state = self.state();
        if let State::Open(encoder) = &mut *state
            && let Err(error) = encoder.append(message)
        {
            *state = State::Failed(why(error));
        }
    }

    /// Why the file could not be written, if so.
    pub(super) fn check(&self) -> Result<(), String> {
        match &*self.state() {
            State::Failed(error) => Err(error.clone()),
            State::Open(_) | State::Finished => Ok(()),
        }
    }

    /// Writes the footer and closes the file.
    pub(super) fn finish(&self) -> Result<(), String> {
        let mut state = self.state();
        match std::mem::replace(&mut *state, State::Finished) {
            State::Open(mut encoder) => encoder.finish().map_err(why),
            State::Failed(error) => Err(error),
            State::Finished => Ok(()),
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The message of the operating system, without the context of the SDK.
fn why(error: EncodeError) -> String {
    match error {
        EncodeError::Write(error) => error.to_string(),
        other => other.to_string(),
    }
}
