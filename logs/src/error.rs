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
    /// A binary file does not have the form that its format demands.
    #[error("{}: byte {byte}: {}", printable(file), printable(what))]
    Byte {
        /// The name of the file.
        file: String,
        /// The offset of the invalid record, from 0.
        byte: u64,
        /// What is invalid, and what is expected.
        what: String,
    },
    /// A message of a bag is invalid.
    #[error("{}: message {number} of {}: {}", printable(file), printable(topic), printable(what))]
    Message {
        /// The name of the file.
        file: String,
        /// The topic.
        topic: String,
        /// The number of the message among those of its topic in the file, from 1.
        number: u64,
        /// What is invalid, and what is expected.
        what: String,
    },
    /// The log cannot be used as it is.
    #[error("{}: {}", printable(file), printable(why))]
    Unusable {
        /// The name of the file.
        file: String,
        /// The reason.
        why: String,
    },
}
