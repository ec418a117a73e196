//! Files of messages, read from front to back with one chunk in memory.

mod input;
mod mcap;
mod ros1;

pub(super) use input::{Connection, Visit};
pub use input::{Ending, ReadProgress};

use super::error::ImportError;
use input::Input;
use std::path::Path;

/// Format of a file of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Container {
    /// MCAP, the format of ROS 2; it may contain other encodings.
    Mcap,
    /// The bag of ROS 1, version 2.0.
    Ros1Bag,
}

impl Container {
    /// Name for the user.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mcap => "MCAP",
            Self::Ros1Bag => "ROS 1 bag",
        }
    }
}

/// Magic bytes of other files, their format, and a remedy.
const OTHERS: [(&[u8], &str, &str); 5] = [
    (
        b"SQLite format 3\0",
        "a ROS 2 bag in SQLite (.db3)",
        "convert it to MCAP: ros2 bag convert, or mcap convert",
    ),
    (
        b"#ROSBAG V1",
        "a ROS 1 bag of version 1",
        "convert it: rosbag migrate",
    ),
    (
        b"\x28\xb5\x2f\xfd",
        "compressed as a whole with zstd",
        "unpack it: zstd -d",
    ),
    (
        b"\x1f\x8b",
        "compressed as a whole with gzip",
        "unpack it: gunzip",
    ),
    (b"PK\x03\x04", "a zip archive", "unpack it: unzip"),
];

/// The format of a file, from its first bytes.
///
/// # Errors
/// A file that cannot be read, or has another format.
pub(super) fn container(path: &Path) -> Result<Container, ImportError> {
    let mut start = [0; 16];
    let mut input = Input::open(path)?;
    let length = input.read(&mut start)?;
    let start = &start[..length];
    if start.starts_with(::mcap::MAGIC) {
        return Ok(Container::Mcap);
    }
    if start.starts_with(ros1::MAGIC) {
        return Ok(Container::Ros1Bag);
    }
    let known = OTHERS.iter().find(|(magic, ..)| start.starts_with(magic));
    let (found, remedy) = known.map_or(
        ("no MCAP file and no ROS 1 bag", "name a .mcap or .bag file"),
        |(_, found, remedy)| (*found, *remedy),
    );
    Err(ImportError::Format {
        path: path.into(),
        found: if length == 0 { "empty" } else { found }.into(),
        remedy: remedy.into(),
    })
}

/// Visits every message of a file in order.
///
/// # Errors
/// A file that cannot be read, and the errors of the visitor. A truncated or damaged file is no error: see [`Ending`].
pub(super) fn read(
    path: &Path,
    container: Container,
    progress: &mut ReadProgress,
    visit: &mut Visit,
) -> Result<Ending, ImportError> {
    let input = Input::open(path)?;
    match container {
        Container::Mcap => mcap::read(input, progress, visit),
        Container::Ros1Bag => ros1::read(input, progress, visit),
    }
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
            let kind = container(&path).unwrap();
            let ending = read(&path, kind, &mut |_, _| {}, &mut |_, _, _| Ok(())).unwrap();
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
