//! Locks between programs. The system releases them however a program ends.

use super::paths::{ShownPath, identity, resolved};
use same_file::Handle;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The hidden file with this ending beside `path`. Its name follows from that of `path`, so the next run that writes
/// `path` takes over what a killed one left.
pub(super) fn hidden(path: &Path, ending: &str) -> io::Result<PathBuf> {
    let path = resolved(path)?;
    let name = path.file_name().ok_or(ErrorKind::InvalidFilename)?.to_string_lossy();
    // The longest names of most file systems have 255 bytes.
    let rest = name.chars().count().saturating_sub(50);
    let name: String = name.chars().skip(rest).collect();
    Ok(path.with_file_name(format!(".weekender-{name}{ending}")))
}

/// Time between two tries.
const PAUSE: Duration = Duration::from_millis(5);

/// Whether the file is locked or, on Windows, a program has opened it without sharing it, or it is about to be deleted.
pub(super) fn is_busy(error: &io::Error) -> bool {
    const SHARING_VIOLATION: i32 = 32;
    let is_of_windows =
        error.kind() == ErrorKind::PermissionDenied || error.raw_os_error() == Some(SHARING_VIOLATION);
    error.kind() == ErrorKind::WouldBlock || cfg!(windows) && is_of_windows
}

/// Tries until the file is no longer busy, or for as long as `patience`.
pub(super) fn patiently<T>(patience: Duration, mut attempt: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    let begin = Instant::now();
    loop {
        match attempt() {
            Err(error) if is_busy(&error) && begin.elapsed() < patience => std::thread::sleep(PAUSE),
            outcome => return outcome,
        }
    }
}

/// Another run is writing the file.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error(
    "{} is locked: another run is writing it; wait until that run has ended, or name another file",
    path.shown()
)]
pub struct LockedError {
    pub path: PathBuf,
}

/// The exclusive right to write a file. The lock is a hidden file beside it, because the file itself is replaced
/// whenever it is written.
#[derive(Debug)]
pub struct FileLock(
    /// `None` if there is nothing to lock: see [`FileLock::take`].
    Option<(File, PathBuf)>,
);

impl FileLock {
    /// How long a run waits for another that is about to end.
    pub const PATIENCE: Duration = Duration::from_secs(1);

    /// Locks `path` until the result is dropped, waiting for as long as `patience`. Devices and standard output need no
    /// lock; where the system has no locks, runs are not kept apart.
    ///
    /// # Errors
    /// [`LockedError`] if another run has locked it.
    pub fn take(path: &Path, patience: Duration) -> Result<FileLock, LockedError> {
        if identity(path).is_none() {
            return Ok(FileLock(None));
        }
        let lock = || -> io::Result<(File, PathBuf)> {
            let path = hidden(path, ".lock")?;
            Ok((lock_path(&path, patience)?, path))
        };
        match lock() {
            Ok(held) => Ok(FileLock(Some(held))),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Err(LockedError { path: path.to_owned() }),
            Err(error) => {
                log::warn!("{} cannot be locked: {error}", path.display());
                Ok(FileLock(None))
            }
        }
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        if let Some((_, path)) = &self.0 {
            // It is still locked, so no other run has it. If it cannot be removed, the next run reuses it.
            let _ = fs::remove_file(path);
        }
    }
}

/// Locks the file at `path`, creating it if necessary, until the result is dropped.
///
/// # Errors
/// [`ErrorKind::WouldBlock`] if another program has held the lock for all of `patience`; other errors if the file cannot
/// be created or locked.
pub fn lock_path(path: &Path, patience: Duration) -> io::Result<File> {
    patiently(patience, || {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        file.try_lock()?;
        // Its last owner may have just removed it.
        if is_at(&file, path)? { Ok(file) } else { Err(ErrorKind::WouldBlock.into()) }
    })
}

fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    let held = Handle::from_file(file.try_clone()?)?;
    Ok(Handle::from_path(path).is_ok_and(|there| there == held))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lock_covers_all_names_and_survives_replacement() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let take = |name: &str| FileLock::take(&at(name), Duration::ZERO);
        let lock = take("g.exr").unwrap();
        let message = take("./g.exr").unwrap_err().to_string();
        assert!(message.contains("g.exr is locked") && message.contains("name another file"), "{message}");
        crate::system::files::write_text(&at("g.exr"), "a film").unwrap();
        assert!(take("g.exr").is_err());
        drop(take("h.exr").unwrap());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("g.exr", at("link.exr")).unwrap();
            assert!(take("link.exr").is_err());
            let null = || FileLock::take(Path::new("/dev/null"), Duration::ZERO);
            assert!(null().is_ok() && null().is_ok());
        }
        drop(lock);
        assert!(take("g.exr").is_ok());
        // A killed run leaves its lock file.
        fs::write(at(".weekender-g.exr.lock"), "").unwrap();
        assert!(take("g.exr").is_ok());
        assert!(!at(".weekender-g.exr.lock").exists());
    }

    #[test]
    fn only_one_of_many_gets_the_lock() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("g.exr");
        let (inside, turns) = (std::sync::atomic::AtomicU32::new(0), std::sync::atomic::Ordering::SeqCst);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let lock = FileLock::take(&path, Duration::from_secs(60)).unwrap();
                        assert_eq!(inside.fetch_add(1, turns), 0);
                        inside.fetch_sub(1, turns);
                        drop(lock);
                    }
                });
            }
        });
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}
