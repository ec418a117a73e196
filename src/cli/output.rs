//! Files that appear whole or not at all.

use super::Failure;
use std::fs;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, SpooledTempFile};

/// Bytes of output that are kept in memory; what is longer goes to a temporary file.
const SPOOL_BYTES: usize = 64 << 20;

/// Where output goes in the end.
#[derive(Debug, Clone, PartialEq)]
enum Target {
    Stdout,
    File(PathBuf),
}

/// Output that is collected and only shows when it is complete.
#[derive(Debug)]
pub struct Output {
    target: Target,
    spool: BufWriter<SpooledTempFile>,
}

impl Output {
    /// Output to a file, or to standard output for `-` or nothing.
    ///
    /// # Errors
    /// A folder that is not there or cannot be written, or a folder in the file's place: better
    /// known before the work than after it.
    pub fn to(path: Option<&Path>) -> Result<Self, Failure> {
        let target = match path {
            None => Target::Stdout,
            Some(path) if path == Path::new("-") => Target::Stdout,
            Some(path) => Target::File(path.into()),
        };
        let spool = match &target {
            // Where there is room for the file, there is for what becomes it.
            Target::File(path) => SpooledTempFile::new_in(SPOOL_BYTES, folder(path)),
            Target::Stdout => SpooledTempFile::new(SPOOL_BYTES),
        };
        let output = Self {
            target,
            spool: BufWriter::new(spool),
        };
        match &output.target {
            Target::File(path) => check_place(path).map_err(|source| output.failure(source))?,
            Target::Stdout => {}
        }
        Ok(output)
    }

    /// As [`Output::to`], for what is made of some files: neither those nor what stands beside a recording is replaced.
    ///
    /// # Errors
    /// As [`Output::to`], and a path that leads to one of these files.
    pub fn of<'a>(
        path: Option<&Path>,
        made_of: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<Self, Failure> {
        let output = Self::to(path)?;
        for source in made_of {
            let beside = source.with_extension("json");
            if output.is_at(source) || output.is_at(&beside) {
                let path = path.map_or_else(String::new, |path| path.display().to_string());
                return Err(Failure::Argument {
                    reason: format!("{path} is what is read, or stands beside it"),
                    hint: Some("take another name, or another folder".into()),
                });
            }
        }
        Ok(output)
    }

    fn is_at(&self, other: &Path) -> bool {
        matches!(&self.target, Target::File(path) if place(path) == place(other))
    }

    /// Whether both would end up in the same place.
    pub fn collides_with(&self, other: &Self) -> bool {
        match &other.target {
            Target::Stdout => self.target == Target::Stdout,
            Target::File(path) => self.is_at(path),
        }
    }

    /// What goes wrong in writing, told with the target.
    pub fn failure(&self, source: io::Error) -> Failure {
        let target = match &self.target {
            Target::Stdout => "standard output".into(),
            Target::File(path) => path.display().to_string(),
        };
        Failure::Write { target, source }
    }

    /// Brings everything written so far to where it belongs, as a last step.
    ///
    /// # Errors
    /// Whatever the file system refuses. A reader of standard output that has seen enough
    /// is no error.
    pub fn finish(mut self) -> Result<(), Failure> {
        // Seeking writes what the buffer holds.
        let done = self.spool.rewind().and_then(|()| match &self.target {
            Target::Stdout => ignore_broken_pipe(copy(self.spool.get_mut(), io::stdout().lock())),
            Target::File(path) => replace(self.spool.get_mut(), path),
        });
        done.map_err(|source| self.failure(source))
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.spool.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.spool.flush()
    }
}

/// Prints a text.
pub fn write_stdout(text: &str) -> Result<(), Failure> {
    let mut output = Output::to(None)?;
    output
        .write_all(text.as_bytes())
        .map_err(|source| output.failure(source))?;
    output.finish()
}

fn check_place(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    match fs::metadata(folder(path)) {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => return Err(io::ErrorKind::NotADirectory.into()),
        Err(error) => return Err(error),
    }
    let existing = fs::canonicalize(path).ok();
    let path = existing.as_deref().unwrap_or(path);
    if takes_a_file(fs::metadata(path).ok().as_ref()) {
        temporary_file(folder(path))?;
    }
    Ok(())
}

/// Whether a file can take the place of what is there, if there is anything.
fn takes_a_file(there: Option<&fs::Metadata>) -> bool {
    there.is_none_or(fs::Metadata::is_file)
}

/// A file's place whatever way leads there; the file need not be there yet.
fn place(path: &Path) -> PathBuf {
    if let Ok(there) = fs::canonicalize(path) {
        return there;
    }
    match (fs::canonicalize(folder(path)), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.into(),
    }
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

fn copy(spool: &mut SpooledTempFile, mut to: impl Write) -> io::Result<()> {
    io::copy(spool, &mut to)?;
    to.flush()
}

fn ignore_broken_pipe(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Writes beside the file and renames, so that at no moment half a file stands there.
fn replace(spool: &mut SpooledTempFile, path: &Path) -> io::Result<()> {
    // A link stays a link: what it leads to is replaced.
    let existing = fs::canonicalize(path).ok();
    let path = existing.as_deref().unwrap_or(path);
    let replaced = fs::metadata(path).ok();
    if !takes_a_file(replaced.as_ref()) {
        // Nothing can be renamed over a device or a named pipe.
        return copy(spool, fs::OpenOptions::new().write(true).open(path)?);
    }
    let mut beside = temporary_file(folder(path))?;
    copy(spool, &mut beside)?;
    if let Some(metadata) = replaced {
        beside.as_file().set_permissions(metadata.permissions())?;
    }
    beside.persist(path)?;
    Ok(())
}

/// A temporary file with the permissions of any new file, not only the owner's.
fn temporary_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".ugv-");
    #[cfg(unix)]
    builder.permissions(<fs::Permissions as std::os::unix::fs::PermissionsExt>::from_mode(0o666));
    builder.tempfile_in(folder).map_err(|error| {
        // The system's words without the temporary name, which nobody knows.
        let told = error.to_string();
        let words = told.rsplit_once(" at path ");
        io::Error::new(error.kind(), words.map_or(&*told, |(words, _)| words))
    })
}
