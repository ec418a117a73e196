//! Files of messages, read once from front to back; memory holds one chunk at a time.

mod mcap;
mod ros1;

use super::ImportError;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// What a file of messages is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Container {
    /// MCAP, which ROS 2 writes; holds other encodings as well.
    Mcap,
    /// The bag of ROS 1, version 2.0.
    Ros1Bag,
}

impl Container {
    /// Its name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mcap => "MCAP",
            Self::Ros1Bag => "ROS 1 bag",
        }
    }
}

/// Whether a file could be read to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ending {
    /// It could.
    Whole,
    /// What comes before could be read.
    Broken {
        /// Where the record begins that could not be read, or near it \[bytes\].
        offset: u64,
        /// What is wrong with it.
        reason: String,
    },
}

/// The topic of a message.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Connection {
    pub topic: String,
    /// Name of the message's type.
    pub message_type: String,
    /// "cdr", "ros1", or whatever the file says.
    pub encoding: String,
}

/// Is shown every message: its topic, when it was logged \[ns\] since 1970, and its bytes.
pub(super) type Visit<'v> = dyn FnMut(&Connection, i64, &[u8]) -> Result<(), ImportError> + 'v;

/// Is told how many bytes have been read, and of how many.
pub type ReadProgress<'p> = dyn FnMut(u64, u64) + 'p;

/// Bytes that are asked of the file at once.
const BLOCK: usize = 1 << 18;

/// Recorders write chunks of some megabytes, at most some messages' worth \[bytes\]; more is a damaged length.
const LARGEST_CHUNK: u64 = 1 << 30;
/// Messages pack to more than this share, and what a small file says of its size is damage or a trap.
const TIGHTEST: u64 = 32;
const SMALL: u64 = 64 << 20;
/// Longer names of topics and types are damage \[bytes\]: those of ROS have 255.
const LONGEST_NAME: usize = 1024;

/// How other files begin, what they are, and what to do about them.
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

/// An open file with the place in it.
pub(super) struct Input<'a> {
    path: &'a Path,
    file: BufReader<File>,
    place: u64,
    length: u64,
}

impl<'a> Input<'a> {
    fn open(path: &'a Path) -> Result<Self, ImportError> {
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
                remedy: "name the .mcap or .bag file in it".into(),
            });
        }
        Ok(Self {
            path,
            file: BufReader::with_capacity(BLOCK, file),
            place: 0,
            length: metadata.len(),
        })
    }

    /// The largest record or chunk, packed or unpacked, that a file of this length holds \[bytes\].
    fn largest(&self) -> u64 {
        (TIGHTEST * self.length).clamp(SMALL, LARGEST_CHUNK)
    }

    /// Bytes from here to the end.
    fn left(&self) -> u64 {
        self.length.saturating_sub(self.place)
    }

    /// Reads as much as there is, up to the buffer's length.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ImportError> {
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

    fn skip(&mut self, bytes: u32) -> Result<(), ImportError> {
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

/// What a file is, from its first bytes.
///
/// # Errors
/// A file that cannot be read, or is something else.
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

/// Shows every message of a file in the file's order.
///
/// # Errors
/// A file that cannot be read, and whatever the visitor refuses. A file that ends too early or
/// is damaged is no error: see [`Ending`].
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
    use super::*;

    /// The ending of a file of these bytes, and the memory that reading takes at most.
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

    /// A file with one chunk that says it unpacks to so many bytes; it has four.
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
