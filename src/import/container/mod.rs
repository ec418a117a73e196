//! Files of messages, read from front to back with one chunk in memory.

mod files;
mod input;
mod kind;
mod mcap;
mod ros1;
mod sqlite;
mod ulog;

pub(super) use files::{LogFile, open};
pub(super) use input::{Connection, Visit};
pub use input::{Ending, ReadProgress};
pub use kind::Container;

use super::error::ImportError;
use input::Input;
use std::path::Path;

/// Endings of logs.
pub const LOG_ENDINGS: [&str; 4] = ["mcap", "db3", "bag", "ulg"];

/// Whether a path is a log rather than a table: a folder, a file with the first bytes of one, packed or not, or with the
/// ending of one.
#[must_use]
pub fn is_log(path: &Path) -> bool {
    let starts: [&[u8]; 5] = [
        ::mcap::MAGIC,
        b"#ROSBAG V",
        sqlite::MAGIC,
        ulog::MAGIC,
        b"\x28\xb5\x2f\xfd",
    ];
    if path.is_dir() {
        return true;
    }
    let mut start = [0; 16];
    let read = Input::open(path).and_then(|mut input| input.read(&mut start));
    let Ok(length) = read else {
        return false;
    };
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let mut starts = starts.iter();
    starts.any(|magic| start[..length].starts_with(magic))
        || LOG_ENDINGS.iter().any(|known| ending == *known)
}

/// Visits every message of a log, file by file.
///
/// # Errors
/// A file that cannot be read, and the errors of the visitor. A truncated or damaged file is no error: see [`Ending`].
/// Nothing behind the damage is read.
pub(super) fn read(
    files: &[LogFile],
    progress: &mut ReadProgress,
    visit: &mut Visit,
) -> Result<Ending, ImportError> {
    let lengths: Vec<u64> = files
        .iter()
        .map(|file| Input::open(file.path()).map(|input| input.length))
        .collect::<Result<_, _>>()?;
    let all: u64 = lengths.iter().sum();
    let mut before = 0;
    for (file, length) in files.iter().zip(&lengths) {
        let mut within = |done: u64, _: u64| progress(before + done.min(*length), all);
        let ending = match file.container {
            Container::Mcap => mcap::read(Input::open(file.path())?, &mut within, visit)?,
            Container::Ros1Bag => ros1::read(Input::open(file.path())?, &mut within, visit)?,
            Container::Ulog => ulog::read(Input::open(file.path())?, &mut within, visit)?,
            Container::Ros2Sqlite => sqlite::read(file.path(), &mut within, visit)?,
        };
        let ending = match (ending, &file.damage) {
            (Ending::Whole, None) => {
                before += length;
                continue;
            }
            (Ending::Whole, Some(reason)) => Ending::Broken {
                place: "near its end".into(),
                reason: reason.clone(),
            },
            (broken, _) => broken,
        };
        return Ok(match ending {
            Ending::Broken { place, reason } if files.len() > 1 => {
                let name = file.shown.file_name().unwrap_or_default().to_string_lossy();
                let place = format!("{place} of {name}");
                Ending::Broken { place, reason }
            }
            other => other,
        });
    }
    Ok(Ending::Whole)
}

#[cfg(test)]
mod tests {
    use super::input::SMALL;
    use super::*;

    /// The ending of a file of these bytes, and the maximum memory of reading.
    fn ending(bytes: &[u8]) -> (String, u64) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("drive");
        std::fs::write(&path, bytes).unwrap();
        let mut reason = String::new();
        let used = allocation_counter::measure(|| {
            let (files, _) = open(&path).unwrap();
            let ending = read(&files, &mut |_, _| {}, &mut |_, _, _| Ok(())).unwrap();
            reason = format!("{ending:?}");
        });
        (reason, used.bytes_max)
    }

    fn behind_its_length(bytes: &[u8]) -> Vec<u8> {
        [&(bytes.len() as u32).to_le_bytes(), bytes].concat()
    }

    /// A file with a chunk of four bytes whose header claims this size.
    fn mcap_of(size: u64) -> Vec<u8> {
        // A frame of zstd with a raw block.
        let packed = b"\x28\xb5\x2f\xfd\x20\x04\x21\0\0data";
        let chunk = [
            &[0; 16],
            &size.to_le_bytes()[..],
            &[0; 4],
            &behind_its_length(b"zstd"),
            &(packed.len() as u64).to_le_bytes(),
            packed,
        ]
        .concat();
        let length = (chunk.len() as u64).to_le_bytes();
        [
            ::mcap::MAGIC,
            b"\x01\x08\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
            b"\x06",
            &length,
            &chunk,
        ]
        .concat()
    }

    fn ros1_of(size: u32) -> Vec<u8> {
        let fields = [
            behind_its_length(b"op=\x05"),
            behind_its_length(b"compression=bz2"),
            behind_its_length(&[b"size=", &size.to_le_bytes()[..]].concat()),
        ];
        let header = behind_its_length(&fields.concat());
        [ros1::MAGIC, &header, &behind_its_length(b"BZh9")].concat()
    }

    #[test]
    fn a_small_file_that_claims_a_gigabyte_takes_no_gigabyte() {
        for size in [1000, SMALL, SMALL + 1, 1 << 30] {
            for bytes in [mcap_of(size), ros1_of(size as u32)] {
                let (reason, memory) = ending(&bytes);
                assert!(reason.starts_with("Broken"), "{reason}");
                assert!(memory < 2 * SMALL, "{size}: {memory}");
            }
        }
        let (reason, _) = ending(&ros1_of(1 << 30));
        assert!(
            reason.contains("unpacks to 1073741824 bytes is larger"),
            "{reason}"
        );
    }

    #[test]
    fn names_of_topics_are_no_longer_than_names_are() {
        let topic = [b"topic=", &[b'a'; 5000][..]].concat();
        let fields = [
            behind_its_length(b"op=\x07"),
            behind_its_length(b"conn=\0\0\0\0"),
            behind_its_length(&topic),
        ];
        let header = behind_its_length(&fields.concat());
        let data = behind_its_length(&behind_its_length(b"type=std_msgs/String"));
        let (reason, _) = ending(&[ros1::MAGIC, &header, &data].concat());
        assert!(
            reason.contains("the field `topic` of a record has 5000 bytes"),
            "{reason}"
        );
    }
}
