//! The location of the FMU's `resources` folder.

use crate::json::read_file;
use percent_encoding::percent_decode_str;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Reads the resource location as importers write it: a `file:` URI with one to four
/// slashes, percent-encoded or not, or a plain absolute path; with or without a slash at
/// the end; on Windows also of a server. `None` for an empty location.
///
/// # Errors
/// The reason why anything else is refused.
pub(super) fn folder(location: &str) -> Result<Option<PathBuf>, String> {
    let location = location.trim();
    if location.is_empty() {
        return Ok(None);
    }
    let wrong = |why: &str| format!("the resource location \"{location}\" {why}");
    let Some(rest) = strip_scheme(location) else {
        if Path::new(location).is_absolute() {
            return Ok(Some(PathBuf::from(location)));
        }
        return Err(wrong("is neither a file: URI nor an absolute path"));
    };
    let decoded = percent_decode_str(rest)
        .decode_utf8()
        .map_err(|_| wrong("is not UTF-8"))?;
    if decoded.contains('\0') {
        return Err(wrong("contains a zero byte"));
    }
    let path = path(&decoded, cfg!(windows)).map_err(wrong)?;
    Ok(Some(PathBuf::from(path)))
}

/// The path that the rest of a `file:` URI stands for, on Windows or elsewhere.
fn path(decoded: &str, windows: bool) -> Result<String, &'static str> {
    let rest = decoded.trim_start_matches('/');
    let slashes = decoded.len() - rest.len();
    let host = match slashes {
        // file://host/path
        2 => rest.split('/').next().unwrap_or_default(),
        _ => "",
    };
    let is_here = host.eq_ignore_ascii_case("localhost");
    let path = if is_here {
        rest[host.len()..].trim_start_matches('/')
    } else {
        rest
    };
    if windows && path.as_bytes().get(1) == Some(&b':') {
        return Ok(path.to_owned());
    }
    let is_remote = !is_here && !host.is_empty();
    // Four slashes: a Windows path of a server behind "file://".
    if windows && (is_remote || (slashes >= 4 && !path.is_empty())) {
        return Ok(format!(r"\\{}", path.replace('/', r"\")));
    }
    if is_remote {
        return Err("is on a server, from which nothing can be read here");
    }
    Ok(format!("/{path}"))
}

fn strip_scheme(location: &str) -> Option<&str> {
    let (scheme, rest) = location.split_at_checked(5)?;
    (scheme.eq_ignore_ascii_case("file:") && rest.starts_with('/')).then_some(rest)
}

/// The text of a file of the folder, `None` if there is no such file.
///
/// # Errors
/// A file that is not regular (a pipe would block, a device need not end), or that [`read_file`] refuses.
pub(super) fn read(folder: &Path, name: &str) -> io::Result<Option<String>> {
    let path = folder.join(name);
    // Opening a pipe blocks already.
    match fs::metadata(&path) {
        Ok(metadata) if metadata.is_file() => read_file(&path).map(Some),
        Ok(_) => Err(io::Error::other("it is no regular file")),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_those_of_the_system() {
        const NOWHERE: Option<&str> = None;
        for (decoded, windows, elsewhere) in [
            ("/tmp/a b", Some("/tmp/a b"), Some("/tmp/a b")),
            ("///tmp/a", Some("/tmp/a"), Some("/tmp/a")),
            ("////tmp/a", Some(r"\\tmp\a"), Some("/tmp/a")),
            ("//localhost/tmp/a", Some("/tmp/a"), Some("/tmp/a")),
            ("//LOCALHOST/tmp/a", Some("/tmp/a"), Some("/tmp/a")),
            ("//localhost", Some("/"), Some("/")),
            ("///", Some("/"), Some("/")),
            ("///C:/a b/", Some("C:/a b/"), Some("/C:/a b/")),
            ("//localhost/C:/a", Some("C:/a"), Some("/C:/a")),
            ("/C:/a", Some("C:/a"), Some("/C:/a")),
            ("//C:/a", Some("C:/a"), NOWHERE),
            ("////C:/a", Some("C:/a"), Some("/C:/a")),
            ("//server/share/a b/", Some(r"\\server\share\a b\"), NOWHERE),
            (
                "////server/share/a",
                Some(r"\\server\share\a"),
                Some("/server/share/a"),
            ),
        ] {
            assert_eq!(path(decoded, true).ok().as_deref(), windows, "{decoded}");
            assert_eq!(path(decoded, false).ok().as_deref(), elsewhere, "{decoded}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn every_importers_way_of_writing_is_understood() {
        let expected = Some(PathBuf::from("/tmp/a b/r\u{e9}sources"));
        for location in [
            "file:///tmp/a%20b/r%C3%A9sources",
            "file:////tmp/a%20b/r%C3%A9sources",
            "file:/tmp/a b/r\u{e9}sources",
            "FILE:///tmp/a b/r\u{e9}sources/",
            "file://localhost/tmp/a%20b/r%C3%A9sources",
            "/tmp/a b/r\u{e9}sources",
        ] {
            assert_eq!(folder(location).unwrap(), expected, "{location}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn nothing_is_no_folder_and_rubbish_an_error() {
        assert_eq!(folder("").unwrap(), None);
        for location in [
            "rubbish",
            "http://host/x",
            "file://host/x",
            "file:relative",
            "file:///%FF%FE",
            "%%%",
            "f",
        ] {
            assert!(folder(location).is_err(), "{location}");
        }
    }
    #[test]
    fn regular_files_of_bounded_size_are_read_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("small"), "{}").unwrap();
        fs::create_dir(folder.join("folder")).unwrap();
        for (name, size) in [("limit", 64 << 20), ("large", (64 << 20) + 1)] {
            let file = fs::File::create(folder.join(name)).unwrap();
            file.set_len(size).unwrap();
        }
        assert_eq!(read(folder, "small").unwrap().as_deref(), Some("{}"));
        assert_eq!(read(folder, "absent").unwrap(), None);
        assert!(read(folder, "limit").is_ok());
        for (name, why) in [("folder", "no regular file"), ("large", "larger than")] {
            let error = read(folder, name).unwrap_err().to_string();
            assert!(error.contains(why), "{name}: {error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_unopened() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        // Blocks until somebody opens the pipe: who does gets the file's text.
        std::thread::spawn(move || fs::write(pipe, "{}"));
        symlink("/dev/null", folder.path().join("device")).unwrap();
        for name in ["pipe", "device"] {
            let error = read(folder.path(), name).unwrap_err().to_string();
            assert!(error.contains("no regular file"), "{name}: {error}");
        }
        fs::write(folder.path().join("small"), "{}").unwrap();
        symlink("small", folder.path().join("link")).unwrap();
        let linked = read(folder.path(), "link").unwrap();
        assert_eq!(linked.as_deref(), Some("{}"));
    }
}
