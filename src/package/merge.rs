//! Brings the shared libraries of several FMUs of one model into one file.

use super::archive::{Platform, add};
use crate::display::shortened;
use std::collections::BTreeMap;
use std::io::{self, Read, Seek, Write};
use zip::{ZipArchive, ZipWriter};

const BINARIES: &str = "binaries/";

/// Why FMUs cannot be merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A file that is no archive, or a broken one.
    #[error("{file} is no FMU that can be read: {source}")]
    Read {
        /// Name of the archive.
        file: String,
        /// What is wrong with it.
        source: io::Error,
    },
    /// An entry that no FMU of this crate has: it would be unpacked outside of the folder, or is no library of its platform.
    #[error("{file}: the entry `{}` is refused: {reason}", shortened(.entry))]
    Refused {
        /// Name of the archive.
        file: String,
        /// The path in the archive.
        entry: String,
        /// What is wrong with it.
        reason: String,
    },
    /// An entry with different content in two FMUs.
    #[error("{entry} differs between {first} and {second}")]
    Differs {
        /// Its path in the archives.
        entry: String,
        /// The first FMU.
        first: String,
        /// The other one.
        second: String,
    },
    /// An entry of only one of two FMUs.
    #[error("{entry} is in {has} and not in {lacks}")]
    Missing {
        /// Its path in the archive.
        entry: String,
        /// The FMU that has it.
        has: String,
        /// The one without it.
        lacks: String,
    },
    /// Writing failed.
    #[error("the FMU cannot be written: {0}")]
    Write(#[from] io::Error),
}

/// Path and content of the files of an archive, in its order, without folders.
type Files = Vec<(String, Vec<u8>)>;

/// An unpacked FMU.
struct Unpacked<'n> {
    name: &'n str,
    /// The files that do not depend on the platform.
    model: Files,
    binaries: Files,
}

impl<'n> Unpacked<'n> {
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

impl<E: Into<io::Error>> From<E> for Fault {
    fn from(error: E) -> Self {
        Self::Archive(error.into())
    }
}

/// Limit for the unpacked size of an FMU \[MB\].
const MAX_SIZE: u64 = 256;

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
        if total > MAX_SIZE << 20 {
            return Err(refused(format!(
                "with it the archive unpacks to over {MAX_SIZE} MB"
            )));
        }
        // Memory grows with the content. One byte more reveals an entry that is longer than declared.
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

/// Refuses a name that leads out of the target folder when some system unpacks it.
fn check_name(path: &str) -> Result<(), &'static str> {
    let path = path.strip_suffix('/').unwrap_or(path);
    if path.contains(char::is_control) {
        return Err("its name has control characters");
    }
    // Drives and streams of Windows, and its separator.
    if path.contains(['\\', ':']) {
        return Err("its name has a backslash or a colon");
    }
    if path.split('/').any(|step| matches!(step, "" | "." | "..")) {
        return Err("its name leads out of the archive");
    }
    Ok(())
}

/// Whether an entry is a file or folder by the kind in its mode (`sys/stat.h`), where it has one.
fn is_plain(mode: Option<u32>) -> bool {
    mode.is_none_or(|mode| matches!(mode & 0o170_000, 0 | 0o100_000 | 0o040_000))
}

/// Writes one FMU with the binaries of several, each given by a name for messages and an archive. All
/// other files must be identical. The result is independent of the order and identical to packaging
/// all libraries at once. Returns the paths of the binaries.
///
/// # Errors
/// FMUs of different models, FMUs with different binaries for the same platform, files that are no FMU,
/// or a failure to write.
pub fn merge_fmus<W: Write + Seek, R: Read + Seek>(
    target: W,
    fmus: impl IntoIterator<Item = (String, R)>,
) -> Result<Vec<String>, MergeError> {
    let sources: Vec<(String, R)> = fmus.into_iter().collect();
    let (names, sources): (Vec<String>, Vec<R>) = sources.into_iter().unzip();
    let mut fmus = Vec::new();
    for (name, source) in names.iter().zip(sources) {
        fmus.push(Unpacked::read(name, source)?);
    }
    let mut binaries = BTreeMap::new();
    for fmu in &fmus {
        fmus[0].same_model(fmu)?;
        for (path, content) in &fmu.binaries {
            let known = binaries
                .entry((Platform::of_path(path), path.as_str()))
                .or_insert((fmu.name, content.as_slice()));
            if known.1 != content {
                return Err(MergeError::Differs {
                    entry: path.clone(),
                    first: known.0.into(),
                    second: fmu.name.into(),
                });
            }
        }
    }
    let mut zip = ZipWriter::new(target);
    let model = fmus.first().map_or(&[][..], |fmu| &fmu.model);
    let model = model
        .iter()
        .map(|(path, content)| (path.as_str(), &content[..]));
    let binaries = binaries
        .iter()
        .map(|((_, path), (_, content))| (*path, *content));
    let mut merged = Vec::new();
    for (path, content) in model.chain(binaries) {
        add(&mut zip, path, content)?;
        if path.starts_with(BINARIES) {
            merged.push(path.to_owned());
        }
    }
    zip.finish().map_err(io::Error::from)?;
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

    fn merged(fmus: &[(&str, &[u8])]) -> Result<Vec<u8>, MergeError> {
        let mut bytes = Cursor::new(Vec::new());
        let fmus = fmus
            .iter()
            .map(|(name, fmu)| ((*name).to_owned(), Cursor::new(*fmu)));
        merge_fmus(&mut bytes, fmus)?;
        Ok(bytes.into_inner())
    }

    #[test]
    fn merging_in_any_order_equals_packaging_at_once() {
        let own = Configuration::default();
        for standard in [Standard::Fmi2, Standard::Fmi3] {
            let packed = |libraries: &[_]| packed_for(standard, &own, libraries);
            let [a, b, c] = [Platform::Linux64, Platform::Win64, Platform::Darwin64].map(library);
            let whole = packed(&[c.clone(), a.clone(), b.clone()]);
            let fmus = [packed(&[a, b.clone()]), packed(&[c, b])];
            for pair in [
                [("a", &fmus[0][..]), ("b", &fmus[1])],
                [("b", &fmus[1]), ("a", &fmus[0])],
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
        let message = |fmus: &[(&str, &[u8])]| merged(fmus).unwrap_err().to_string();
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
        for fmus in [
            [("a.fmu", &linux[..]), ("more.fmu", &more[..])],
            [("more.fmu", &more), ("a.fmu", &linux)],
        ] {
            assert_eq!(
                message(&fmus),
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
        for fmu in [b"rubbish", cut, &empty[..]] {
            let error = merged(&[("a.fmu", &linux), ("b.fmu", fmu)]).unwrap_err();
            assert!(matches!(&error, MergeError::Read { file, .. } if file == "b.fmu"));
        }
    }
}
