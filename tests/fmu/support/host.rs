//! Programs in C that load the library of the FMU under test.

use super::{fmu, has, root, standard_headers};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A compiled program, the unpacked FMU and its guid.
pub struct Host {
    folder: tempfile::TempDir,
    guid: String,
}

impl Host {
    /// Compiles `tests/fmu/SOURCE` and unpacks the FMU; `None`, and says so, where something is missing.
    pub fn compile(source: &str) -> Option<Self> {
        let (fmu, headers) = (fmu()?, standard_headers()?);
        if !has("gcc", "gcc libc6-dev") {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let mut archive = zip::ZipArchive::new(std::fs::File::open(&fmu).unwrap()).unwrap();
        archive.extract(folder.path()).unwrap();
        let description = folder.path().join("modelDescription.xml");
        let description = std::fs::read_to_string(description).unwrap();
        let (_, rest) = description.split_once(" guid=\"").unwrap();
        let guid = rest.split_once('"').unwrap().0.to_owned();
        let host = Self { folder, guid };
        let compiled = Command::new("gcc")
            .args(["-std=c11", "-D_GNU_SOURCE", "-O1", "-g", "-Wall", "-Wextra"])
            // Each program uses some of what the headers hold.
            .args(["-Werror", "-Wno-unused-function"])
            .arg("-I")
            .arg(headers)
            .arg("-I")
            .arg(root().join("modelDescription"))
            .arg("-o")
            .arg(host.program())
            .arg(root().join("tests/fmu").join(source))
            .args(["-ldl", "-lm", "-lpthread"])
            .status()
            .unwrap();
        assert!(compiled.success());
        Some(host)
    }

    /// The program.
    pub fn program(&self) -> PathBuf {
        self.folder.path().join("host")
    }

    /// The FMU's library.
    pub fn library(&self) -> PathBuf {
        self.folder.path().join("binaries/linux64/ugv.so")
    }

    /// The FMU's resources as FMI 3.0 names them, and as FMI 2.0 does.
    pub fn resources(&self) -> [String; 2] {
        let path = self.folder.path().join("resources");
        [format!("{}/", path.display()), uri(&path)]
    }

    /// Identity of the model, to both versions of the standard.
    pub fn guid(&self) -> &str {
        &self.guid
    }

    /// Runs a program for both versions of the standard, which must succeed; what it printed.
    pub fn run_both(&self, last: &[&str]) -> String {
        let mut command = Command::new(self.program());
        command.arg(self.library()).args(self.resources());
        printed(&command.arg(self.guid()).args(last).output().unwrap())
    }
}

/// What a program printed, which must have succeeded.
pub fn printed(output: &Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}\n{errors}", output.status);
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn uri(path: &Path) -> String {
    format!("file://{}", path.display())
}
