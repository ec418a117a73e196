//! An open file of messages, and what its readers share.

use crate::import::error::ImportError;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// How the reading of a file ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ending {
    /// At the end of the file.
    Whole,
    /// At damage; everything before it was read.
    Broken {
        /// Start of the damaged record, or near it, such as "near byte 5000".
        place: String,
        /// The damage.
        reason: String,
    },
}

/// The topic of a message.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::import) struct Connection {
    pub topic: String,
    /// Name of the message's type.
    pub message_type: String,
    /// "cdr", "ros1", "ulog", or whatever the file says.
    pub encoding: String,
}

/// Receives every message: its topic, when it was logged \[ns\], and its bytes. Times count from 1970, or, in a log of PX4,
/// from its start.
pub(in crate::import) type Visit<'v> =
    dyn FnMut(&Connection, i64, &[u8]) -> Result<(), ImportError> + 'v;

/// Why reading stops early.
pub(super) enum Stop {
    /// Refused by the visitor or the file system.
    Refused(ImportError),
    /// Damage.
    Broken(String),
}

impl From<ImportError> for Stop {
    fn from(error: ImportError) -> Self {
        Self::Refused(error)
    }
}

pub(super) fn broken<T>(reason: impl Into<String>) -> Result<T, Stop> {
    Err(Stop::Broken(reason.into()))
}

/// The damage of a file that was cut off.
pub(super) const CUT: &str = "the file ends in the middle of a record";

/// Receives the number of bytes read and the number of all bytes.
pub type ReadProgress<'p> = dyn FnMut(u64, u64) + 'p;

/// Bytes per read.
pub(super) const BLOCK: usize = 1 << 18;

/// Recorders write chunks of some megabytes \[bytes\]; a larger length is damaged.
const LARGEST_CHUNK: u64 = 1 << 30;
/// Maximum ratio of compression, and a size that is always allowed \[bytes\]; a larger claim is damage or a trap.
const TIGHTEST: u64 = 32;
pub(super) const SMALL: u64 = 64 << 20;
/// Maximum length of names of topics and types \[bytes\]; those of ROS have 255.
pub(super) const LONGEST_NAME: usize = 1024;

/// An open file and the place in it.
pub(super) struct Input<'a> {
    path: &'a Path,
    file: BufReader<File>,
    /// Bytes read so far.
    pub place: u64,
    /// Bytes of the file.
    pub length: u64,
}

impl<'a> Input<'a> {
    pub fn open(path: &'a Path) -> Result<Self, ImportError> {
        let failed = |source| ImportError::Read {
            path: path.into(),
            source,
        };
        let file = File::open(path).map_err(failed)?;
        let metadata = file.metadata().map_err(failed)?;
        if metadata.is_dir() {
            return Err(ImportError::Format {
                path: path.into(),
                found: "a folder".into(),
                remedy: "name a file of messages, or the folder of a bag".into(),
            });
        }
        Ok(Self {
            path,
            file: BufReader::with_capacity(BLOCK, file),
            place: 0,
            length: metadata.len(),
        })
    }

    /// The largest record or chunk, packed or unpacked, in a file of this length \[bytes\].
    pub fn largest(&self) -> u64 {
        (TIGHTEST * self.length).clamp(SMALL, LARGEST_CHUNK)
    }

    /// Bytes from here to the end.
    pub fn remaining(&self) -> u64 {
        self.length.saturating_sub(self.place)
    }

    /// Reads up to the buffer's length, or to the end of the file.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ImportError> {
        let mut done = 0;
        while done < buffer.len() {
            match self.file.read(&mut buffer[done..]) {
                Ok(0) => break,
                Ok(bytes) => done += bytes,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(source) => return Err(self.failed(source)),
            }
        }
        self.place += done as u64;
        Ok(done)
    }

    pub fn skip(&mut self, bytes: u32) -> Result<(), ImportError> {
        let skipped = self.file.seek_relative(i64::from(bytes));
        skipped.map_err(|source| self.failed(source))?;
        self.place += u64::from(bytes);
        Ok(())
    }

    fn failed(&self, source: std::io::Error) -> ImportError {
        ImportError::Read {
            path: self.path.into(),
            source,
        }
    }
}
