//! Where an importer says the FMU's `resources` folder is.

use percent_encoding::percent_decode_str;
use std::path::{Path, PathBuf};

/// Reads the resource location as importers write it: a `file:` URI with one to four
/// slashes, percent-encoded or not, or a plain absolute path; with or without a slash at
/// the end. `None` stands for no location at all.
///
/// # Errors
/// Anything else, in words.
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
    let path = decoded.trim_start_matches('/');
    let path = match path.split_once('/') {
        // file://localhost/path
        Some(("localhost", path)) if decoded.starts_with("//localhost/") => path,
        _ => path,
    };
    if path.contains('\0') {
        return Err(wrong("contains a zero byte"));
    }
    let has_drive = path.as_bytes().get(1) == Some(&b':');
    Ok(Some(PathBuf::from(if cfg!(windows) && has_drive {
        path.to_owned()
    } else {
        format!("/{path}")
    })))
}

fn strip_scheme(location: &str) -> Option<&str> {
    let (scheme, rest) = location.split_at_checked(5)?;
    (scheme.eq_ignore_ascii_case("file:") && rest.starts_with('/')).then_some(rest)
}

/// The text of a file of the folder, `None` if there is no such file.
pub(super) fn read(folder: &Path, name: &str) -> std::io::Result<Option<String>> {
    match std::fs::read_to_string(folder.join(name)) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

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

    #[test]
    fn nothing_is_no_folder_and_rubbish_an_error() {
        assert_eq!(folder("").unwrap(), None);
        for location in [
            "rubbish",
            "http://host/x",
            "file:relative",
            "file:///%FF%FE",
            "%%%",
            "f",
        ] {
            assert!(folder(location).is_err(), "{location}");
        }
    }
}
