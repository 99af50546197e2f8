//! Unfinished files, and how to recognize those that a killed program left behind.
//!
//! The writer of an unfinished file holds a lock on it, which the system releases when the program ends for any
//! reason. A file with such a name and a free lock therefore has no owner, and the next run in its directory removes
//! it. On file systems without locks, the file's age decides.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};
use tempfile::{Builder, NamedTempFile};

const PREFIX: &str = ".weekender-";
const SUFFIX: &str = ".part";

/// On file systems without locks, a file that has not changed for this long has no owner.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// How many times a new file is created again if another run's cleanup removed it before it was locked.
const ATTEMPTS: usize = 8;

/// Creates a new unfinished file in `directory` and locks it. Dropping it deletes the file.
///
/// # Errors
/// Errors of the file system.
pub(super) fn create_in(directory: &Path, builder: &mut Builder<'_, '_>) -> io::Result<NamedTempFile> {
    builder.prefix(PREFIX).suffix(SUFFIX);
    for _ in 0..ATTEMPTS {
        let file = builder.tempfile_in(directory)?;
        match file.as_file().try_lock() {
            // Another run's cleanup holds the lock and removes the file.
            Err(TryLockError::WouldBlock) => {}
            // A file system without locks works too: the file's age decides.
            Ok(()) | Err(TryLockError::Error(_)) if fs::symlink_metadata(file.path()).is_ok() => {
                return Ok(file);
            }
            _ => {}
        }
    }
    Err(io::Error::other("new files disappear at once"))
}

/// Removes the unfinished files that killed programs left in `directory`. Files that cannot be removed stay.
pub(super) fn remove_from(directory: &Path) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_ours = name.starts_with(PREFIX) && name.ends_with(SUFFIX);
        if is_ours && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            remove_ownerless(&entry.path());
        }
    }
}

/// Removes a file that nobody is writing.
fn remove_ownerless(path: &Path) {
    // The lock is held until the file is gone, so whoever waits for the lock sees that.
    let Ok(file) = File::open(path) else { return };
    let is_ownerless = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::WouldBlock) => false,
        Err(TryLockError::Error(_)) => is_old(file.metadata().and_then(|found| found.modified()).ok()),
    };
    if is_ownerless {
        // Another run may already have removed it.
        let _ = fs::remove_file(path);
    }
}

/// Whether a file that was changed then has no owner on a file system without locks.
fn is_old(changed: Option<SystemTime>) -> bool {
    changed.and_then(|changed| changed.elapsed().ok()).is_some_and(|age| age > OLD)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_old_after_a_day_and_not_if_its_age_is_unknown() {
        let now = SystemTime::now();
        assert!(is_old(Some(now - OLD - Duration::from_secs(1))));
        let hour = Duration::from_secs(3600);
        for young in [None, Some(now), Some(now - OLD + hour), Some(now + hour)] {
            assert!(!is_old(young), "{young:?}");
        }
    }

    #[test]
    fn only_what_nobody_writes_is_removed() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        for name in [".weekender-a1b2c3.part", ".weekender-x", "other.part", "film.exr"] {
            fs::write(at(name), "x").unwrap();
        }
        fs::create_dir(at(".weekender-d.part")).unwrap();
        let living = create_in(directory.path(), &mut Builder::new()).unwrap();
        remove_from(directory.path());
        assert!(!at(".weekender-a1b2c3.part").exists(), "left behind by a killed run");
        assert!(living.path().exists());
        for name in [".weekender-x", "other.part", "film.exr", ".weekender-d.part"] {
            assert!(at(name).exists(), "{name}");
        }
        let path = living.path().to_owned();
        drop(living);
        assert!(!path.exists());
    }

    #[test]
    fn many_writers_and_cleaners_do_not_disturb_each_other() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path();
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| (0..200).for_each(|_| remove_from(path)));
            }
            for writer in 0..2 {
                scope.spawn(move || {
                    for turn in 0..200 {
                        let file = create_in(path, &mut Builder::new()).unwrap();
                        file.persist(path.join(format!("{writer}-{turn}"))).unwrap();
                    }
                });
            }
        });
        assert_eq!(fs::read_dir(path).unwrap().count(), 400);
    }
}
