//! Windows take and leave a session one after the other.

use crate::system::files::lock_path;
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
