//! The messages of a bag, in the order of its files, or of their times of recording where the files
//! have them sorted by topic.

use super::files::{BagFile, Format};
use super::mcap::McapFile;
use super::message::{IsWanted, Kind, Message, MessageSource, Topic, Usable};
use super::sqlite::SqliteFile;
use crate::bytes::ZSTD;
use crate::summary::LogError;
use std::collections::BTreeMap;
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
    is_wanted: IsWanted,
    /// All topics, also those that are not wanted.
    pub(super) topics: Vec<Arc<Topic>>,
    pub(super) notes: Vec<String>,
}

impl Messages {
    pub(super) fn new(files: Vec<BagFile>, is_wanted: IsWanted) -> Self {
        let files = files.into_iter();
        Self { files, current: None, is_wanted, topics: Vec::new(), notes: Vec::new() }
    }

    pub(super) fn next_message(&mut self) -> Result<Option<Message>, LogError> {
        loop {
            let Some(current) = &mut self.current else {
                let Some(file) = self.files.next() else { return Ok(None) };
                let is_wanted = self.is_wanted.clone();
                self.current = Some(match file.format {
                    Format::Mcap => Box::new(McapFile::open(&file.name, &file.bytes, is_wanted)?),
                    Format::Sqlite => Box::new(SqliteFile::open(&file.name, &file.bytes, is_wanted)?),
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

/// Times of recording that go back by less than this come from threads of the recorder, ns.
const DISORDER_NS: i64 = 1_000_000_000;
/// In files that are sorted by topic, the times go back once per block of a topic: in at most one of this number of messages. Where
/// they go back more often, the topics have different clocks.
const MESSAGES_PER_BLOCK: usize = 10;
/// The most topics that are merged: each has a chunk of an MCAP file in memory.
const MAX_MERGED: usize = 16;

/// Finds out whether messages are sorted by topic: their times of recording go back from one topic to the next, and never within a
/// topic. Where they go back within a topic, the clock was set, and the order is that of the file.
#[derive(Debug, Default)]
pub(super) struct RecordedOrder {
    last_ns: Option<i64>,
    last_of: BTreeMap<Arc<Topic>, i64>,
    messages: usize,
    /// The messages that are earlier than the one before.
    earlier: usize,
    goes_back_within_topic: bool,
}

impl RecordedOrder {
    /// Notes the next message in the order of the files.
    pub(super) fn note(&mut self, message: &Message) {
        // Recorders repeat static transforms, which hold whenever they come, with their old times.
        if Kind::of(&message.topic) == Some(Kind::Transforms) && message.topic.name.ends_with("static") {
            return;
        }
        let now_ns = message.log_ns;
        let is_later = |last_ns: i64| last_ns.saturating_sub(now_ns) > DISORDER_NS;
        let last_of = self.last_of.insert(message.topic.clone(), now_ns);
        self.goes_back_within_topic |= last_of.is_some_and(is_later);
        self.earlier += usize::from(self.last_ns.replace(now_ns).is_some_and(is_later));
        self.messages += 1;
    }

    pub(super) fn is_by_topic(&self) -> bool {
        let is_in_blocks = (1..=self.messages / MESSAGES_PER_BLOCK).contains(&self.earlier);
        is_in_blocks && !self.goes_back_within_topic
    }
}

/// The messages of a bag: one stream in the order of its files, or a stream per topic, merged by the times of recording.
pub(super) struct Merged {
    streams: Vec<(Messages, Option<Message>)>,
}

impl Merged {
    /// The messages of the topics that are wanted.
    pub(super) fn new(
        files: &[BagFile],
        is_wanted: impl Fn(&Topic) -> bool + Send + Sync + 'static,
        by_topic: &[Arc<Topic>],
    ) -> Self {
        let stream = |is_wanted: IsWanted| (Messages::new(files.to_vec(), is_wanted), None);
        if by_topic.is_empty() {
            return Self { streams: vec![stream(Arc::new(is_wanted))] };
        }
        let topics = by_topic.iter().filter(|topic| is_wanted(topic));
        let streams = topics.cloned().map(|wanted| stream(Arc::new(move |topic: &Topic| *topic == *wanted)));
        Self { streams: streams.collect() }
    }

    /// The next message; of several with the same time, that of the first topic.
    pub(super) fn next_message(&mut self) -> Result<Option<Message>, LogError> {
        for (messages, next) in &mut self.streams {
            if next.is_none() {
                *next = messages.next_message()?;
            }
        }
        let waiting = self.streams.iter_mut().map(|(_, next)| next).filter(|next| next.is_some());
        let first = waiting.min_by_key(|next| next.as_ref().map(|message| message.log_ns));
        Ok(first.and_then(Option::take))
    }
}

/// The topics to merge: none where the order of the files is that of the recording.
///
/// # Errors
///
/// When there are too many.
pub(super) fn merged_topics(
    order: &RecordedOrder,
    topics: &[Arc<Topic>],
    is_wanted: impl Fn(&Topic) -> bool,
) -> Usable<Vec<Arc<Topic>>> {
    if !order.is_by_topic() {
        return Ok(Vec::new());
    }
    let wanted: Vec<_> = topics.iter().filter(|topic| is_wanted(topic)).cloned().collect();
    let count = wanted.len();
    if count > MAX_MERGED {
        return Err(format!(
            "the messages are sorted by topic, and {count} topics are needed; at most {MAX_MERGED} are merged: sort the messages by \
             time (`mcap sort FILE.mcap -o SORTED.mcap`, or `ros2 bag convert`), or name fewer lasers with --scan-topic"
        ));
    }
    Ok(wanted)
}
