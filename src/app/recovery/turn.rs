//! Windows take and leave a session one after the other.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;
use std::time::{Duration, Instant};

/// How long a window waits for another one that renames files, which takes a moment.
const PATIENCE: Duration = Duration::from_secs(2);

/// Waits until no other window takes or leaves a session, until the result is dropped.
pub fn turn(directory: &Path) -> Option<File> {
    turn_within(directory, PATIENCE)
}

fn turn_within(directory: &Path, patience: Duration) -> Option<File> {
    let file = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(false)
        .open(directory.join("session.lock"))
        .ok()?;
    let begin = Instant::now();
    while let Err(TryLockError::WouldBlock) = file.try_lock() {
        if begin.elapsed() > patience {
            return None;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Some(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_window_at_a_time_has_its_turn_and_the_others_do_not_wait_for_ever() {
        let directory = tempfile::tempdir().unwrap();
        let first = turn_within(directory.path(), Duration::ZERO).unwrap();
        assert!(turn_within(directory.path(), Duration::ZERO).is_none());
        drop(first);
        assert!(turn_within(directory.path(), Duration::ZERO).is_some());
    }
}
