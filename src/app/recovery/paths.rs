//! The names of the files that a window keeps for the next one.

use crate::app::slot_files::Folder;
use std::fs::{self, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// How all other names begin.
pub const PREFIX: &str = "window-";

/// The most names that are tried.
const NAME_LIMIT: u32 = 1000;

/// On file systems without locks, files that have not changed for this long are nobody's.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// Whether there is something, or may be: its place cannot be looked at.
pub fn may_exist(path: &Path) -> bool {
    !matches!(path.try_exists(), Ok(false))
}

/// Film, note, lock and kept pictures of one name.
#[derive(Debug)]
pub struct Paths {
    pub film: PathBuf,
    pub note: PathBuf,
    pub lock: PathBuf,
    pub slots: Folder,
}

impl Paths {
    /// The paths of this name.
    pub fn of(directory: &Path, name: &str) -> Paths {
        let [film, note, lock] =
            ["exr", "json", "lock"].map(|ending| directory.join(format!("{name}.{ending}")));
        Paths { film, note, lock, slots: Folder::of(directory, name) }
    }

    /// Names that may be free, in order.
    pub fn new(directory: &Path) -> impl Iterator<Item = Paths> {
        let process = std::process::id();
        (1..NAME_LIMIT).map(move |number| Paths::of(directory, &format!("{PREFIX}{process}-{number}")))
    }

    /// Whether there is nothing but perhaps a lock.
    pub fn is_empty(&self) -> bool {
        !may_exist(&self.film) && !may_exist(&self.note) && !self.slots.exists()
    }

    /// When something was written last.
    pub fn changed(&self) -> Option<SystemTime> {
        let modified = |path: &PathBuf| fs::metadata(path).ok()?.modified().ok();
        [&self.film, &self.note].into_iter().filter_map(modified).chain(self.slots.changed()).max()
    }

    /// Renames the folder of kept pictures, if there is one: all of them at once.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn move_slots(&self, to: &Paths) -> io::Result<()> {
        if self.slots.exists() { fs::rename(self.slots.path(), to.slots.path()) } else { Ok(()) }
    }

    /// Whether an attempt to lock the files makes them this window's. Whoever looks for files that were left takes each
    /// lock for a moment, and deletes it if there are no other files.
    pub fn are_ours(&self, locked: &Result<(), TryLockError>, is_new: bool) -> bool {
        match locked {
            Ok(()) => self.lock.exists(),
            Err(TryLockError::WouldBlock) => false,
            Err(TryLockError::Error(_)) => {
                let age = self.changed().and_then(|changed| changed.elapsed().ok());
                is_new || age.is_some_and(|age| age > OLD)
            }
        }
    }
}
