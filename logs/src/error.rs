use interfaces::printable;

/// The error for a log that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be opened, read or decompressed.
    #[error("{}: {source}", printable(file))]
    Io {
        /// The name of the file.
        file: String,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A line does not have the form that its first word demands.
    #[error("{}:{line}: {}", printable(file), printable(what))]
    Line {
        /// The name of the file.
        file: String,
        /// The number of the line, from 1.
        line: u64,
        /// What is invalid, and what is expected.
        what: String,
    },
    /// The file has no reading.
    #[error("{}: {why}", printable(file))]
    Unusable {
        /// The name of the file.
        file: String,
        /// The reason.
        why: String,
    },
}
