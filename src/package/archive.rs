//! The FMU's archive.

use super::{MODEL_IDENTIFIER, documentation, model_description, model_description_3};
use crate::declaration::{Configuration, MARK};
use std::fmt;
use std::io::{self, Seek, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

const ICON: &[u8] = include_bytes!("../../modelDescription/model.png");
const TERMINALS: &str = include_str!("../../modelDescription/terminalsAndIcons.xml");
const LICENSES: &str = "SPDX-License-Identifier: MIT OR Apache-2.0

Either of the two licences beside this file, at your option: LICENSE-MIT.txt, LICENSE-APACHE.txt.
What is linked into the libraries keeps its own: THIRD-PARTY.txt.
";
/// Written by `scripts/third_party.py`.
const THIRD_PARTY: &str = include_str!("../../modelDescription/third_party.txt");
const LICENSE_MIT: &str = include_str!("../../LICENSE-MIT");
const LICENSE_APACHE: &str = include_str!("../../LICENSE-APACHE");

/// A version of the standard. One shared library serves them all; what differs is the archive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

/// A platform that an FMU can hold a shared library for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Platform {
    /// 64-bit Linux on x86.
    Linux64,
    /// 64-bit Windows on x86.
    Win64,
    /// 64-bit macOS, on x86 or both there and on ARM.
    Darwin64,
    /// 64-bit Linux on ARM.
    Aarch64Linux,
}

impl Platform {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Linux64,
        Self::Win64,
        Self::Darwin64,
        Self::Aarch64Linux,
    ];

    /// Its name, that of its folder under `binaries/` in FMI 2.0.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Linux64 => "linux64",
            Self::Win64 => "win64",
            Self::Darwin64 => "darwin64",
            Self::Aarch64Linux => "aarch64-linux",
        }
    }

    /// The names of its folders under `binaries/`: FMI 3.0 has one for each processor, the libraries of macOS may be for both.
    fn folders(self, standard: Standard) -> &'static [&'static str] {
        match (standard, self) {
            (Standard::Fmi2, Self::Linux64) => &["linux64"],
            (Standard::Fmi2, Self::Win64) => &["win64"],
            (Standard::Fmi2, Self::Darwin64) => &["darwin64"],
            (_, Self::Aarch64Linux) => &["aarch64-linux"],
            (Standard::Fmi3, Self::Linux64) => &["x86_64-linux"],
            (Standard::Fmi3, Self::Win64) => &["x86_64-windows"],
            (Standard::Fmi3, Self::Darwin64) => &["aarch64-darwin", "x86_64-darwin"],
        }
    }

    /// Whether binaries for it lie in a folder of this name in either standard.
    pub(super) fn has_folder(self, name: &str) -> bool {
        [Standard::Fmi2, Standard::Fmi3]
            .into_iter()
            .any(|standard| self.folders(standard).contains(&name))
    }

    /// The folders that a library goes to: of macOS' those of the processors that it is for.
    fn folders_of(self, standard: Standard, library: &[u8]) -> &'static [&'static str] {
        let all = self.folders(standard);
        match (all.len(), library.get(..8)) {
            (2, Some([0xcf, 0xfa, 0xed, 0xfe, 0x0c, ..])) => &all[..1],
            (2, Some([0xcf, 0xfa, 0xed, 0xfe, 0x07, ..])) => &all[1..],
            _ => all,
        }
    }

    fn extension(self) -> &'static str {
        match self {
            Self::Linux64 | Self::Aarch64Linux => "so",
            Self::Win64 => "dll",
            Self::Darwin64 => "dylib",
        }
    }

    /// Whether bytes begin like a shared library of this platform: the format's magic, and
    /// in ELF the machine's number.
    fn recognises(self, library: &[u8]) -> bool {
        let elf =
            |machine: u8| library.starts_with(b"\x7fELF") && library.get(18) == Some(&machine);
        match self {
            Self::Linux64 => elf(62),
            Self::Aarch64Linux => elf(183),
            Self::Win64 => library.starts_with(b"MZ"),
            Self::Darwin64 => {
                library.starts_with(b"\xcf\xfa\xed\xfe") || library.starts_with(b"\xca\xfe\xba\xbe")
            }
        }
    }
}

/// Why an FMU cannot be made.
#[derive(Debug)]
pub enum PackageError {
    /// A file that is no shared library of its platform.
    WrongPlatform(Platform),
    /// A shared library of another version, which would refuse this model description.
    OtherVersion(Platform),
    /// Writing failed.
    Write(io::Error),
}

impl fmt::Display for PackageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongPlatform(platform) => {
                write!(
                    f,
                    "the library for {} is none for that platform",
                    platform.name()
                )
            }
            Self::OtherVersion(platform) => write!(
                f,
                "the library for {} was built from another version of ugv-terrain",
                platform.name()
            ),
            Self::Write(error) => write!(f, "the FMU cannot be written: {error}"),
        }
    }
}

impl std::error::Error for PackageError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Write(error) => Some(error),
            _ => None,
        }
    }
}

impl From<io::Error> for PackageError {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

impl From<zip::result::ZipError> for PackageError {
    fn from(error: zip::result::ZipError) -> Self {
        Self::Write(io::Error::other(error))
    }
}

/// Writes the FMU of a configuration with the given shared libraries, for a version of the
/// standard. The same input gives the same bytes, in whatever order the libraries come: entries are
/// in a fixed order and carry a fixed time.
///
/// # Errors
/// A library that does not fit, or a failure to write.
pub fn write_fmu<W: Write + Seek>(
    target: W,
    standard: Standard,
    configuration: &Configuration,
    libraries: &[(Platform, Vec<u8>)],
) -> Result<(), PackageError> {
    for (platform, library) in libraries {
        if !platform.recognises(library) {
            return Err(PackageError::WrongPlatform(*platform));
        }
        if !contains(library, MARK.as_bytes()) {
            return Err(PackageError::OtherVersion(*platform));
        }
    }
    let mut zip = ZipWriter::new(target);
    let mut add = |name: &str, content: &[u8]| add(&mut zip, name, content);
    let description = match standard {
        Standard::Fmi2 => model_description(configuration),
        Standard::Fmi3 => model_description_3(configuration),
    };
    add("modelDescription.xml", description.as_bytes())?;
    match standard {
        Standard::Fmi2 => add("model.png", ICON)?,
        // FMI 3.0 has the icon there alone. FMI 2.0 would gain nothing, and FMI Library 3 refuses the whole FMU for the
        // file's version.
        Standard::Fmi3 => {
            add(
                "terminalsAndIcons/terminalsAndIcons.xml",
                TERMINALS.as_bytes(),
            )?;
            add("terminalsAndIcons/icon.png", ICON)?;
        }
    }
    add(
        "documentation/index.html",
        documentation(standard, configuration).as_bytes(),
    )?;
    // The name under which both standards look for where to begin.
    add("documentation/licenses/license.txt", LICENSES.as_bytes())?;
    add(
        "documentation/licenses/LICENSE-MIT.txt",
        LICENSE_MIT.as_bytes(),
    )?;
    add(
        "documentation/licenses/LICENSE-APACHE.txt",
        LICENSE_APACHE.as_bytes(),
    )?;
    add(
        "documentation/licenses/THIRD-PARTY.txt",
        THIRD_PARTY.as_bytes(),
    )?;
    for (name, text) in configuration.to_resources() {
        add(&format!("resources/{name}"), text.as_bytes())?;
    }
    let mut libraries: Vec<&(Platform, Vec<u8>)> = libraries.iter().collect();
    libraries.sort_by_key(|(platform, _)| *platform);
    for (platform, library) in libraries {
        let extension = platform.extension();
        for folder in platform.folders_of(standard, library) {
            add(
                &format!("binaries/{folder}/{MODEL_IDENTIFIER}.{extension}"),
                library,
            )?;
        }
    }
    zip.finish()?;
    Ok(())
}

/// Adds a file: the same name and content give the same bytes.
pub(super) fn add<W: Write + Seek>(
    zip: &mut ZipWriter<W>,
    name: &str,
    content: &[u8],
) -> io::Result<()> {
    let executable = name.starts_with("binaries/");
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(if executable { 0o755 } else { 0o644 });
    zip.start_file(name, options).map_err(io::Error::other)?;
    zip.write_all(content)
}

fn contains(haystack: &[u8], needle: &[u8]) -> bool {
    let Some(first) = needle.first() else {
        return true;
    };
    let starts = haystack
        .iter()
        .enumerate()
        .filter(|(_, byte)| *byte == first);
    starts
        .map(|(index, _)| &haystack[index..])
        .any(|rest| rest.starts_with(needle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Read};

    fn library() -> Vec<u8> {
        let mut library = b"\x7fELF".to_vec();
        library.resize(64, 0);
        library[18] = 62;
        library.extend(MARK.as_bytes());
        library
    }

    fn packed(libraries: &[(Platform, Vec<u8>)]) -> Result<Vec<u8>, PackageError> {
        let mut bytes = Cursor::new(Vec::new());
        let configuration = Configuration::default();
        write_fmu(&mut bytes, Standard::Fmi2, &configuration, libraries)?;
        Ok(bytes.into_inner())
    }

    #[test]
    fn the_same_input_gives_the_same_bytes() {
        let libraries = [(Platform::Linux64, library())];
        assert_eq!(packed(&libraries).unwrap(), packed(&libraries).unwrap());
    }

    #[test]
    fn the_archive_holds_what_the_standard_asks_for() {
        let bytes = packed(&[(Platform::Linux64, library())]).unwrap();
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let mut content = Vec::new();
        archive
            .by_name("binaries/linux64/ugv.so")
            .unwrap()
            .read_to_end(&mut content)
            .unwrap();
        assert_eq!(content, library());
        for name in [
            "modelDescription.xml",
            "resources/vehicle.json",
            "documentation/index.html",
        ] {
            assert!(archive.by_name(name).is_ok(), "{name}");
        }
        // What is of FMI 3.0 alone makes FMI Library 3 refuse an FMU of FMI 2.0.
        for name in archive.file_names() {
            assert!(!name.unwrap().starts_with("terminalsAndIcons"));
        }
    }

    #[test]
    fn libraries_of_macos_are_found_on_the_processors_that_they_are_for() {
        let folders = |magic: &[u8]| {
            let library = [magic, MARK.as_bytes()].concat();
            let libraries = [(Platform::Darwin64, library)];
            let mut bytes = Cursor::new(Vec::new());
            let configuration = Configuration::default();
            write_fmu(&mut bytes, Standard::Fmi3, &configuration, &libraries).unwrap();
            let archive = zip::ZipArchive::new(bytes).unwrap();
            ["x86_64-darwin", "aarch64-darwin"].map(|folder| {
                let binary = format!("binaries/{folder}/ugv.dylib");
                archive.index_for_name(&binary).is_some()
            })
        };
        assert_eq!(folders(b"\xca\xfe\xba\xbe"), [true, true]);
        assert_eq!(folders(b"\xcf\xfa\xed\xfe\x07\0\0\x01"), [true, false]);
        assert_eq!(folders(b"\xcf\xfa\xed\xfe\x0c\0\0\x01"), [false, true]);
    }

    #[test]
    fn fmi_3_has_folders_and_an_icon_of_its_own() {
        let libraries = [(Platform::Linux64, library())];
        let mut bytes = Cursor::new(Vec::new());
        let configuration = Configuration::default();
        write_fmu(&mut bytes, Standard::Fmi3, &configuration, &libraries).unwrap();
        let mut archive = zip::ZipArchive::new(bytes).unwrap();
        for (name, there) in [
            ("binaries/x86_64-linux/ugv.so", true),
            ("terminalsAndIcons/icon.png", true),
            ("terminalsAndIcons/terminalsAndIcons.xml", true),
            ("binaries/linux64/ugv.so", false),
            ("model.png", false),
        ] {
            assert_eq!(archive.by_name(name).is_ok(), there, "{name}");
        }
        let mut description = String::new();
        let mut entry = archive.by_name("modelDescription.xml").unwrap();
        entry.read_to_string(&mut description).unwrap();
        assert!(description.contains("fmiVersion=\"3.0\""));
        for text in [
            "name=\"wheel.load\" valueReference=\"2002\"",
            "<Dimension start=\"8\"/>",
            "name=\"vehicle.row_positions\" valueReference=\"1000\"",
        ] {
            assert!(description.contains(text), "{text}");
        }
    }

    #[test]
    fn foreign_libraries_are_refused() {
        let without = &library()[..64];
        // The same variables, but built from another version of the crate.
        let (declared, _) = MARK.rsplit_once(' ').unwrap();
        for mark in [
            "".to_owned(),
            format!("{declared} 99.0.0\n"),
            format!("{}0\n", MARK.trim_end()),
        ] {
            let other = [without, mark.as_bytes()].concat();
            assert!(matches!(
                packed(&[(Platform::Linux64, other)]),
                Err(PackageError::OtherVersion(Platform::Linux64))
            ));
        }
        assert!(matches!(
            packed(&[(Platform::Win64, library())]),
            Err(PackageError::WrongPlatform(Platform::Win64))
        ));
    }
}
