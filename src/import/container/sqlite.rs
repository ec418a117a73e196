//! The bag of ROS 2 in SQLite (`.db3`), by SQLite itself: a table of topics and one of messages.
//!
//! A file from elsewhere may be damaged or hostile. It is opened read-only, its schema runs no code, and no row may be
//! longer than the file.

use super::input::{Connection, Ending, LONGEST_NAME, ReadProgress, Visit};
use crate::import::error::ImportError;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};
use rusqlite::config::DbConfig;
use rusqlite::limits::Limit;
use rusqlite::{Connection as Database, OpenFlags, Row};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

pub(super) const MAGIC: &[u8] = b"SQLite format 3\0";

/// Characters that stay as they are in the path of a URI.
const PATH: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'-')
    .remove(b'_')
    .remove(b'.')
    .remove(b'~');
/// Places of page size and number of pages in the header (sqlite.org/fileformat2.html, 1.3) \[bytes\].
const PAGE_SIZE: usize = 16;
const PAGES: usize = 28;
/// The shortest row of a table \[bytes\].
const SHORTEST_ROW: u64 = 4;
/// Number of topics beyond which a file is no bag.
const MOST_TOPICS: usize = 10_000;

/// Visits every message in the order of recording.
pub(super) fn read(
    path: &Path,
    progress: &mut ReadProgress,
    visit: &mut Visit,
) -> Result<Ending, ImportError> {
    let failed = |source| ImportError::Read {
        path: path.into(),
        source,
    };
    let length = fs::metadata(path).map_err(failed)?.len();
    let mut reader = Reader {
        length,
        done: 0,
        messages: 0,
        progress,
        visit,
    };
    match reader.all(path) {
        Ok(()) => {}
        Err(Stop::Refused(error)) => return Err(error),
        Err(Stop::Damaged(reason)) => return Ok(reader.broken(reason)),
    }
    // Rows on missing pages are errors above; free pages at the end may be missing as well.
    Ok(match missing_bytes(path, length).map_err(failed)? {
        0 => Ending::Whole,
        missing => reader.broken(format!("the file ends {missing} bytes early")),
    })
}

/// Why reading stops early.
enum Stop {
    Refused(ImportError),
    Damaged(String),
}

impl From<rusqlite::Error> for Stop {
    fn from(error: rusqlite::Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

struct Reader<'r, 'p, 'v> {
    length: u64,
    /// Bytes of the rows so far.
    done: u64,
    messages: u64,
    progress: &'r mut ReadProgress<'p>,
    visit: &'r mut Visit<'v>,
}

impl Reader<'_, '_, '_> {
    fn broken(&self, reason: String) -> Ending {
        Ending::Broken {
            place: format!("behind message {}", self.messages),
            reason,
        }
    }

    fn all(&mut self, path: &Path) -> Result<(), Stop> {
        let database = open(path, self.length)?;
        if !is_bag(&database)? {
            return Err(Stop::Refused(ImportError::Format {
                path: path.into(),
                found: "a SQLite database without the tables of a ROS 2 bag".into(),
                remedy: "name a .db3 file of ros2 bag record".into(),
            }));
        }
        let topics = topics(&database)?;
        let mut messages =
            database.prepare("SELECT topic_id, timestamp, data FROM messages NOT INDEXED")?;
        let mut rows = messages.query([])?;
        while let Some(row) = rows.next()? {
            let (topic, time, data) = message(row)?;
            // Pages that refer to each other in a circle would be read for ever.
            self.done += SHORTEST_ROW + data.len() as u64;
            if self.done > self.length {
                return Err(Stop::Damaged("its rows are longer than the file".into()));
            }
            let Some(topic) = topics.get(&topic) else {
                return Err(Stop::Damaged("a message belongs to no topic".into()));
            };
            (self.visit)(topic, time, data).map_err(Stop::Refused)?;
            self.messages += 1;
            (self.progress)(self.done, self.length);
        }
        (self.progress)(self.length, self.length);
        Ok(())
    }
}

fn message<'r>(row: &'r Row) -> Result<(i64, i64, &'r [u8]), Stop> {
    let data = row.get_ref(2)?.as_blob();
    let data = data.map_err(|_| Stop::Damaged("the data of a message are none".into()))?;
    Ok((row.get(0)?, row.get(1)?, data))
}

/// Opens a file read-only. One without a log of changes beside it is opened as it stands, so that nothing is written beside
/// it.
fn open(path: &Path, length: u64) -> Result<Database, Stop> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut log = path.as_os_str().to_owned();
    log.push("-wal");
    let has_log = fs::metadata(PathBuf::from(log)).is_ok_and(|log| log.len() > 0);
    let database = if has_log {
        Database::open_with_flags(path, flags)?
    } else {
        let whole = fs::canonicalize(path).unwrap_or_else(|_| path.into());
        let bytes = whole.as_os_str().as_encoded_bytes();
        let bytes: Vec<u8> = match std::path::MAIN_SEPARATOR {
            '\\' => bytes
                .iter()
                .map(|b| if *b == b'\\' { b'/' } else { *b })
                .collect(),
            _ => bytes.into(),
        };
        let encoded = percent_encode(&bytes, PATH).to_string();
        let slash = if encoded.starts_with('/') { "" } else { "/" };
        let uri = format!("file:{slash}{encoded}?immutable=1");
        Database::open_with_flags(uri, flags | OpenFlags::SQLITE_OPEN_URI)?
    };
    let longest = i32::try_from(length).unwrap_or(i32::MAX);
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, longest)?;
    database.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, false)?;
    database.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false)?;
    // Reads a file that was cut off, up to there; nothing can be written.
    database.set_db_config(DbConfig::SQLITE_DBCONFIG_WRITABLE_SCHEMA, true)?;
    database.execute_batch(
        "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0;",
    )?;
    Ok(database)
}

/// Whether there are plain tables of topics and messages: a view or a computed column would run code.
fn is_bag(database: &Database) -> Result<bool, Stop> {
    let tables: i64 = database.query_row(
        "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages') \
         AND sql LIKE 'CREATE TABLE%'",
        [],
        |row| row.get(0),
    )?;
    let mut computed = 0;
    for table in ["topics", "messages"] {
        let mut columns =
            database.prepare("SELECT count(*) FROM pragma_table_xinfo(?1) WHERE hidden <> 0")?;
        computed += columns.query_row([table], |row| row.get::<_, i64>(0))?;
    }
    Ok(tables == 2 && computed == 0)
}

fn topics(database: &Database) -> Result<HashMap<i64, Connection>, Stop> {
    let mut query = database.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let mut rows = query.query([])?;
    let mut topics = HashMap::new();
    while let Some(row) = rows.next()? {
        let text = |column| -> Result<String, Stop> {
            let text: String = row.get(column)?;
            if text.len() > LONGEST_NAME {
                let reason = format!("the name of a topic or type has {} bytes", text.len());
                return Err(Stop::Damaged(reason));
            }
            Ok(text)
        };
        let topic = Connection {
            topic: text(1)?,
            message_type: text(2)?,
            encoding: text(3)?,
        };
        topics.insert(row.get(0)?, topic);
        if topics.len() > MOST_TOPICS {
            return Err(Stop::Damaged(format!(
                "it has more than {MOST_TOPICS} topics"
            )));
        }
    }
    Ok(topics)
}

/// Bytes that the header promises and the file lacks.
fn missing_bytes(path: &Path, length: u64) -> std::io::Result<u64> {
    use std::io::Read;
    let mut header = [0; 100];
    fs::File::open(path)?.read_exact(&mut header)?;
    let page = match u16::from_be_bytes([header[PAGE_SIZE], header[PAGE_SIZE + 1]]) {
        1 => 1 << 16,
        size => u64::from(size),
    };
    let pages = [0, 1, 2, 3].map(|byte| header[PAGES + byte]);
    Ok((page * u64::from(u32::from_be_bytes(pages))).saturating_sub(length))
}
