//! What the user gets: files that appear complete or not at all, and texts on the terminal.

use super::failure::Failure;
use crate::display::{visible, visible_line};
use std::fs;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, SpooledTempFile, TempPath};

/// Bytes of output that stay in memory; a longer output goes to a temporary file.
const SPOOL_BYTES: usize = 64 << 20;

/// Whether an argument stands for standard input or output.
pub fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// Where output goes in the end.
#[derive(Debug, Clone, PartialEq)]
enum Destination {
    Stdout,
    File(PathBuf),
}

/// Output that is collected, and appears when it is complete.
#[derive(Debug)]
pub struct Output {
    destination: Destination,
    spool: BufWriter<SpooledTempFile>,
    /// Whether it replaces a file that exists.
    replaces: bool,
}

impl Output {
    /// Output to a file, or to standard output for `-` or nothing.
    ///
    /// # Errors
    /// A folder that does not exist or is not writable, or a folder with the file's name. The user learns of it before the
    /// work, not after it.
    pub fn to(path: Option<&Path>) -> Result<Self, Failure> {
        let destination = match path {
            Some(path) if !is_stream(path) => Destination::File(path.into()),
            _ => Destination::Stdout,
        };
        let spool = match &destination {
            // A folder with room for the file has room for the temporary one.
            Destination::File(path) => SpooledTempFile::new_in(SPOOL_BYTES, folder(path)),
            Destination::Stdout => SpooledTempFile::new(SPOOL_BYTES),
        };
        let output = Self {
            destination,
            spool: BufWriter::new(spool),
            replaces: true,
        };
        if let Destination::File(path) = &output.destination {
            check_place(path).map_err(|source| output.failure(source))?;
        }
        Ok(output)
    }

    /// As [`Output::to`], for a result of some input files: it replaces neither these nor the JSON file beside a recording,
    /// and another file by `force` alone.
    ///
    /// # Errors
    /// As [`Output::to`], a path that leads to one of these files, and one of a file that exists.
    pub fn from_inputs<'a>(
        path: Option<&Path>,
        inputs: impl IntoIterator<Item = &'a PathBuf>,
        force: bool,
    ) -> Result<Self, Failure> {
        let mut output = Self::to(path)?;
        for input in inputs {
            let beside = input.with_extension("json");
            if output.is_at(input) || output.is_at(&beside) {
                let path = path.map_or_else(String::new, |path| path.display().to_string());
                let reason = format!("{path} is an input file, or belongs to one");
                return Err(
                    Failure::argument(reason).with_remedy("take another name, or another folder")
                );
            }
        }
        output.replaces = force;
        output.check_free()?;
        Ok(output)
    }

    /// Refuses to replace a file, unless by `force`. Devices and pipes are not replaced.
    fn check_free(&self) -> Result<(), Failure> {
        match &self.destination {
            Destination::File(path) if !self.replaces && path.is_file() => Err(exists(path)),
            _ => Ok(()),
        }
    }

    fn is_at(&self, other: &Path) -> bool {
        matches!(&self.destination, Destination::File(path) if place(path) == place(other))
    }

    /// Refuses two outputs with one destination; `names` are those of their arguments.
    pub fn check_distinct(&self, other: &Self, names: &str) -> Result<(), Failure> {
        let is_same = match &other.destination {
            Destination::Stdout => self.destination == Destination::Stdout,
            Destination::File(path) => self.is_at(path),
        };
        if is_same {
            return Err(Failure::argument(format!(
                "{names} have the same destination"
            )));
        }
        Ok(())
    }

    /// A write error, with the name of the destination instead of a temporary file's.
    pub fn failure(&self, source: io::Error) -> Failure {
        let target = match &self.destination {
            // It came into being during the work.
            Destination::File(path)
                if !self.replaces && source.kind() == io::ErrorKind::AlreadyExists =>
            {
                return exists(path);
            }
            Destination::Stdout => "standard output".into(),
            Destination::File(path) => path.display().to_string(),
        };
        let source = without_path(source);
        Failure::Write { target, source }
    }

    /// Adds a text.
    ///
    /// # Errors
    /// A full disk.
    pub fn with(mut self, text: &str) -> Result<Self, Failure> {
        let written = self.write_all(text.as_bytes());
        written.map_err(|source| self.failure(source))?;
        Ok(self)
    }

    /// Moves the content to its destination.
    ///
    /// # Errors
    /// As [`finish_all`].
    pub fn finish(self) -> Result<(), Failure> {
        finish_all([self])
    }

    /// Writes the content beside the file that it replaces; `None` for a stream.
    fn stage(&mut self) -> io::Result<Option<Staged>> {
        // Seeking writes what the buffer holds.
        self.spool.rewind()?;
        let Destination::File(path) = &self.destination else {
            return Ok(None);
        };
        // A link stays a link: the file behind it is replaced.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.clone());
        let replaced = fs::metadata(&path).ok();
        if !is_replaceable(replaced.as_ref()) {
            return Ok(None);
        }
        let content = temporary_file(folder(&path))?;
        let mut file = content.as_file();
        copy(self.spool.get_mut(), &mut file)?;
        if let Some(metadata) = replaced {
            file.set_permissions(metadata.permissions())?;
        }
        // Otherwise a crash soon after the rename may leave an empty file.
        file.sync_all()?;
        let replaces = self.replaces;
        Ok(Some(Staged {
            path,
            content,
            replaces,
        }))
    }

    /// Writes to what a file cannot replace: standard output, a device, a named pipe.
    fn stream(&mut self) -> io::Result<()> {
        let spool = self.spool.get_mut();
        match &self.destination {
            Destination::Stdout => ignore_broken_pipe(copy(spool, io::stdout().lock())),
            Destination::File(path) => copy(spool, fs::OpenOptions::new().write(true).open(path)?),
        }
    }
}

/// Moves several outputs to their destinations: all files or none, so that they always match.
///
/// Every file is first written beside its destination. They are renamed when all of them are on the disk. If a rename
/// fails, the earlier ones are undone.
///
/// # Errors
/// Whatever the file system refuses. A closed pipe behind standard output is not an error.
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

fn exists(path: &Path) -> Failure {
    let reason = format!("{} exists", path.display());
    Failure::argument(reason).with_remedy("--force replaces it; or name another place")
}

/// Complete content, beside the file that it replaces.
struct Staged {
    path: PathBuf,
    content: NamedTempFile,
    replaces: bool,
}

/// A replaced file, with its former content.
struct Replaced {
    path: PathBuf,
    before: Option<TempPath>,
}

impl Replaced {
    fn undo(self) {
        match self.before {
            Some(before) => {
                if let Err(error) = before.persist(&self.path) {
                    // Better an odd name than a lost file.
                    let _ = error.path.keep();
                }
            }
            None => {
                let _ = fs::remove_file(&self.path);
            }
        }
    }
}

/// Renames all files or none; an error has the place of the file that cannot be renamed.
fn replace_all(files: Vec<Staged>) -> Result<(), (usize, io::Error)> {
    let is_set = files.len() > 1;
    let mut done: Vec<Replaced> = Vec::new();
    for (place, staged) in files.into_iter().enumerate() {
        let Staged {
            path,
            content,
            replaces,
        } = staged;
        // A single rename succeeds or changes nothing.
        let before = if is_set { second_name(&path) } else { Ok(None) };
        let renamed = before.and_then(|before| {
            if replaces {
                content.persist(&path)?;
            } else {
                content.persist_noclobber(&path)?;
            }
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

/// A second name for a file that exists; a copy if the file system has no hard links.
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

/// Prints a line for the user on standard error.
pub fn notify(line: &str) {
    // A closed standard error is no reason to stop.
    let _ = writeln!(io::stderr(), "ugv: {}", visible_line(line));
}

/// Prints notes. What is quiet shows warnings alone.
pub fn notify_all(notes: &[String], quiet: bool) {
    let shown = notes
        .iter()
        .filter(|note| !(quiet && note.starts_with("note: ")));
    shown.for_each(|note| notify(note));
}

/// Writes a text to a file, or to standard output for `-` or nothing.
pub fn write_product(path: Option<&Path>, force: bool, text: &str) -> Result<(), Failure> {
    Output::from_inputs(path, [], force)?.with(text)?.finish()
}

/// Prints data.
pub fn write_stdout(text: &str) -> Result<(), Failure> {
    Output::to(None)?.with(text)?.finish()
}

/// Prints a text for people, with visible escapes for what a terminal obeys. Line ends stay, so a foreign text
/// within a line goes through [`visible_line`] first.
pub fn print(text: &str) -> Result<(), Failure> {
    write_stdout(&visible(text))
}

/// As [`print()`], but on standard error if one of these arguments sends data to standard output.
pub fn print_beside(text: &str, files: &[Option<&Path>]) -> Result<(), Failure> {
    let mut files = files.iter().flatten();
    if files.any(|path| is_stream(path)) {
        text.lines().for_each(notify);
        return Ok(());
    }
    print(text)
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
    if is_replaceable(fs::metadata(path).ok().as_ref()) {
        temporary_file(folder(path))?;
    }
    Ok(())
}

/// Whether a file can replace what exists there, if anything does.
fn is_replaceable(existing: Option<&fs::Metadata>) -> bool {
    existing.is_none_or(fs::Metadata::is_file)
}

/// The canonical path of a file, which need not exist.
fn place(path: &Path) -> PathBuf {
    if let Ok(existing) = fs::canonicalize(path) {
        return existing;
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

/// A temporary file with the permissions of any new file, not the owner's alone.
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

/// The system's message without the path of a temporary file, which the user does not know.
fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    match text.rsplit_once(" at path ") {
        Some((message, _)) => io::Error::new(error.kind(), message),
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
    fn a_file_that_came_into_being_during_the_work_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
        let output = |path: &Path, force| {
            let output = Output::from_inputs(Some(path), [], force).unwrap();
            output.with("late").unwrap()
        };
        let set = [output(&one, false), output(&two, false)];
        let forced = output(&two, true);
        fs::write(&two, "early").unwrap();
        let failure = finish_all(set).unwrap_err().to_string();
        assert!(failure.contains("two exists"), "{failure}");
        assert_eq!(fs::read_to_string(&two).unwrap(), "early");
        // All or none.
        assert!(!one.exists());
        forced.finish().unwrap();
        assert_eq!(fs::read_to_string(&two).unwrap(), "late");
    }

    #[test]
    fn a_set_that_cannot_be_renamed_as_a_whole_is_undone() {
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
        // A file cannot replace a folder.
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
