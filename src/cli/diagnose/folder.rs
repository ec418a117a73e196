//! The folder that files go to.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A folder; what had to be made for it goes again where nothing was written to it.
pub struct Folder {
    /// What was not there before, the innermost first.
    made: Vec<PathBuf>,
}

impl Folder {
    /// Makes a folder, and those around it.
    ///
    /// # Errors
    /// Whatever the file system refuses.
    pub fn make(path: &Path) -> io::Result<Self> {
        let named = path.ancestors().filter(|path| *path != Path::new(""));
        let missing = named.take_while(|path| !path.exists());
        let made = missing.map(Path::to_owned).collect();
        // Even where the innermost cannot be made, the others go again.
        let folder = Self { made };
        fs::create_dir_all(path)?;
        Ok(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // One that holds something stays.
        self.made.iter().for_each(|folder| {
            let _ = fs::remove_dir(folder);
        });
    }
}
