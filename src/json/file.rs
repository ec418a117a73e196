//! JSON from files.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Larger files describe no vehicle, terrain or model \[MB\]: a map of slopes with a million corners has some 40 MB.
const LARGEST: u64 = 64;

/// The text of a JSON file. Not more than 64 MB are read, so that a file of another kind costs little.
///
/// # Errors
/// A file that cannot be read, is larger, or is not UTF-8.
pub fn read_file(path: &Path) -> io::Result<String> {
    let largest = LARGEST << 20;
    let mut bytes = Vec::new();
    let read = File::open(path)?
        .take(largest + 1)
        .read_to_end(&mut bytes)?;
    if read as u64 > largest {
        let reason = format!("it is larger than {LARGEST} MB, the limit for JSON files");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, reason));
    }
    String::from_utf8(bytes).map_err(|_| {
        io::Error::new(
            io::ErrorKind::InvalidData,
            "stream did not contain valid UTF-8",
        )
    })
}
