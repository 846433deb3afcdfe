//! A file as lines of text, plain or compressed.

use crate::bounds::Unpacked;
use crate::bytes::{Bytes, GZIP, Input};
use crate::error::LogError;
use flate2::bufread::MultiGzDecoder;
use std::io::{self, BufRead, BufReader, Error, ErrorKind, Read, Seek, SeekFrom};

/// The longest line, in bytes: a file that never ends a line must not fill the memory.
const LONGEST: u64 = 1 << 20;

/// Bytes that are unpacked from a file with gzip.
type Gzip = Unpacked<MultiGzDecoder<BufReader<Box<dyn Input>>>>;

/// The text of a log; its compression is undone.
pub(crate) enum Text {
    Plain(BufReader<Box<dyn Input>>),
    Gzip {
        reader: Box<BufReader<Gzip>>,
        /// The bytes of the file.
        packed: u64,
    },
}

impl Text {
    /// Opens a log. The compression is recognized by the content.
    pub(crate) fn open(bytes: &Bytes) -> io::Result<Self> {
        let mut reader = BufReader::new(bytes.open()?);
        if !reader.fill_buf()?.starts_with(&GZIP) {
            return Ok(Self::Plain(reader));
        }
        let packed = reader.seek(SeekFrom::End(0))?;
        reader.rewind()?;
        let unpacked = Unpacked::new(MultiGzDecoder::new(reader), packed, "gzip -d FILE");
        Ok(Self::Gzip { reader: Box::new(BufReader::new(unpacked)), packed })
    }

    fn buffer(&mut self) -> &mut dyn BufRead {
        match self {
            Self::Plain(reader) => reader,
            Self::Gzip { reader, .. } => &mut **reader,
        }
    }
}

impl Read for Text {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        self.buffer().read(to)
    }
}

impl BufRead for Text {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.buffer().fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.buffer().consume(count);
    }
}

/// The lines of a log, one after the other.
pub(crate) struct Lines {
    reader: Text,
    pub(crate) file: String,
    /// The number of the last line, from 1.
    pub(crate) number: u64,
    /// Whether the last line ended with a line feed. Otherwise, it can be cut off.
    pub(crate) is_complete: bool,
    line: Vec<u8>,
}

impl Lines {
    /// Opens a log. The compression is recognized by the content.
    pub(crate) fn open(bytes: &Bytes, file: &str) -> Result<Self, LogError> {
        let reader = Text::open(bytes).map_err(|why| LogError::Io { file: file.to_owned(), why })?;
        Ok(Self { reader, file: file.to_owned(), number: 0, is_complete: true, line: Vec::new() })
    }

    /// The next line, `None` at the end. Bytes that are no text are replaced.
    pub(crate) fn next_line(&mut self) -> Result<Option<String>, LogError> {
        self.line.clear();
        let mut limited = self.reader.by_ref().take(LONGEST);
        let read = limited.read_until(b'\n', &mut self.line);
        let count = read.map_err(|why| LogError::Io { file: self.file.clone(), why })?;
        if count == 0 {
            return Ok(None);
        }
        self.number += 1;
        self.is_complete = self.line.ends_with(b"\n");
        if !self.is_complete && count as u64 == LONGEST {
            let why = Error::new(ErrorKind::InvalidData, "a line is longer than 1 MiB: not a log");
            return Err(LogError::Io { file: self.file.clone(), why });
        }
        Ok(Some(String::from_utf8_lossy(&self.line).into_owned()))
    }

    /// The bytes of a compressed file that is cut off, and the bytes of text that could be unpacked; `None` if it is whole so far.
    pub(crate) fn cut(&self) -> Option<(u64, u64)> {
        match &self.reader {
            Text::Gzip { reader, packed } if reader.get_ref().is_cut => {
                Some((*packed, reader.get_ref().count))
            }
            _ => None,
        }
    }

    /// The error for the last line.
    pub(crate) fn error(&self, what: String) -> LogError {
        LogError::line(&self.file, self.number, what)
    }
}
