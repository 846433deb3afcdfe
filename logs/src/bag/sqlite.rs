//! SQLite databases of rosbag2: the tables `topics` and `messages`. Of a file that is cut off, the messages before the cut are read.

use super::message::{IsWanted, Message, MessageSource, Topic, Usable};
use crate::bounds::{self, MAX_NAME_BYTES};
use crate::bytes::Bytes;
use crate::summary::LogError;
use rusqlite::{Connection, ErrorCode, OpenFlags, Row};
use std::collections::{BTreeMap, VecDeque};
use std::ffi::OsString;
use std::io::{self, Read as _};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

/// Messages that are read at once, and their bytes.
const PAGE_ROWS: u32 = 64;
const PAGE_BYTES: usize = 8 << 20;
/// A row takes more bytes of a file than this: if there are more rows, the file repeats itself.
const MIN_ROW: u64 = 4;
/// The largest message.
const MAX_BYTES: i64 = 64 << 20;

/// The steps of SQLite's virtual machine after which a query is given up: a page of messages takes far fewer.
const MAX_STEPS: i32 = 50_000_000;

/// With the bytes of the longest of the names: SQLite knows them without reading it.
const TOPICS: &str = "SELECT id, max(octet_length(name), octet_length(type), octet_length(serialization_format)), name, \
                      type, serialization_format FROM topics LIMIT 65536";
const MESSAGES: &str = "SELECT rowid, topic_id, timestamp, CASE WHEN length(data) <= ?3 THEN data END FROM messages \
                        WHERE rowid > ?1 ORDER BY rowid LIMIT ?2";

/// The topics by their keys, whether they are wanted, and the number of their messages.
type Topics = BTreeMap<i64, (Arc<Topic>, bool, u64)>;

/// A database of rosbag2.
pub(super) struct SqliteFile {
    database: Connection,
    table: MessageTable,
    /// A copy of the database, if that is what is read.
    _copy: Option<TempDir>,
}

/// The table of the messages, as far as it was read.
struct MessageTable {
    file: Arc<str>,
    size: u64,
    /// The bytes that the file had before it was cut off; `None` if it is whole.
    whole: Option<u64>,
    topics: Topics,
    page: VecDeque<Message>,
    /// Of a file that is cut off, the last message: its bytes can end with the file.
    last: Option<Message>,
    last_row: i64,
    rows: u64,
    is_over: bool,
}

impl SqliteFile {
    pub(super) fn open(file: &Arc<str>, bytes: &Bytes, is_wanted: IsWanted) -> Result<Self, LogError> {
        let failed = |error| database_error(file, &error);
        let io = |why| LogError::Io { file: file.to_string(), why };
        let path = bytes.path().ok_or_else(|| io(io::ErrorKind::Unsupported.into()))?;
        let size = path.metadata().map_err(io)?.len();
        let (uri, copy) = untouched(path).map_err(io)?;
        let flags =
            OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let mut database = Connection::open_with_flags(uri, flags).map_err(failed)?;
        database.progress_handler(MAX_STEPS, Some(|| true)).map_err(failed)?;
        // Nothing that a schema contains is run, cells of a page are checked before they are used, and nothing is sorted on the disk.
        let settings = "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA temp_store = MEMORY";
        database.execute_batch(settings).map_err(failed)?;
        let whole = whole_size(bytes).map_err(io)?.filter(|whole| *whole > size);
        if whole.is_some() {
            // With this, SQLite opens a database without its last pages. It is open for reading only: nothing is written.
            database.execute_batch("PRAGMA writable_schema = ON").map_err(failed)?;
        }
        for name in ["topics", "messages"] {
            if !is_stored(&database, name).map_err(failed)? {
                let why = format!("a database without a stored table `{name}`: not a bag of rosbag2");
                return Err(LogError::Unusable { file: file.to_string(), why });
            }
        }
        let table = MessageTable {
            file: file.clone(),
            size,
            whole,
            topics: topics(&database, file, &is_wanted)?,
            page: VecDeque::new(),
            last: None,
            last_row: i64::MIN,
            rows: 0,
            is_over: false,
        };
        Ok(Self { database, table, _copy: copy })
    }

    /// Reads the next messages. The data of topics that are not wanted is skipped.
    fn turn_page(&mut self) -> Result<(), LogError> {
        let Self { database, table, .. } = self;
        let file = table.file.clone();
        let failed = |error| database_error(&file, &error);
        let mut statement = database.prepare(MESSAGES).map_err(failed)?;
        let mut rows = statement.query((table.last_row, PAGE_ROWS, MAX_BYTES)).map_err(failed)?;
        let (mut count, mut bytes) = (0, 0);
        while bytes < PAGE_BYTES {
            let row = match rows.next() {
                Err(error) if table.whole.is_some() && is_corrupt(&error) => {
                    table.is_over = true; // here, the file is cut off
                    return Ok(());
                }
                row => row.map_err(failed)?,
            };
            let Some(row) = row else { break };
            match table.add(row) {
                Ok(added) => (count, bytes) = (count + 1, bytes + added),
                Err(_) if table.whole.is_some() => {
                    table.is_over = true; // zeros in place of what is cut off
                    return Ok(());
                }
                Err(what) => return Err(damaged(&file, &what)),
            }
        }
        table.is_over = count == 0;
        Ok(())
    }
}

impl MessageTable {
    /// Adds the message of a row, and returns the number of its bytes.
    fn add(&mut self, row: &Row<'_>) -> Usable<usize> {
        self.rows += 1;
        let row_id: i64 = row.get(0).map_err(|_| "a row of `messages` without a number".to_owned())?;
        if row_id <= self.last_row || self.rows > self.size / MIN_ROW {
            return Err(format!("row {row_id} of `messages` repeats itself"));
        }
        self.last_row = row_id;
        let invalid = |what: &str| format!("row {row_id} of `messages`: {what}");
        let key: i64 = row.get(1).map_err(|_| invalid("no topic"))?;
        let Some((topic, is_wanted, number)) = self.topics.get_mut(&key) else {
            return Err(invalid(&format!("topic {key} is not in `topics`")));
        };
        *number += 1;
        self.page.extend(self.last.take());
        if !*is_wanted {
            return Ok(0);
        }
        let log_ns = row.get(2).map_err(|_| invalid("no timestamp"))?;
        let data: Vec<u8> = row.get(3).map_err(|_| invalid("no data, or too long"))?;
        let bytes = data.len();
        let message =
            Message { topic: topic.clone(), log_ns, data, file: self.file.clone(), number: *number };
        match self.whole {
            Some(_) => self.last = Some(message),
            None => self.page.push_back(message),
        }
        Ok(bytes)
    }
}

/// Whether what a query finds by a name is a table, and no view, with columns that are stored: a view of a hostile file can have rows
/// without end, and a column that is computed when it is read gigabytes.
fn is_stored(database: &Connection, name: &str) -> rusqlite::Result<bool> {
    let (mut is_table, mut is_computed) = (false, false);
    database.pragma(Some("main"), "table_list", name, |row| {
        is_table |= row.get::<_, String>("type")? == "table";
        Ok(())
    })?;
    database.pragma(Some("main"), "table_xinfo", name, |row| {
        is_computed |= row.get::<_, i64>("hidden")? != 0;
        Ok(())
    })?;
    Ok(is_table && !is_computed)
}

/// The topics by their keys, whether they are wanted, and no message of them yet.
fn topics(database: &Connection, file: &Arc<str>, is_wanted: &IsWanted) -> Result<Topics, LogError> {
    let failed = |error| database_error(file, &error);
    let mut found = BTreeMap::new();
    let mut statement = database.prepare(TOPICS).map_err(failed)?;
    let mut rows = statement.query([]).map_err(failed)?;
    while let Some(row) = rows.next().map_err(failed)? {
        let longest: i64 = row.get(1).map_err(failed)?;
        if longest > MAX_NAME_BYTES as i64 {
            let what = format!("a name in `topics` has {longest} bytes; at most {MAX_NAME_BYTES} are read");
            return Err(damaged(file, &what));
        }
        let text = |column: usize| row.get::<_, String>(column).map_err(failed);
        let topic = Topic { name: text(2)?, type_name: text(3)?, encoding: text(4)? };
        let is_wanted = is_wanted(&topic);
        found.insert(row.get(0).map_err(failed)?, (Arc::new(topic), is_wanted, 0));
    }
    Ok(found)
}

/// The address by which SQLite reads a database and writes nothing, neither to it nor beside it; and the copy that it then reads: one
/// whose last changes are in a file beside it (`-wal`) gets an index beside it.
fn untouched(path: &Path) -> io::Result<(String, Option<TempDir>)> {
    let beside =
        |ending: &str| PathBuf::from([path.as_os_str(), ending.as_ref()].into_iter().collect::<OsString>());
    let bytes = |path: &Path| path.metadata().map_or(0, |known| known.len());
    let encoded = |path: &Path| -> String {
        let letters = path.as_os_str().as_bytes().iter();
        letters.map(|letter| format!("%{letter:02x}")).collect()
    };
    let log = beside("-wal");
    if bytes(&log) == 0 {
        // What its recorder could not finish (`-journal`) is an error; else nobody writes to it.
        let is_alone = bytes(&beside("-journal")) == 0;
        return Ok((format!("file:{}?immutable={}", encoded(path), u8::from(is_alone)), None));
    }
    let copy = tempfile::tempdir()?;
    if bounds::free_bytes(copy.path()).is_some_and(|free| free < bytes(path) + bytes(&log)) {
        return Err(io::ErrorKind::StorageFull.into());
    }
    for (from, name) in [(path, "copy.db3"), (&log, "copy.db3-wal")] {
        let mut to = tempfile::Builder::new().prefix(name).rand_bytes(0).tempfile_in(&copy)?;
        io::copy(&mut files::open(from)?, &mut to)?;
        to.keep()?; // until the folder is removed
    }
    Ok((format!("file:{}", encoded(&copy.path().join("copy.db3"))), Some(copy)))
}

/// The size of a database by its header, in bytes; `None` if the header does not say it.
fn whole_size(bytes: &Bytes) -> io::Result<Option<u64>> {
    let mut header = Vec::new();
    bytes.open()?.take(100).read_to_end(&mut header)?;
    let number =
        |at: usize| header.get(at..at + 4).and_then(|bytes| bytes.try_into().ok()).map(u32::from_be_bytes);
    // The number of pages is valid if it was written by the last change (SQLite, Database File Format, section 1.3.7).
    let [Some(changes), Some(pages), Some(valid_for)] = [24, 28, 92].map(number) else { return Ok(None) };
    let page_bytes = match u16::from_be_bytes([header[16], header[17]]) {
        1 => 65_536,
        bytes => u64::from(bytes),
    };
    Ok((changes == valid_for).then_some(u64::from(pages) * page_bytes))
}

fn is_corrupt(error: &rusqlite::Error) -> bool {
    error.sqlite_error_code() == Some(ErrorCode::DatabaseCorrupt)
}

fn database_error(file: &Arc<str>, error: &rusqlite::Error) -> LogError {
    let hint = match error.sqlite_error_code() {
        // We do not write to a log, not even to take back what its recorder could not finish.
        Some(ErrorCode::ReadOnly) => {
            "; its recorder was stopped within a write, which `sqlite3 FILE .tables` takes back"
        }
        Some(ErrorCode::DatabaseCorrupt) => "; `sqlite3 FILE .recover` prints what can be saved",
        _ => "",
    };
    damaged(file, &format!("{error}{hint}"))
}

fn damaged(file: &Arc<str>, what: &str) -> LogError {
    LogError::Unusable { file: file.to_string(), why: format!("the database is damaged: {what}") }
}

impl MessageSource for SqliteFile {
    fn next_message(&mut self) -> Result<Option<Message>, LogError> {
        while self.table.page.is_empty() && !self.table.is_over {
            if let Err(error) = self.turn_page() {
                self.table.is_over = true;
                self.table.page.clear();
                return Err(error);
            }
        }
        Ok(self.table.page.pop_front())
    }

    fn report(&self) -> (Vec<Arc<Topic>>, Option<String>) {
        let MessageTable { file, size, whole, topics, .. } = &self.table;
        let missing = whole.map(|whole| {
            format!("the database {file} is cut off after {size} of {whole} bytes: the messages before the cut were read")
        });
        (topics.values().map(|(topic, ..)| topic.clone()).collect(), missing)
    }
}
