//! The messages of a bag, file by file.

use super::files::{BagFile, Format};
use super::mcap::McapFile;
use super::message::{Message, MessageSource, Selection, Topic};
use super::sqlite::SqliteFile;
use crate::bytes::ZSTD;
use crate::error::LogError;
use std::io::Read;
use std::sync::Arc;
use std::vec::IntoIter;

/// The most bytes of a message, unpacked, and the most topics that are listed.
const MAX_MESSAGE_BYTES: u64 = 64 << 20;
const MAX_TOPICS: usize = 1 << 16;

/// The messages of a bag, in the order of its files.
pub(super) struct Messages {
    files: IntoIter<BagFile>,
    current: Option<Box<dyn MessageSource + Send>>,
    selection: Selection,
    /// All topics, also those that are not wanted.
    pub(super) topics: Vec<Arc<Topic>>,
    pub(super) notes: Vec<String>,
}

impl Messages {
    pub(super) fn new(files: Vec<BagFile>, selection: Selection) -> Self {
        let files = files.into_iter();
        Self { files, current: None, selection, topics: Vec::new(), notes: Vec::new() }
    }

    pub(super) fn next_message(&mut self) -> Result<Option<Message>, LogError> {
        loop {
            let Some(current) = &mut self.current else {
                let Some(file) = self.files.next() else { return Ok(None) };
                let selection = self.selection.clone();
                self.current = Some(match file.format {
                    Format::Mcap => Box::new(McapFile::open(&file.name, &file.bytes, selection)?),
                    Format::Sqlite => Box::new(SqliteFile::open(&file.name, &file.bytes, selection)?),
                });
                continue;
            };
            if let Some(mut message) = current.next_message()? {
                if message.data.starts_with(&ZSTD) {
                    message.data = unpacked(&message)?;
                }
                return Ok(Some(message));
            }
            let (topics, note) = current.report();
            self.topics.extend(topics);
            self.topics.sort();
            self.topics.dedup();
            self.topics.truncate(MAX_TOPICS);
            self.notes.extend(note);
            self.current = None;
        }
    }
}

/// The data of a message that was compressed on its own (rosbag2's compression mode `message`).
fn unpacked(message: &Message) -> Result<Vec<u8>, LogError> {
    let mut data = Vec::new();
    let mut unpack = || {
        zstd::stream::read::Decoder::with_buffer(&message.data[..])?
            .take(MAX_MESSAGE_BYTES + 1)
            .read_to_end(&mut data)
    };
    let count = unpack().map_err(|error| message.error(error.to_string()))?;
    if count as u64 > MAX_MESSAGE_BYTES {
        return Err(message
            .error(format!("it unpacks to more than {MAX_MESSAGE_BYTES} bytes; at most these are read")));
    }
    Ok(data)
}
