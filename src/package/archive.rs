//! The FMU's archive.

use super::documentation::documentation;
use super::library::Target;
use super::model_description::model_description;
use super::standard::{MODEL_IDENTIFIER, Standard};
use crate::declaration::{Configuration, MARK};
use std::io::{self, Seek, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

const ICON: &[u8] = include_bytes!("../../modelDescription/model.png");
const TERMINALS: &str = include_str!("../../modelDescription/terminalsAndIcons.xml");
const LICENSES: &str = "SPDX-License-Identifier: MIT OR Apache-2.0

Either of the two licences beside this file, at your option: LICENSE-MIT.txt, LICENSE-APACHE.txt.
What is linked into the libraries keeps its own: THIRD-PARTY.txt.
";
/// Written by `scripts/tools/third_party.py`.
const THIRD_PARTY: &str = include_str!("../../modelDescription/third_party.txt");
const LICENSE_MIT: &str = include_str!("../../LICENSE-MIT");
const LICENSE_APACHE: &str = include_str!("../../LICENSE-APACHE");

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

    /// Its folders under `binaries/`, and the targets of the libraries there. FMI 3.0 has one folder for each
    /// processor; the libraries of macOS may be for both.
    fn folders(self, standard: Standard) -> &'static [(&'static str, &'static [Target])] {
        match (standard, self) {
            (Standard::Fmi2, Self::Linux64) => &[("linux64", &[Target::LinuxX86])],
            (Standard::Fmi2, Self::Win64) => &[("win64", &[Target::WindowsX86])],
            (Standard::Fmi2, Self::Darwin64) => &[("darwin64", &[Target::MacArm, Target::MacX86])],
            (_, Self::Aarch64Linux) => &[("aarch64-linux", &[Target::LinuxArm])],
            (Standard::Fmi3, Self::Linux64) => &[("x86_64-linux", &[Target::LinuxX86])],
            (Standard::Fmi3, Self::Win64) => &[("x86_64-windows", &[Target::WindowsX86])],
            (Standard::Fmi3, Self::Darwin64) => &[
                ("aarch64-darwin", &[Target::MacArm]),
                ("x86_64-darwin", &[Target::MacX86]),
            ],
        }
    }

    /// The folders for a library: on macOS those of its processors. None where it is built for another platform.
    fn folders_of(self, standard: Standard, library: &[u8]) -> impl Iterator<Item = &'static str> {
        let found = Target::of(library);
        let folders = self.folders(standard).iter();
        let fits = move |targets: &[Target]| found.iter().any(|target| targets.contains(target));
        folders
            .filter(move |(_, targets)| fits(targets))
            .map(|(folder, _)| *folder)
    }

    /// The platform whose library has this path in an archive of either standard.
    pub(super) fn of_path(path: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|platform| {
            let folders = Standard::ALL
                .iter()
                .flat_map(|standard| platform.folders(*standard));
            folders
                .into_iter()
                .any(|(folder, _)| platform.path(folder) == path)
        })
    }

    /// Whether a library is built for the platform of its path in an archive.
    pub(super) fn belongs(self, path: &str, library: &[u8]) -> bool {
        let of = |standard: &Standard| self.folders_of(*standard, library);
        Standard::ALL
            .iter()
            .flat_map(of)
            .any(|folder| self.path(folder) == path)
    }

    /// The path of a library in an archive.
    fn path(self, folder: &str) -> String {
        format!("binaries/{folder}/{MODEL_IDENTIFIER}.{}", self.extension())
    }

    fn extension(self) -> &'static str {
        match self {
            Self::Linux64 | Self::Aarch64Linux => "so",
            Self::Win64 => "dll",
            Self::Darwin64 => "dylib",
        }
    }
}

/// Why an FMU cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PackageError {
    /// A file that is no shared library of its platform.
    #[error("the library for {} is not built for that platform", .0.name())]
    WrongPlatform(Platform),
    /// A shared library of another version, which would refuse this model description.
    #[error("the library for {} was built from another version of ugv-terrain", .0.name())]
    OtherVersion(Platform),
    /// Writing failed.
    #[error("the FMU cannot be written: {0}")]
    Write(#[from] io::Error),
}

impl From<zip::result::ZipError> for PackageError {
    fn from(error: zip::result::ZipError) -> Self {
        Self::Write(error.into())
    }
}

/// Writes the FMU of a configuration with the given shared libraries, for a version of the
/// standard. The same input gives the same bytes, independent of the order of the libraries: entries
/// have a fixed order and time.
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
        if platform.folders_of(standard, library).next().is_none() {
            return Err(PackageError::WrongPlatform(*platform));
        }
        if !contains(library, MARK.as_bytes()) {
            return Err(PackageError::OtherVersion(*platform));
        }
    }
    let mut zip = ZipWriter::new(target);
    let mut add = |name: &str, content: &[u8]| add(&mut zip, name, content);
    let description = model_description(standard, configuration);
    add("modelDescription.xml", description.as_bytes())?;
    match standard {
        Standard::Fmi2 => add("model.png", ICON)?,
        // FMI 3.0 has the icon only there. FMI 2.0 would gain nothing, and FMI Library 3 refuses an FMU of FMI 2.0
        // with this file.
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
    // Both standards define this name for the entry point.
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
        for folder in platform.folders_of(standard, library) {
            add(&platform.path(folder), library)?;
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
    zip.start_file(name, options)?;
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
    use crate::package::library::minimal;
    use std::io::{Cursor, Read};

    fn library() -> Vec<u8> {
        [minimal::elf(62), MARK.into()].concat()
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
        // With these files FMI Library 3 refuses an FMU of FMI 2.0.
        for name in archive.file_names() {
            assert!(!name.unwrap().starts_with("terminalsAndIcons"));
        }
    }

    #[test]
    fn libraries_of_macos_are_found_on_the_processors_that_they_are_for() {
        let folders = |library: Vec<u8>| {
            let library = [library, MARK.into()].concat();
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
        let (x86, arm) = (0x0100_0007, 0x0100_000c);
        assert_eq!(folders(minimal::universal(&[x86, arm])), [true, true]);
        assert_eq!(folders(minimal::mach_o(x86)), [true, false]);
        assert_eq!(folders(minimal::mach_o(arm)), [false, true]);
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
