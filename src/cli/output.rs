//! Files that appear whole or not at all.

use super::Failure;
use std::fs;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, SpooledTempFile, TempPath};
use ugv_terrain::display::visible;

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

    /// An error of writing, with the target's name instead of a temporary file's.
    pub fn failure(&self, source: io::Error) -> Failure {
        let target = match &self.target {
            Target::Stdout => "standard output".into(),
            Target::File(path) => path.display().to_string(),
        };
        let source = without_path(source);
        Failure::Write { target, source }
    }

    /// Adds a text.
    ///
    /// # Errors
    /// A disk that is full.
    pub fn with(mut self, text: &str) -> Result<Self, Failure> {
        let written = self.write_all(text.as_bytes());
        written.map_err(|source| self.failure(source))?;
        Ok(self)
    }

    /// Brings everything written so far to where it belongs, as a last step.
    ///
    /// # Errors
    /// As [`finish_all`].
    pub fn finish(self) -> Result<(), Failure> {
        finish_all([self])
    }

    /// Writes the content beside the file that it replaces; nothing for a stream.
    fn stage(&mut self) -> io::Result<Option<Staged>> {
        // Seeking writes what the buffer holds.
        self.spool.rewind()?;
        let Target::File(path) = &self.target else {
            return Ok(None);
        };
        // A link stays a link: what it leads to is replaced.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.clone());
        let replaced = fs::metadata(&path).ok();
        if !takes_a_file(replaced.as_ref()) {
            return Ok(None);
        }
        let content = temporary_file(folder(&path))?;
        let mut file = content.as_file();
        copy(self.spool.get_mut(), &mut file)?;
        if let Some(metadata) = replaced {
            file.set_permissions(metadata.permissions())?;
        }
        // Otherwise a crash soon after the renaming may leave an empty file.
        file.sync_all()?;
        Ok(Some(Staged { path, content }))
    }

    /// Writes to what no file can take the place of: standard output, a device, a named pipe.
    fn stream(&mut self) -> io::Result<()> {
        let spool = self.spool.get_mut();
        match &self.target {
            Target::Stdout => ignore_broken_pipe(copy(spool, io::stdout().lock())),
            Target::File(path) => copy(spool, fs::OpenOptions::new().write(true).open(path)?),
        }
    }
}

/// Brings several outputs to where they belong: all files or none, so that they always belong together.
///
/// Every file is first written beside its target. Only when all of them are on the disk are they renamed; where a
/// rename fails, those before it are taken back.
///
/// # Errors
/// Whatever the file system refuses. A reader of standard output that has seen enough is no error.
pub fn finish_all(outputs: impl IntoIterator<Item = Output>) -> Result<(), Failure> {
    let (mut streams, mut files) = (Vec::new(), Vec::new());
    for mut output in outputs {
        match output.stage() {
            Ok(Some(staged)) => files.push((output, staged)),
            Ok(None) => streams.push(output),
            Err(source) => return Err(output.failure(source)),
        }
    }
    for mut output in streams {
        output.stream().map_err(|source| output.failure(source))?;
    }
    let (outputs, files): (Vec<_>, Vec<_>) = files.into_iter().unzip();
    replace_all(files).map_err(|(place, source)| outputs[place].failure(source))
}

/// Content that is complete, beside the file that it is to replace.
struct Staged {
    path: PathBuf,
    content: NamedTempFile,
}

/// A file that has been replaced, with what was there before.
struct Replaced {
    path: PathBuf,
    before: Option<TempPath>,
}

impl Replaced {
    fn undo(self) {
        match self.before {
            Some(before) => {
                if let Err(error) = before.persist(&self.path) {
                    // Better under a strange name than lost.
                    let _ = error.path.keep();
                }
            }
            None => {
                let _ = fs::remove_file(&self.path);
            }
        }
    }
}

/// Renames all files or none; the place of the first that cannot be, and why.
fn replace_all(files: Vec<Staged>) -> Result<(), (usize, io::Error)> {
    let is_set = files.len() > 1;
    let mut done: Vec<Replaced> = Vec::new();
    for (place, Staged { path, content }) in files.into_iter().enumerate() {
        // One rename alone succeeds or changes nothing.
        let before = if is_set { second_name(&path) } else { Ok(None) };
        let renamed = before.and_then(|before| {
            content.persist(&path)?;
            Ok(before)
        });
        match renamed {
            Ok(before) => done.push(Replaced { path, before }),
            Err(error) => {
                done.into_iter().rev().for_each(Replaced::undo);
                return Err((place, error));
            }
        }
    }
    Ok(())
}

/// A second name for a file, if it is there; a copy where the file system has no such names.
fn second_name(path: &Path) -> io::Result<Option<TempPath>> {
    if !path.exists() {
        return Ok(None);
    }
    let link = |name: &Path| match fs::hard_link(path, name) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
            fs::copy(path, name).map(drop)
        }
        other => other,
    };
    let named = temporary().make_in(folder(path), link)?;
    Ok(Some(named.into_temp_path()))
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.spool.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.spool.flush()
    }
}

/// Prints data.
pub fn write_stdout(text: &str) -> Result<(), Failure> {
    Output::to(None)?.with(text)?.finish()
}

/// Prints a text for people, with visible escapes for what a terminal would obey. Line ends stay, so a foreign text
/// within a line goes through [`ugv_terrain::display::visible_line`] first.
pub fn print(text: &str) -> Result<(), Failure> {
    write_stdout(&visible(text))
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

/// A temporary file with the permissions of any new file, not only the owner's.
fn temporary_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = temporary();
    #[cfg(unix)]
    builder.permissions(<fs::Permissions as std::os::unix::fs::PermissionsExt>::from_mode(0o666));
    builder.tempfile_in(folder)
}

fn temporary() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".ugv-");
    builder
}

/// The system's words without the path of a temporary file, which nobody knows.
fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    match text.rsplit_once(" at path ") {
        Some((words, _)) => io::Error::new(error.kind(), words),
        None => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn staged(path: &Path, text: &str) -> Staged {
        let mut output = Output::to(Some(path)).unwrap().with(text).unwrap();
        output.stage().unwrap().unwrap()
    }

    #[test]
    fn a_set_that_cannot_be_renamed_as_a_whole_is_taken_back() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new, blocked] = ["old", "new", "blocked"].map(|name| folder.path().join(name));
        fs::write(&old, "before").unwrap();
        let set = || vec![staged(&old, "1"), staged(&new, "2"), staged(&blocked, "3")];
        let names = || {
            let entries = fs::read_dir(folder.path()).unwrap();
            let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
            names.sort();
            names
        };
        let files = set();
        // Nothing is renamed over a folder.
        fs::create_dir(&blocked).unwrap();
        let (place, _) = replace_all(files).unwrap_err();
        assert_eq!(place, 2);
        assert_eq!(fs::read_to_string(&old).unwrap(), "before");
        assert_eq!(names(), ["blocked", "old"]);
        fs::remove_dir(&blocked).unwrap();
        replace_all(set()).unwrap();
        let texts = [&old, &new, &blocked].map(|path| fs::read_to_string(path).unwrap());
        assert_eq!(texts, ["1", "2", "3"]);
        assert_eq!(names(), ["blocked", "new", "old"]);
    }
}
