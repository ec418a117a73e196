//! Formats of files of messages, by their first bytes.

use super::ros1;
use super::{sqlite, ulog};
use crate::import::error::ImportError;
use std::path::Path;

/// Format of a file of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Container {
    /// MCAP, the format of ROS 2; it may contain other encodings.
    Mcap,
    /// The bag of ROS 2 in SQLite.
    Ros2Sqlite,
    /// The bag of ROS 1, version 2.0.
    Ros1Bag,
    /// The log of PX4. Its times count from the start of the autopilot.
    Ulog,
}

impl Container {
    /// Name for the user.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mcap => "MCAP",
            Self::Ros2Sqlite => "ROS 2 bag in SQLite",
            Self::Ros1Bag => "ROS 1 bag",
            Self::Ulog => "PX4 ULog",
        }
    }
}

/// Magic bytes of other files, their format, and a remedy.
const OTHERS: [(&[u8], &str, &str); 4] = [
    (
        b"#ROSBAG V1",
        "a ROS 1 bag of version 1",
        "convert it: rosbag migrate",
    ),
    (
        b"\x1f\x8b",
        "compressed as a whole with gzip",
        "unpack it: gunzip",
    ),
    (b"PK\x03\x04", "a zip archive", "unpack it: unzip"),
    (
        b"\xa3\x95\x80\x80",
        "a log of ArduPilot (.bin)",
        "write a CSV with time, omega_left, omega_right: mavlogdump.py --format csv makes one of each type",
    ),
];

/// The format of a file, from its first bytes.
pub(super) fn of_magic(path: &Path, start: &[u8]) -> Result<Container, ImportError> {
    let known = [
        (::mcap::MAGIC, Container::Mcap),
        (ros1::MAGIC, Container::Ros1Bag),
        (sqlite::MAGIC, Container::Ros2Sqlite),
        (ulog::MAGIC, Container::Ulog),
    ];
    if let Some((_, container)) = known
        .into_iter()
        .find(|(magic, _)| start.starts_with(magic))
    {
        return Ok(container);
    }
    let other = OTHERS.iter().find(|(magic, ..)| start.starts_with(magic));
    let (found, remedy) = other.map_or(
        (
            "no MCAP file, no bag of ROS 1 or ROS 2 and no log of PX4",
            "name a .mcap, .db3, .bag or .ulg file, or the folder of a bag",
        ),
        |(_, found, remedy)| (*found, *remedy),
    );
    Err(ImportError::Format {
        path: path.into(),
        found: if start.is_empty() { "empty" } else { found }.into(),
        remedy: remedy.into(),
    })
}
