//! A file as lines of text, plain or compressed.

use crate::bounds::Unpacked;
use crate::bytes::{Bytes, GZIP};
use crate::error::LogError;
use flate2::bufread::MultiGzDecoder;
use std::io::{self, BufRead, BufReader, Error, ErrorKind, Read, Seek, SeekFrom};

/// The longest line, in bytes: a file that never ends a line must not fill the memory.
const LONGEST: u64 = 1 << 20;

/// The text of a log; its compression is undone.
pub(crate) type Text = BufReader<Unpacked<Box<dyn Read + Send>>>;

/// Opens a log. The compression is recognized by the content.
pub(crate) fn open(bytes: &Bytes) -> io::Result<Text> {
    let mut reader = BufReader::new(bytes.open()?);
    let is_packed = reader.fill_buf()?.starts_with(&GZIP);
    let size = reader.seek(SeekFrom::End(0))?;
    reader.rewind()?;
    let text = match is_packed {
        true => Unpacked::new(Box::new(MultiGzDecoder::new(reader)) as Box<_>, size, "gzip -d FILE"),
        false => Unpacked::plain(Box::new(reader.into_inner()) as Box<_>),
    };
    Ok(BufReader::new(text))
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
        let reader = open(bytes).map_err(|why| LogError::Io { file: file.to_owned(), why })?;
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
        let text = self.reader.get_ref();
        text.is_cut.then_some((text.packed, text.count))
    }
}
