//! Unfinished files and locks that killed programs leave behind.
//!
//! A program that uses such a file holds a lock on it, which the system releases however the program ends. The next run
//! in the directory removes the files whose locks are free.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;
use tempfile::{Builder, NamedTempFile};

pub(super) const PREFIX: &str = ".weekender-";
const PART: &str = ".part";
pub(super) const LOCK: &str = ".lock";

/// Creates a new unfinished file in `directory`, with the usual permissions, and locks it. Dropping it deletes the file.
///
/// # Errors
/// Errors of the file system.
pub(super) fn create_in(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(PART);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let file = builder.tempfile_in(directory)?;
        let is_taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
        // Another run may have removed it before it was locked.
        if !is_taken && file.path().exists() {
            return Ok(file);
        }
    }
}

/// Removes what killed programs left in `directory`; errors are ignored.
pub(super) fn remove_from(directory: &Path) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_ours = name.starts_with(PREFIX) && (name.ends_with(PART) || name.ends_with(LOCK));
        // Hold the lock until the file is gone, so that whoever waits for it notices.
        if is_ours
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_unused_files_are_removed() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        for name in
            [".weekender-a1b2c3.part", ".weekender-g.exr.lock", ".weekender-x", "other.part", "film.exr"]
        {
            fs::write(at(name), "x").unwrap();
        }
        fs::create_dir(at(".weekender-d.part")).unwrap();
        let used = create_in(directory.path()).unwrap();
        remove_from(directory.path());
        assert!(!at(".weekender-a1b2c3.part").exists() && !at(".weekender-g.exr.lock").exists());
        assert!(used.path().exists());
        for name in [".weekender-x", "other.part", "film.exr", ".weekender-d.part"] {
            assert!(at(name).exists(), "{name}");
        }
    }

    #[test]
    fn writers_and_cleaners_do_not_interfere() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path();
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| (0..200).for_each(|_| remove_from(path)));
            }
            for writer in 0..2 {
                scope.spawn(move || {
                    for turn in 0..200 {
                        let file = create_in(path).unwrap();
                        file.persist(path.join(format!("{writer}-{turn}"))).unwrap();
                    }
                });
            }
        });
        assert_eq!(fs::read_dir(path).unwrap().count(), 400);
    }
}
