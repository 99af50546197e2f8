//! Locks that programs wait for, but not for ever.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;
use std::time::{Duration, Instant};

/// Pause between two tries.
const PAUSE: Duration = Duration::from_millis(5);

/// Locks `file` until the result is dropped. `None` if another program has held the lock for all of `patience`, or if
/// such files cannot be locked here.
pub fn lock_within(file: File, patience: Duration) -> Option<File> {
    let begin = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Some(file),
            Err(TryLockError::WouldBlock) if begin.elapsed() < patience => std::thread::sleep(PAUSE),
            Err(_) => return None,
        }
    }
}

/// Locks the file at `path`, which stands for something else and is created if it is missing: see [`lock_within`].
pub fn lock_path(path: &Path, patience: Duration) -> Option<File> {
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(path).ok()?;
    lock_within(file, patience)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_has_the_lock_at_a_time_and_the_others_do_not_wait_for_ever() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.lock");
        let lock = || lock_path(&path, Duration::ZERO);
        let first = lock().unwrap();
        assert!(lock().is_none());
        drop(first);
        assert!(lock().is_some());
        assert!(lock_path(&directory.path().join("missing/x.lock"), Duration::ZERO).is_none());
    }

    #[test]
    fn a_lock_that_is_released_in_time_is_had() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.lock");
        let first = lock_path(&path, Duration::ZERO).unwrap();
        let waiting = std::thread::spawn(move || lock_path(&path, Duration::from_secs(60)).is_some());
        drop(first);
        assert!(waiting.join().unwrap());
    }
}
