//! The files of a log: one, or the folder of a bag, each perhaps packed with zstd as a whole.

use super::kind::{Container, of_magic};
use crate::import::container::input::Input;
use crate::import::error::ImportError;
use saphyr_parser::{Event, Parser};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::{NamedTempFile, TempPath};

/// Name of the file that describes the bag in a folder.
const METADATA: &str = "metadata.yaml";
/// Largest such file \[bytes\].
const LARGEST_METADATA: u64 = 1 << 24;
/// Endings of files of messages, and those of packed ones.
const ENDINGS: [&str; 3] = [".mcap", ".db3", ".bag"];
const PACKED: [&str; 2] = [".zstd", ".zst"];
const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";
/// Maximum ratio of compression, and a size that is always allowed \[bytes\]; a larger content is damage or a trap.
const TIGHTEST: u64 = 256;
const SMALL: u64 = 256 << 20;

/// A file of messages.
#[derive(Debug, Clone)]
pub(in crate::import) struct LogFile {
    /// As the user sees it.
    pub shown: PathBuf,
    pub container: Container,
    /// Its content, if it was packed, in a file that disappears with the last use.
    unpacked: Option<Arc<TempPath>>,
    /// Why not all of it could be unpacked.
    pub damage: Option<String>,
}

impl LogFile {
    /// The file to be read.
    pub fn path(&self) -> &Path {
        self.unpacked
            .as_ref()
            .map_or(&self.shown, |path| path.as_ref())
    }
}

/// The files of a log in the order of their names, with notes.
///
/// # Errors
/// A file or folder that cannot be read, or is no log.
pub(in crate::import) fn open(path: &Path) -> Result<(Vec<LogFile>, Vec<String>), ImportError> {
    if !path.is_dir() {
        return Ok((vec![open_file(path)?], Vec::new()));
    }
    let mut notes = Vec::new();
    let names = listed(path, &mut notes)?;
    let files = names.iter().map(|name| open_file(&path.join(name)));
    Ok((files.collect::<Result<_, _>>()?, notes))
}

fn failed(path: &Path) -> impl Fn(io::Error) -> ImportError {
    move |source| ImportError::Read {
        path: path.into(),
        source,
    }
}

fn open_file(path: &Path) -> Result<LogFile, ImportError> {
    let mut start = [0; 16];
    let read = |path: &Path, start: &mut [u8]| Input::open(path)?.read(start);
    let length = read(path, &mut start)?;
    let (mut unpacked, mut damage) = (None, None);
    let mut length = length;
    if start.starts_with(ZSTD) {
        let (content, fault) = unpack(path)?;
        length = read(&content, &mut start)?;
        (unpacked, damage) = (Some(Arc::new(content)), fault);
    }
    let container = match (of_magic(path, &start[..length]), &damage) {
        (Err(_), Some(reason)) => {
            return Err(ImportError::Format {
                path: path.into(),
                found: format!("damaged: {reason}"),
                remedy: "copy it again, or unpack it as far as possible: zstd -d".into(),
            });
        }
        (container, _) => container?,
    };
    Ok(LogFile {
        container,
        shown: path.into(),
        unpacked,
        damage,
    })
}

/// Unpacks a file to a temporary one, as far as possible.
fn unpack(path: &Path) -> Result<(TempPath, Option<String>), ImportError> {
    let file = File::open(path).map_err(failed(path))?;
    let length = file.metadata().map_err(failed(path))?.len();
    let largest = SMALL.max(TIGHTEST.saturating_mul(length));
    let mut content = NamedTempFile::new().map_err(failed(path))?;
    let mut decoder =
        zstd::stream::read::Decoder::with_buffer(BufReader::new(file)).map_err(failed(path))?;
    let mut block = vec![0; 1 << 16];
    let mut total = 0;
    let damage = loop {
        match decoder.read(&mut block) {
            Ok(0) => break None,
            Ok(bytes) => {
                total += bytes as u64;
                if total > largest {
                    return Err(ImportError::Format {
                        path: path.into(),
                        found: format!("packed more than {TIGHTEST} times, as no log is"),
                        remedy: "unpack it if you trust it: zstd -d".into(),
                    });
                }
                content.write_all(&block[..bytes]).map_err(failed(path))?;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => break Some(format!("it does not unpack: {error}")),
        }
    };
    content.flush().map_err(failed(path))?;
    Ok((content.into_temp_path(), damage))
}

/// The name of a file of messages without the ending of packed files; `None` for other files.
fn plain(name: &str) -> Option<&str> {
    let packed = PACKED.iter().find_map(|ending| name.strip_suffix(ending));
    let name = packed.unwrap_or(name);
    ENDINGS
        .iter()
        .any(|ending| name.ends_with(ending))
        .then_some(name)
}

/// A name without its ending and the number of the part: `drive_2.mcap` is a part of `drive`.
fn bag(name: &str) -> &str {
    let stem = plain(name)
        .and_then(|name| name.rsplit_once('.'))
        .map_or(name, |(stem, _)| stem);
    let bare = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    bare.strip_suffix('_').unwrap_or(stem)
}

/// The files of the bag in a folder.
fn listed(folder: &Path, notes: &mut Vec<String>) -> Result<Vec<String>, ImportError> {
    let mut found: BTreeSet<String> = BTreeSet::new();
    for entry in fs::read_dir(folder).map_err(failed(folder))? {
        let name = entry.map_err(failed(folder))?.file_name();
        let name = name.to_string_lossy().into_owned();
        if plain(&name).is_some() {
            found.insert(name);
        }
    }
    if found.is_empty() {
        return Err(ImportError::Format {
            path: folder.into(),
            found: "a folder without .mcap, .db3 or .bag files".into(),
            remedy: "name a file of messages, or the folder of a bag".into(),
        });
    }
    let described = described(&folder.join(METADATA));
    let mut names: Vec<String> = match described {
        Ok(described) => {
            let exists = |name: &String| {
                let packed = PACKED.iter().map(|ending| format!("{name}{ending}"));
                std::iter::once(name.clone())
                    .chain(packed)
                    .find(|name| found.contains(name))
            };
            let (there, missing): (Vec<_>, Vec<_>) = described
                .iter()
                .map(|name| (name, exists(name)))
                .partition(|(_, file)| file.is_some());
            if !missing.is_empty() {
                let missing: Vec<&str> = missing.iter().map(|(name, _)| name.as_str()).collect();
                notes.push(format!(
                    "warning: {METADATA} names {}, which the folder lacks",
                    missing.join(", ")
                ));
            }
            there.into_iter().filter_map(|(_, file)| file).collect()
        }
        Err(reason) => {
            let bags: BTreeSet<&str> = found.iter().map(|name| bag(name)).collect();
            if bags.len() > 1 {
                let names: Vec<&str> = found.iter().map(String::as_str).collect();
                return Err(ImportError::Format {
                    path: folder.into(),
                    found: format!(
                        "a folder with several logs and {reason}: {}",
                        names.join(", ")
                    ),
                    remedy: "name one of its files".into(),
                });
            }
            notes.push(format!(
                "{reason}: all files of messages in the folder are read"
            ));
            Vec::new()
        }
    };
    if names.is_empty() {
        names = found.into_iter().collect();
    }
    names.sort_by_key(|name| part(name));
    names.dedup();
    Ok(names)
}

/// Orders the parts of a bag by their numbers.
fn part(name: &str) -> (String, u64, String) {
    let bag = bag(name);
    let stem = plain(name)
        .and_then(|plain| plain.rsplit_once('.'))
        .map_or(name, |(stem, _)| stem);
    let number = stem
        .strip_prefix(bag)
        .and_then(|rest| rest.strip_prefix('_'));
    let number = number.and_then(|number| number.parse().ok()).unwrap_or(0);
    (bag.into(), number, name.into())
}

/// The files that the description of a bag names.
fn described(path: &Path) -> Result<Vec<String>, String> {
    let mut text = String::new();
    let read =
        File::open(path).and_then(|file| file.take(LARGEST_METADATA).read_to_string(&mut text));
    match read {
        Ok(_) => {}
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(format!("no {METADATA}"));
        }
        Err(error) => return Err(format!("a {METADATA} that cannot be read ({error})")),
    }
    let mut names = Vec::new();
    let (mut is_key, mut is_inside) = (false, false);
    for event in Parser::new_from_str(&text) {
        match event
            .map_err(|error| format!("a {METADATA} that is no YAML ({error})"))?
            .0
        {
            Event::Scalar(text, ..) if is_inside => {
                // Earlier versions write the folder as well.
                let name = text.rsplit(['/', '\\']).next().unwrap_or_default();
                names.push(name.to_owned());
            }
            Event::Scalar(text, ..) => is_key = text == "relative_file_paths",
            Event::SequenceStart(..) => is_inside = is_key,
            Event::SequenceEnd => (is_inside, is_key) = (false, false),
            _ => is_key = false,
        }
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_ordered_by_their_numbers() {
        let mut names = ["run_10.mcap", "run_9.mcap.zstd", "run_0.mcap"];
        names.sort_by_key(|name| part(name));
        assert_eq!(names, ["run_0.mcap", "run_9.mcap.zstd", "run_10.mcap"]);
        assert_eq!(
            [bag("a_1.db3"), bag("a.db3"), bag("2024.bag")],
            ["a", "a", "2024"]
        );
    }

    #[test]
    fn a_description_names_the_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(METADATA);
        fs::write(
            &path,
            "rosbag2_bagfile_information:\n  version: 4\n  relative_file_paths:\n    - bag/run_0.db3\n    - run_1.db3\n  \
             duration:\n    nanoseconds: 5\n",
        )
        .unwrap();
        assert_eq!(described(&path).unwrap(), ["run_0.db3", "run_1.db3"]);
        fs::write(&path, "a: [b\n").unwrap();
        assert!(described(&path).unwrap_err().contains("no YAML"));
        fs::remove_file(&path).unwrap();
        assert_eq!(described(&path), Err("no metadata.yaml".into()));
    }

    #[test]
    fn only_the_files_of_the_bag_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let names =
            |notes: &mut Vec<String>| listed(path, notes).map_err(|error| error.to_string());
        assert!(
            names(&mut Vec::new())
                .unwrap_err()
                .contains("a folder without")
        );
        for name in ["run_0.mcap", "run_1.mcap.zstd", "notes.txt"] {
            fs::write(path.join(name), "").unwrap();
        }
        let mut notes = Vec::new();
        assert_eq!(
            names(&mut notes).unwrap(),
            ["run_0.mcap", "run_1.mcap.zstd"]
        );
        assert!(notes[0].starts_with("no metadata.yaml"), "{notes:?}");
        fs::write(path.join("other.mcap"), "").unwrap();
        assert!(names(&mut Vec::new()).unwrap_err().contains("several logs"));
        fs::write(
            path.join(METADATA),
            "a:\n  relative_file_paths: [run_1.mcap, run_0.mcap, run_2.mcap]\n",
        )
        .unwrap();
        let mut notes = Vec::new();
        assert_eq!(
            names(&mut notes).unwrap(),
            ["run_0.mcap", "run_1.mcap.zstd"]
        );
        assert!(
            notes[0].contains("names run_2.mcap, which the folder lacks"),
            "{notes:?}"
        );
    }
}
