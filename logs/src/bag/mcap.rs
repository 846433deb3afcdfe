//! MCAP files (<https://mcap.dev/spec>): records, each with a code and a length, some of them in compressed chunks.
//!
//! The crate `mcap` has readers as well, but version 0.25 trusts the lengths within chunks: a hostile file makes it panic or
//! allocate gigabytes.

use super::chunk::{Chunk, Fields, Records};
use super::message::{IsWanted, Message, MessageSource, Topic};
use crate::bounds::{MAX_NAME_BYTES, max_chunk_bytes};
use crate::bytes::{Bytes, Input, MCAP as MAGIC};
use crate::summary::LogError;
use std::collections::BTreeMap;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::sync::Arc;

/// The codes of records.
const FOOTER: u8 = 2;
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const CHUNK: u8 = 6;
const DATA_END: u8 = 15;
/// The bytes of a message before its data.
const MESSAGE_HEADER: usize = 22;
/// The most bytes of a record that is read as a whole.
const MAX_RECORD: u64 = 64 << 20;
/// The bytes of a schema or a channel that are read: its numbers and names. The rest describes messages that we know.
const MAX_DEFINITION_BYTES: u64 = 2 * MAX_NAME_BYTES as u64 + 16;
/// The bytes of a footer after its start: where the summary begins, and its parts, and a checksum.
const FOOTER_BYTES: u64 = 20;
/// A record that claims more bytes is no record that was cut off, but nonsense.
const MAX_CLAIMED: u64 = 1 << 40;

/// A channel: a topic in one file.
struct Channel {
    topic: Arc<Topic>,
    is_wanted: bool,
    messages: u64,
}

/// An MCAP file.
pub(super) struct McapFile {
    input: BufReader<Box<dyn Input>>,
    size: u64,
    /// The offset of the last record outside of chunks, and of the next.
    record: u64,
    next: u64,
    chunk: Option<Chunk>,
    /// The bytes of all chunks so far, unpacked.
    unpacked: u64,
    content: Content,
    /// Whether the file ends as its writer ends it: then no record can reach beyond the end.
    is_complete: bool,
    /// Why the file ends too early.
    missing: Option<String>,
    /// The number of chunks that are left out, in whole or in part, and why the first one is.
    damaged: Option<(usize, String)>,
    is_over: bool,
}

/// What the records so far have defined.
struct Content {
    file: Arc<str>,
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    is_wanted: IsWanted,
}

/// What stops the reading of a record.
enum Stop {
    /// The file ends within it.
    Cut,
    /// Its bytes cannot be read.
    Damaged(String),
    Invalid(String),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            ErrorKind::UnexpectedEof => Self::Cut,
            _ => Self::Damaged(error.to_string()),
        }
    }
}

impl McapFile {
    pub(super) fn open(file: &Arc<str>, bytes: &Bytes, is_wanted: IsWanted) -> Result<Self, LogError> {
        let io = |why| LogError::Io { file: file.to_string(), why };
        let mut input = BufReader::with_capacity(1 << 16, bytes.open().map_err(io)?);
        let size = input.seek(SeekFrom::End(0)).map_err(io)?;
        let start = MAGIC.len() as u64;
        let is_complete = ends_with_magic(&mut input, size).map_err(io)?;
        input.seek(SeekFrom::Start(start)).map_err(io)?;
        let (schemas, channels) = (BTreeMap::new(), BTreeMap::new());
        let content = Content { file: file.clone(), schemas, channels, is_wanted };
        Ok(Self {
            input,
            size,
            record: start,
            next: start,
            chunk: None,
            unpacked: 0,
            content,
            is_complete,
            missing: None,
            damaged: None,
            is_over: false,
        })
    }

    /// Reads one record. Gives its message, if it is one that is wanted.
    fn step(&mut self) -> Result<Option<Message>, Stop> {
        if let Some(chunk) = self.chunk.take() {
            let is_cut = chunk.is_cut;
            return match self.step_in_chunk(chunk) {
                Err(_) if is_cut => Err(Stop::Cut),
                Err(Stop::Cut) => self.leave_out("the records of a chunk end too early".to_owned()),
                Err(Stop::Damaged(what)) => self.leave_out(what),
                found => found,
            };
        }
        self.record = self.next;
        let (code, length) = self.input.next_start()?;
        if length > MAX_CLAIMED {
            return Err(Stop::Invalid(format!("a record (code {code}) of {length} bytes")));
        }
        self.next = self.record + 9 + length;
        match code {
            // Files that were not closed end in zeros on some file systems.
            0 => Err(Stop::Cut),
            FOOTER | DATA_END => {
                self.is_over = true;
                Ok(None)
            }
            CHUNK => {
                let available = self.size - (self.record + 9).min(self.size);
                let chunk = Chunk::read(&mut self.input, length, available, &mut self.unpacked);
                let most = max_chunk_bytes(self.size);
                if self.unpacked > most {
                    let (unpacked, size) = (self.unpacked, self.size);
                    let what = format!(
                        "the chunks so far unpack to {unpacked} bytes; at most {most} are read of a file of {size}"
                    );
                    return Err(Stop::Invalid(what));
                }
                match chunk {
                    Ok(chunk) => self.chunk = Some(chunk),
                    Err(_) if length > available => return Err(Stop::Cut),
                    Err(what) => return self.leave_out(what),
                }
                Ok(None)
            }
            _ if self.next > self.size => Err(Stop::Cut),
            _ => self.content.take(&mut self.input, code, length),
        }
    }

    fn step_in_chunk(&mut self, mut chunk: Chunk) -> Result<Option<Message>, Stop> {
        let Some((code, length)) = chunk.next_record()? else {
            return if chunk.is_cut { Err(Stop::Cut) } else { Ok(None) };
        };
        let found = self.content.take(&mut chunk, code, length)?;
        self.chunk = Some(chunk);
        Ok(found)
    }

    /// The rest of the chunk is left out: it is damaged.
    fn leave_out(&mut self, what: String) -> Result<Option<Message>, Stop> {
        if self.damaged.is_none() && self.is_complete {
            self.read_summary().ok(); // the chunk may have had definitions
        }
        let (count, _) =
            self.damaged.get_or_insert_with(|| (0, format!("the first one at byte {}: {what}", self.record)));
        *count += 1;
        self.input.seek(SeekFrom::Start(self.next))?;
        Ok(None)
    }

    /// Takes the schemas and channels that stand at the end of the file once more.
    fn read_summary(&mut self) -> Result<(), Stop> {
        self.input.seek(SeekFrom::Start(self.size.saturating_sub(FOOTER_BYTES + MAGIC.len() as u64)))?;
        let mut start = [0; 8];
        self.input.read_exact(&mut start)?;
        self.input.seek(SeekFrom::Start(u64::from_le_bytes(start).max(MAGIC.len() as u64)))?;
        loop {
            match self.input.next_start()? {
                (FOOTER, _) => return Ok(()),
                (code @ (SCHEMA | CHANNEL), length) if length <= MAX_CLAIMED => {
                    self.content.take(&mut self.input, code, length)?;
                }
                (_, length) if length <= MAX_CLAIMED => self.input.skip(length)?,
                _ => return Err(Stop::Cut),
            }
        }
    }

    fn invalid(&mut self, what: String) -> LogError {
        self.is_over = true;
        let why = format!("byte {}: {what}", self.record);
        LogError::Unusable { file: self.content.file.to_string(), why }
    }

    fn cut(&mut self) {
        self.is_over = true;
        self.missing = Some(format!(
            "{} has no end, since it is cut off or its recorder was stopped: what is whole before byte {} of {} was read",
            self.content.file, self.record, self.size
        ));
    }
}

impl Content {
    /// Reads a record after its start. Gives its message, if it is one that is wanted.
    fn take(&mut self, from: &mut impl Records, code: u8, length: u64) -> Result<Option<Message>, Stop> {
        let whole = |from: &mut dyn Read, length: u64| {
            let mut bytes = vec![0; checked(length)?];
            from.read_exact(&mut bytes)?;
            Ok::<_, Stop>(bytes)
        };
        match code {
            SCHEMA | CHANNEL => {
                let bytes = whole(from, length.min(MAX_DEFINITION_BYTES))?;
                self.define(code, &bytes)?;
                from.skip(length - bytes.len() as u64)?;
            }
            MESSAGE => {
                let mut header = [0; MESSAGE_HEADER];
                let Some(data) = length.checked_sub(MESSAGE_HEADER as u64) else {
                    return Err(Stop::Invalid(format!("a message of {length} bytes")));
                };
                from.read_exact(&mut header)?;
                if let Some(message) = self.message(&header)? {
                    return Ok(Some(Message { data: whole(from, data)?, ..message }));
                }
                from.skip(data)?;
            }
            _ => from.skip(length)?,
        }
        Ok(None)
    }

    /// A schema or a channel.
    fn define(&mut self, code: u8, bytes: &[u8]) -> Result<(), Stop> {
        let mut fields = Fields::new(bytes);
        let mut read = || {
            let id = u16::from_le_bytes(fields.array()?);
            if code == SCHEMA {
                self.schemas.insert(id, fields.name()?);
                return Ok(());
            }
            // A channel without a schema has no type.
            let type_name =
                self.schemas.get(&u16::from_le_bytes(fields.array()?)).cloned().unwrap_or_default();
            let topic = Topic { name: fields.name()?, type_name, encoding: fields.name()? };
            // Channels are defined again in later chunks.
            if self.channels.get(&id).is_none_or(|known| *known.topic != topic) {
                let is_wanted = (self.is_wanted)(&topic);
                self.channels.insert(id, Channel { topic: Arc::new(topic), is_wanted, messages: 0 });
            }
            Ok(())
        };
        let what = if code == SCHEMA { "a schema" } else { "a channel" };
        read().map_err(|why: String| Stop::Invalid(format!("{what} {why}")))
    }

    /// The message that begins with this header, if it is wanted; its data is to be read.
    fn message(&mut self, header: &[u8]) -> Result<Option<Message>, Stop> {
        let mut fields = Fields::new(header);
        let id = u16::from_le_bytes(fields.array().unwrap_or_default());
        let _ = fields.skip(4); // the sequence number
        let log_ns = u64::from_le_bytes(fields.array().unwrap_or_default());
        let Some(channel) = self.channels.get_mut(&id) else {
            return Err(Stop::Invalid(format!("a message of channel {id}, which is not defined")));
        };
        channel.messages += 1;
        Ok(channel.is_wanted.then(|| Message {
            topic: channel.topic.clone(),
            log_ns: i64::try_from(log_ns).unwrap_or(i64::MAX),
            data: Vec::new(),
            file: self.file.clone(),
            number: channel.messages,
        }))
    }
}

/// Whether a file of `size` bytes has the last bytes of a complete file, after its first ones.
fn ends_with_magic(input: &mut (impl Read + Seek), size: u64) -> io::Result<bool> {
    let length = MAGIC.len() as u64;
    if size < 2 * length {
        return Ok(false);
    }
    let mut end = [0; MAGIC.len()];
    input.seek(SeekFrom::Start(size - length))?;
    input.read_exact(&mut end)?;
    Ok(end == MAGIC)
}

/// The length of a record that is read as a whole.
fn checked(length: u64) -> Result<usize, Stop> {
    if length > MAX_RECORD {
        return Err(Stop::Invalid(format!("a record of {length} bytes; at most {MAX_RECORD} are read")));
    }
    Ok(length as usize)
}

impl MessageSource for McapFile {
    fn next_message(&mut self) -> Result<Option<Message>, LogError> {
        while !self.is_over {
            match self.step() {
                Ok(Some(message)) => return Ok(Some(message)),
                Ok(None) => {}
                Err(Stop::Cut) if self.is_complete => {
                    let what = "a record ends beyond the end of the file, which is not cut off";
                    return Err(self.invalid(what.to_owned()));
                }
                Err(Stop::Cut) => self.cut(),
                Err(Stop::Damaged(what) | Stop::Invalid(what)) => return Err(self.invalid(what)),
            }
        }
        Ok(None)
    }

    fn report(&self) -> (Vec<Arc<Topic>>, Option<String>) {
        let damaged = self.damaged.as_ref().map(|(count, first)| {
            let chunks = if *count == 1 { "1 chunk is".to_owned() } else { format!("{count} chunks are") };
            format!("{} is damaged: {chunks} left out, {first}", self.content.file)
        });
        let missing: Vec<String> = damaged.into_iter().chain(self.missing.clone()).collect();
        let topics = self.content.channels.values().map(|channel| channel.topic.clone()).collect();
        (topics, Some(missing.join("; ")).filter(|missing| !missing.is_empty()))
    }
}
