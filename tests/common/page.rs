//! Generated pages of the book: compared with what is written, or written anew with `UGV_BLESS=1`.

use std::path::Path;

/// `page` is the page's path in the repository, `command` the one that writes it.
pub fn assert_current(page: &str, command: &str, expected: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    if std::env::var_os("UGV_BLESS").is_some() {
        std::fs::write(&path, expected).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == expected,
        "{page} is out of date; UGV_BLESS=1 {command} writes it"
    );
}
