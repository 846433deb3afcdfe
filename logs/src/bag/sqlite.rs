//! SQLite databases of rosbag2: the tables `topics` and `messages`.

use super::message::{Message, MessageSource, Selection, Topic};
use crate::bounds::MAX_NAME_BYTES;
use crate::bytes::Bytes;
use crate::error::LogError;
use rusqlite::{Connection, ErrorCode, OpenFlags, Row};
use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::sync::Arc;

/// Messages that are read at once, and their bytes.
const PAGE_ROWS: u32 = 64;
const PAGE_BYTES: usize = 8 << 20;
/// A row takes more bytes of a file than this: if there are more rows, the file repeats itself.
const MIN_ROW: u64 = 4;
/// The largest message.
const MAX_BYTES: i64 = 64 << 20;

/// A table that is a table: a view of a hostile file can have rows without end.
const IS_TABLE: &str =
    "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = ?1 AND rootpage > 0";
/// With the bytes of the longest of the names: SQLite knows them without reading it.
const TOPICS: &str = "SELECT id, max(octet_length(name), octet_length(type), octet_length(serialization_format)), name, \
                      type, serialization_format FROM topics LIMIT 65536";
const MESSAGES: &str = "SELECT rowid, topic_id, timestamp, CASE WHEN length(data) <= ?3 THEN data END FROM messages \
                        WHERE rowid > ?1 ORDER BY rowid LIMIT ?2";

/// A database of rosbag2.
pub(super) struct SqliteFile {
    database: Connection,
    file: Arc<str>,
    size: u64,
    /// The topics by their keys, whether they are wanted, and the number of their messages.
    topics: BTreeMap<i64, (Arc<Topic>, bool, u64)>,
    page: VecDeque<Message>,
    last_row: i64,
    rows: u64,
    is_over: bool,
}

impl SqliteFile {
    pub(super) fn open(file: &Arc<str>, bytes: &Bytes, selection: Selection) -> Result<Self, LogError> {
        let failed = |error| database_error(file, &error);
        let io = |why| LogError::Io { file: file.to_string(), why };
        let path = bytes.path().ok_or_else(|| io(io::ErrorKind::Unsupported.into()))?;
        let size = path.metadata().map_err(io)?.len();
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let database = Connection::open_with_flags(path, flags).map_err(failed)?;
        // Nothing that a schema contains is run, and cells of a page are checked before they are used.
        database.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON").map_err(failed)?;
        for name in ["topics", "messages"] {
            let count: i64 = database.query_row(IS_TABLE, [name], |row| row.get(0)).map_err(failed)?;
            if count != 1 {
                let why = format!("a database without the table `{name}`: not a bag of rosbag2");
                return Err(LogError::Unusable { file: file.to_string(), why });
            }
        }
        let mut found = BTreeMap::new();
        {
            let mut statement = database.prepare(TOPICS).map_err(failed)?;
            let mut rows = statement.query([]).map_err(failed)?;
            while let Some(row) = rows.next().map_err(failed)? {
                let longest: i64 = row.get(1).map_err(failed)?;
                if longest > MAX_NAME_BYTES as i64 {
                    let what =
                        format!("a name in `topics` has {longest} bytes; at most {MAX_NAME_BYTES} are read");
                    return Err(damaged(file, &what));
                }
                let (id, topic) = topic(row).map_err(failed)?;
                let is_wanted = (selection.is_wanted)(&topic);
                found.insert(id, (Arc::new(topic), is_wanted, 0));
            }
        }
        Ok(Self {
            database,
            file: file.clone(),
            size,
            topics: found,
            page: VecDeque::new(),
            last_row: i64::MIN,
            rows: 0,
            is_over: false,
        })
    }

    /// Reads the next messages. The data of topics that are not wanted is skipped.
    fn turn_page(&mut self) -> Result<(), LogError> {
        let failed = |error| database_error(&self.file, &error);
        let mut statement = self.database.prepare(MESSAGES).map_err(failed)?;
        let mut rows = statement.query((self.last_row, PAGE_ROWS, MAX_BYTES)).map_err(failed)?;
        let (mut count, mut bytes) = (0, 0);
        while bytes < PAGE_BYTES {
            let Some(row) = rows.next().map_err(failed)? else { break };
            count += 1;
            self.rows += 1;
            let row_id: i64 = row.get(0).map_err(failed)?;
            if row_id <= self.last_row || self.rows > self.size / MIN_ROW {
                return Err(damaged(&self.file, &format!("row {row_id} of `messages` repeats itself")));
            }
            self.last_row = row_id;
            let invalid = |what: &str| damaged(&self.file, &format!("row {row_id} of `messages`: {what}"));
            let key: i64 = row.get(1).map_err(|_| invalid("no topic"))?;
            let Some((topic, is_wanted, number)) = self.topics.get_mut(&key) else {
                return Err(invalid(&format!("topic {key} is not in `topics`")));
            };
            *number += 1;
            if *is_wanted {
                let log_ns = row.get(2).map_err(|_| invalid("no timestamp"))?;
                let data: Vec<u8> = row.get(3).map_err(|_| invalid("no data, or too long"))?;
                bytes += data.len();
                let (topic, file) = (topic.clone(), self.file.clone());
                self.page.push_back(Message { topic, log_ns, data, file, number: *number });
            }
        }
        self.is_over = count == 0;
        Ok(())
    }
}

fn topic(row: &Row<'_>) -> rusqlite::Result<(i64, Topic)> {
    Ok((row.get(0)?, Topic { name: row.get(2)?, type_name: row.get(3)?, encoding: row.get(4)? }))
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
        while self.page.is_empty() && !self.is_over {
            if let Err(error) = self.turn_page() {
                self.is_over = true;
                self.page.clear();
                return Err(error);
            }
        }
        Ok(self.page.pop_front())
    }

    fn report(&self) -> (Vec<Arc<Topic>>, Option<String>) {
        (self.topics.values().map(|(topic, ..)| topic.clone()).collect(), None)
    }
}
