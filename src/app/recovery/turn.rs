//! Windows take and leave a session one after the other.

use crate::files::lock_path;
use std::fs::File;
use std::path::Path;
use std::time::Duration;

/// How long a window waits for another one that renames files, which takes a moment.
const PATIENCE: Duration = Duration::from_secs(2);

/// Waits until no other window takes or leaves a session, until the result is dropped.
pub fn turn(directory: &Path) -> Option<File> {
    turn_within(directory, PATIENCE)
}

fn turn_within(directory: &Path, patience: Duration) -> Option<File> {
    lock_path(&directory.join("session.lock"), patience).ok()
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
