use interfaces::printable;

/// The error for a log that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be opened, read or decompressed.
    #[error("{}: {why}", printable(file))]
    Io {
        /// The name of the file.
        file: String,
        /// The error of the system.
        why: std::io::Error,
    },
    /// The log is damaged, or cannot be used as it is.
    #[error("{}: {}", printable(file), printable(why))]
    Unusable {
        /// The name of the file.
        file: String,
        /// The reason, with the line, the byte or the message that is invalid.
        why: String,
    },
}

impl LogError {
    /// The error for a line that is invalid, with its number from 1.
    pub(crate) fn line(file: &str, line: u64, what: String) -> Self {
        Self::Unusable { file: format!("{file}:{line}"), why: what }
    }
}
