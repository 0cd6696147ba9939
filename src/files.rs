//! Files that are replaced whole, and folders that one process at a time writes to.

use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::Error;

/// An error that names a file which could not be written.
pub fn unwritten(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::File { path: path.display().to_string(), message: format!("could not write: {error}") }
}

/// Where the new content is written before it replaces the old.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.new", std::process::id()))
}

/// Makes the folder that a file goes into, and sees that the file can be written there. Called before anything is computed.
///
/// # Errors
/// [`Error::File`] naming the file or the folder.
pub fn prepare(path: &Path) -> Result<(), Error> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| unwritten(folder, error))?;
    }
    if path.is_dir() {
        return Err(unwritten(path, "it is a folder"));
    }
    let beside = beside(path);
    File::create(&beside).and_then(|_| std::fs::remove_file(&beside)).map_err(|error| unwritten(path, error))
}

/// Puts a file in place at once: whoever reads it finds the old content or the new, also after a crash. A file that cannot be
/// written leaves the old one as it was.
///
/// # Errors
/// [`Error::File`] naming the file.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), Error> {
    let beside = beside(path);
    let write = || {
        let mut file = File::create(&beside)?;
        file.write_all(content)?;
        // On the disk before the old file goes: a rename may overtake the data.
        file.sync_all()?;
        drop(file);
        std::fs::rename(&beside, path)
    };
    write().map_err(|error| {
        // What failed is told already; that the rest of it stays is no second error.
        let _ = std::fs::remove_file(&beside);
        unwritten(path, error)
    })
}

/// A folder that this process alone writes to. The operating system gives the lock back when the process ends, however it ends.
pub struct OutputFolder {
    path: PathBuf,
    /// Locked as long as it is open.
    _lock: File,
}

impl OutputFolder {
    /// Makes the folder if it is missing, sees that files can be written there, and locks it. Called before anything is computed.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be written to, or where another process does.
    pub fn open(path: &Path) -> Result<Self, Error> {
        std::fs::create_dir_all(path).map_err(|error| unwritten(path, error))?;
        let name = path.join(".lock");
        let lock = File::options().create(true).append(true).open(&name).map_err(|error| unwritten(&name, error))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(Error::File {
                    path: path.display().to_string(),
                    message: "another process is writing to this folder; wait for it, or choose another with --output"
                        .into(),
                });
            }
            // Some network file systems have no locks; they are used as before.
            Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(unwritten(&name, error)),
        }
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        replace(&path, b"old").unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        // A folder cannot be replaced by a file.
        let taken = folder.path().join("taken");
        std::fs::create_dir(&taken).unwrap();
        let message = replace(&taken, b"new").unwrap_err().to_string();
        assert!(message.contains("taken: could not write"), "{message}");
        assert!(prepare(&taken).is_err() && prepare(&path.join("below")).is_err());
        prepare(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names.len(), 2, "nothing is left beside: {names:?}");
    }

    #[test]
    fn one_writes_to_a_folder_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b");
        let first = OutputFolder::open(&path).unwrap();
        let message = OutputFolder::open(&path).err().unwrap().to_string();
        assert!(message.contains("another process is writing"), "{message}");
        drop(first);
        assert_eq!(OutputFolder::open(&path).unwrap().path(), path);
    }
}
