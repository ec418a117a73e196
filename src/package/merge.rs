//! Brings the shared libraries of several FMUs of one model into one file.

use super::archive::{Platform, add};
use crate::display::shortened;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Read, Seek, Write};
use zip::result::ZipError;
use zip::{ZipArchive, ZipWriter};

const BINARIES: &str = "binaries/";

/// Why FMUs cannot be merged.
#[derive(Debug)]
pub enum MergeError {
    /// A file that is no archive, or a broken one.
    Read {
        /// What the file is called.
        file: String,
        /// What is wrong with it.
        source: io::Error,
    },
    /// A file that no FMU of this crate has: it would leave the archive, or is no library of its platform.
    Refused {
        /// What the archive is called.
        file: String,
        /// The path in the archive.
        entry: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A file that two FMUs have with different content.
    Differs {
        /// Its path in the archives.
        entry: String,
        /// The FMU that had it first.
        first: String,
        /// The one that has it otherwise.
        second: String,
    },
    /// A file that only one of two FMUs has.
    Missing {
        /// Its path in the archive.
        entry: String,
        /// The FMU that has it.
        has: String,
        /// The one without it.
        lacks: String,
    },
    /// Writing failed.
    Write(io::Error),
}

impl fmt::Display for MergeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { file, source } => write!(f, "{file} is no FMU that can be read: {source}"),
            Self::Refused {
                file,
                entry,
                reason,
            } => write!(
                f,
                "{file}: the entry `{}` is refused: {reason}",
                shortened(entry)
            ),
            Self::Differs {
                entry,
                first,
                second,
            } => write!(f, "{entry} differs between {first} and {second}"),
            Self::Missing { entry, has, lacks } => {
                write!(f, "{entry} is in {has} and not in {lacks}")
            }
            Self::Write(error) => write!(f, "the FMU cannot be written: {error}"),
        }
    }
}

impl std::error::Error for MergeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Read { source, .. } | Self::Write(source) => Some(source),
            _ => None,
        }
    }
}

/// The files of an archive, by path, in its order; folders are none.
type Files = Vec<(String, Vec<u8>)>;

/// An FMU that is taken apart.
struct Part<'n> {
    name: &'n str,
    /// What does not depend on the platform.
    model: Files,
    binaries: Files,
}

impl<'n> Part<'n> {
    fn read(name: &'n str, source: impl Read + Seek) -> Result<Self, MergeError> {
        let files = files(source).map_err(|fault| match fault {
            Fault::Archive(source) => MergeError::Read {
                file: name.into(),
                source,
            },
            Fault::Entry(entry, reason) => MergeError::Refused {
                file: name.into(),
                entry,
                reason,
            },
        })?;
        let (binaries, model) = files
            .into_iter()
            .partition(|(path, _)| path.starts_with(BINARIES));
        Ok(Self {
            name,
            model,
            binaries,
        })
    }

    /// Whether it is the same model: the same files with the same bytes, in any order.
    fn same_model(&self, other: &Self) -> Result<(), MergeError> {
        for (has, lacks) in [(self, other), (other, self)] {
            let there: BTreeMap<_, _> = lacks.model.iter().map(|(p, c)| (p, c)).collect();
            for (entry, content) in &has.model {
                let Some(&same) = there.get(entry) else {
                    return Err(MergeError::Missing {
                        entry: entry.clone(),
                        has: has.name.into(),
                        lacks: lacks.name.into(),
                    });
                };
                if same != content {
                    return Err(MergeError::Differs {
                        entry: entry.clone(),
                        first: self.name.into(),
                        second: other.name.into(),
                    });
                }
            }
        }
        Ok(())
    }
}

/// What is wrong with an archive.
enum Fault {
    Archive(io::Error),
    /// An entry, and why it is refused.
    Entry(String, String),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Archive(error)
    }
}

impl From<ZipError> for Fault {
    fn from(error: ZipError) -> Self {
        Self::Archive(io::Error::other(error))
    }
}

/// More than any FMU of this crate takes unpacked \[MB\].
const LARGEST: u64 = 256;

fn files(source: impl Read + Seek) -> Result<Files, Fault> {
    let mut archive = ZipArchive::new(source)?;
    let mut files = Files::new();
    let mut total = 0_u64;
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index)?;
        let path = entry.name()?.into_owned();
        let refused = |reason: String| Fault::Entry(path.clone(), reason);
        check_name(&path).map_err(|reason| refused(reason.into()))?;
        if !is_plain(entry.unix_mode()) {
            return Err(refused("it is a link or a device".into()));
        }
        if entry.is_dir() {
            continue;
        }
        let size = entry.size();
        total = total.saturating_add(size);
        if total > LARGEST << 20 {
            return Err(refused(format!(
                "with it the archive unpacks to over {LARGEST} MB"
            )));
        }
        // Memory grows with what comes, and one byte more shows an entry that is longer than it says.
        let mut content = Vec::new();
        let read = entry.by_ref().take(size + 1).read_to_end(&mut content);
        read.map_err(|error| refused(format!("it does not unpack: {error}")))?;
        if content.len() as u64 != size {
            return Err(refused(format!(
                "it does not unpack to the {size} bytes that it declares"
            )));
        }
        if path.starts_with(BINARIES) {
            let platform = Platform::of_path(&path)
                .ok_or_else(|| refused("it is no library that `ugv package` adds".into()))?;
            if !platform.belongs(&path, &content) {
                let name = platform.name();
                let reason =
                    format!("it is no 64-bit shared library for {name}, or for another processor");
                return Err(refused(reason));
            }
        }
        drop(entry);
        files.push((path, content));
    }
    if !files.iter().any(|(path, _)| path == "modelDescription.xml") {
        return Err(io::Error::other("it has no modelDescription.xml").into());
    }
    Ok(files)
}

/// Refuses a name that leads out of the folder into which some system unpacks it.
fn check_name(path: &str) -> Result<(), &'static str> {
    let path = path.strip_suffix('/').unwrap_or(path);
    if path.contains(char::is_control) {
        return Err("its name has control characters");
    }
    // Drives and streams of Windows, and its separator.
    if path.contains(['\\', ':']) {
        return Err("its name has a backslash or a colon");
    }
    if path.split('/').any(|part| matches!(part, "" | "." | "..")) {
        return Err("its name leads out of the archive");
    }
    Ok(())
}

/// Whether an entry is a file or folder by the kind in its mode (`sys/stat.h`), where it has one.
fn is_plain(mode: Option<u32>) -> bool {
    mode.is_none_or(|mode| matches!(mode & 0o170_000, 0 | 0o100_000 | 0o040_000))
}

/// Writes one FMU with the binaries of all parts, each a name for messages and an archive. All else
/// has to be the same in each, byte for byte. The result is what packaging all libraries at
/// once gives, whatever the order of the parts. Returns the paths of the binaries.
///
/// # Errors
/// Parts of different models, parts with different binaries in the same place, files that are no FMU,
/// or a failure to write.
pub fn merge_fmus<W: Write + Seek, R: Read + Seek>(
    target: W,
    parts: impl IntoIterator<Item = (String, R)>,
) -> Result<Vec<String>, MergeError> {
    let sources: Vec<(String, R)> = parts.into_iter().collect();
    let (names, sources): (Vec<String>, Vec<R>) = sources.into_iter().unzip();
    let mut parts = Vec::new();
    for (name, source) in names.iter().zip(sources) {
        parts.push(Part::read(name, source)?);
    }
    let mut binaries = BTreeMap::new();
    for part in &parts {
        parts[0].same_model(part)?;
        for (path, content) in &part.binaries {
            let known = binaries
                .entry((Platform::of_path(path), path.as_str()))
                .or_insert((part.name, content.as_slice()));
            if known.1 != content {
                return Err(MergeError::Differs {
                    entry: path.clone(),
                    first: known.0.into(),
                    second: part.name.into(),
                });
            }
        }
    }
    let mut zip = ZipWriter::new(target);
    let model = parts.first().map_or(&[][..], |part| &part.model);
    let model = model
        .iter()
        .map(|(path, content)| (path.as_str(), &content[..]));
    let binaries = binaries
        .iter()
        .map(|((_, path), (_, content))| (*path, *content));
    let mut merged = Vec::new();
    for (path, content) in model.chain(binaries) {
        add(&mut zip, path, content).map_err(MergeError::Write)?;
        if path.starts_with(BINARIES) {
            merged.push(path.to_owned());
        }
    }
    zip.finish()
        .map_err(|error| MergeError::Write(io::Error::other(error)))?;
    Ok(merged)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::declaration::{Configuration, MARK};
    use crate::package::Standard;
    use crate::package::library::minimal;
    use crate::package::write_fmu;
    use std::io::Cursor;

    fn library(platform: Platform) -> (Platform, Vec<u8>) {
        let library = match platform {
            Platform::Linux64 => minimal::elf(62),
            Platform::Aarch64Linux => minimal::elf(183),
            Platform::Win64 => minimal::pe(0x8664),
            Platform::Darwin64 => minimal::universal(&[0x0100_0007, 0x0100_000c]),
        };
        (platform, [library, MARK.into()].concat())
    }

    fn packed(configuration: &Configuration, libraries: &[(Platform, Vec<u8>)]) -> Vec<u8> {
        packed_for(Standard::Fmi2, configuration, libraries)
    }

    fn packed_for(
        standard: Standard,
        configuration: &Configuration,
        libraries: &[(Platform, Vec<u8>)],
    ) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        write_fmu(&mut bytes, standard, configuration, libraries).unwrap();
        bytes.into_inner()
    }

    fn merged(parts: &[(&str, &[u8])]) -> Result<Vec<u8>, MergeError> {
        let mut bytes = Cursor::new(Vec::new());
        let parts = parts
            .iter()
            .map(|(name, part)| ((*name).to_owned(), Cursor::new(*part)));
        merge_fmus(&mut bytes, parts)?;
        Ok(bytes.into_inner())
    }

    #[test]
    fn parts_in_any_order_give_what_packaging_at_once_gives() {
        let own = Configuration::default();
        for standard in [Standard::Fmi2, Standard::Fmi3] {
            let packed = |libraries: &[_]| packed_for(standard, &own, libraries);
            let [a, b, c] = [Platform::Linux64, Platform::Win64, Platform::Darwin64].map(library);
            let whole = packed(&[c.clone(), a.clone(), b.clone()]);
            let parts = [packed(&[a, b.clone()]), packed(&[c, b])];
            for pair in [
                [("a", &parts[0][..]), ("b", &parts[1])],
                [("b", &parts[1]), ("a", &parts[0])],
                [("whole", &whole), ("again", &whole)],
            ] {
                assert_eq!(merged(&pair).unwrap(), whole);
            }
        }
    }

    #[test]
    fn what_differs_is_named() {
        let own = Configuration::default();
        let mut heavier = own.clone();
        heavier.vehicle.mass += 1.0;
        let (platform, mut changed) = library(Platform::Linux64);
        let linux = packed(&own, &[(platform, changed.clone())]);
        let other = packed(&heavier, &[library(Platform::Win64)]);
        let message = |parts: &[(&str, &[u8])]| merged(parts).unwrap_err().to_string();
        assert_eq!(
            message(&[("a.fmu", &linux), ("b.fmu", &other)]),
            "modelDescription.xml differs between a.fmu and b.fmu"
        );
        changed.push(0);
        let rebuilt = packed(&own, &[(platform, changed)]);
        assert_eq!(
            message(&[("a.fmu", &linux), ("b.fmu", &rebuilt)]),
            "binaries/linux64/ugv.so differs between a.fmu and b.fmu"
        );
        let mut more = ZipWriter::new_append(Cursor::new(linux.clone())).unwrap();
        add(&mut more, "resources/more.json", b"{}").unwrap();
        let more = more.finish().unwrap().into_inner();
        for parts in [
            [("a.fmu", &linux[..]), ("more.fmu", &more[..])],
            [("more.fmu", &more), ("a.fmu", &linux)],
        ] {
            assert_eq!(
                message(&parts),
                "resources/more.json is in more.fmu and not in a.fmu"
            );
        }
    }

    #[test]
    fn what_is_no_fmu_is_refused() {
        let linux = packed(&Configuration::default(), &[library(Platform::Linux64)]);
        let cut = &linux[..linux.len() / 2];
        let empty = ZipWriter::new(Cursor::new(Vec::new()));
        let empty = empty.finish().unwrap().into_inner();
        for part in [b"rubbish", cut, &empty[..]] {
            let error = merged(&[("a.fmu", &linux), ("b.fmu", part)]).unwrap_err();
            assert!(matches!(&error, MergeError::Read { file, .. } if file == "b.fmu"));
        }
    }
}
