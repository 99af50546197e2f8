//! The files that a window keeps for the next one.
//!
//! A running window has a film (`NAME.exr`), a note of what it shows (`NAME.json`), a folder with its kept pictures
//! (`NAME.slots`) and a lock (`NAME.lock`), which the system releases when the program ends for any reason. A window that
//! is closed in order leaves film, note and folder under the name `session`, and the next window makes them its own.
//! Files under other names, whose lock nobody holds, were left by a window that did not end in order.

use super::paths::{PREFIX, Paths, may_exist};
use super::turn::turn;
use crate::app::model::session::Session;
use crate::app::slot_files::Folder;
use crate::system::files::{check_writable, read, write_text};
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The name of the files that a window leaves when it is closed in order.
const SESSION: &str = "session";

/// The longest note that is read, in bytes.
const NOTE_LIMIT: u64 = 256 << 20;

/// Files that belong to this window for as long as this exists.
#[derive(Debug)]
pub struct RecoveryFiles {
    directory: PathBuf,
    paths: Paths,
    _lock: File,
}

impl Drop for RecoveryFiles {
    fn drop(&mut self) {
        if self.paths.is_empty() {
            // If it cannot be removed, it is an empty file that the next window removes.
            let _ = fs::remove_file(&self.paths.lock);
            let _ = fs::remove_dir(self.paths.slots.path());
        }
    }
}

impl RecoveryFiles {
    /// Files of a new name in `directory`, which is created if necessary.
    ///
    /// # Errors
    /// Why nothing can be kept there.
    pub fn claim(directory: &Path) -> Result<RecoveryFiles, String> {
        let failed = |error: io::Error| format!("cannot write to {}: {error}", directory.display());
        fs::create_dir_all(directory).map_err(failed)?;
        for paths in Paths::new(directory) {
            if !paths.is_empty() {
                continue;
            }
            match OpenOptions::new().write(true).create_new(true).open(&paths.lock) {
                Ok(file) if paths.are_ours(&file.try_lock(), true) => {
                    // This also removes the unfinished files of killed windows.
                    check_writable(&paths.film).map_err(|error| error.to_string())?;
                    return Ok(RecoveryFiles { directory: directory.to_owned(), paths, _lock: file });
                }
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(failed(error)),
            }
        }
        Err(format!("cannot write to {}: all names are taken", directory.display()))
    }

    /// The files in `directory` that windows left without ending in order, newest first.
    pub fn left_in(directory: &Path) -> Vec<RecoveryFiles> {
        let entries = fs::read_dir(directory).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries
            .filter_map(|entry| {
                let path = entry.path();
                let is_kept = path
                    .extension()
                    .is_some_and(|ending| ["exr", "json", "slots", "lock"].iter().any(|e| ending == *e));
                path.file_stem()?
                    .to_str()
                    .filter(|stem| is_kept && stem.starts_with(PREFIX))
                    .map(str::to_owned)
            })
            .collect();
        names.sort();
        names.dedup();
        let mut left: Vec<RecoveryFiles> =
            names.iter().filter_map(|name| RecoveryFiles::take_over(directory, name)).collect();
        left.sort_by_key(|files| std::cmp::Reverse(files.changed()));
        left
    }

    /// The files of this name, unless a running window has it or it is empty.
    fn take_over(directory: &Path, name: &str) -> Option<RecoveryFiles> {
        let paths = Paths::of(directory, name);
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&paths.lock).ok()?;
        if !paths.are_ours(&file.try_lock(), false) {
            return None;
        }
        // If there is nothing else, dropping it removes the lock.
        Some(RecoveryFiles { directory: directory.to_owned(), paths, _lock: file })
            .filter(|files| !files.paths.is_empty())
    }

    /// The path of the film, whether or not it exists.
    pub fn film(&self) -> &Path {
        &self.paths.film
    }

    /// Whether there is a film, or may be: its place cannot be looked at.
    pub fn has_film(&self) -> bool {
        may_exist(&self.paths.film)
    }

    /// The folder with the kept pictures, whether or not it exists.
    pub fn slots(&self) -> &Folder {
        &self.paths.slots
    }

    /// Makes the kept pictures of other files this window's, which must have none.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn take_slots(&self, other: &RecoveryFiles) -> io::Result<()> {
        other.paths.move_slots(&self.paths)
    }

    /// Moves the kept pictures where a later window offers them. Returns the new name of their folder.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn set_slots_aside(&self) -> io::Result<PathBuf> {
        let free = free(&self.directory)?;
        self.paths.move_slots(&free)?;
        Ok(free.slots.path().to_owned())
    }

    /// Moves a kept film that cannot be read where a later window offers it. Returns its new name.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn set_slot_aside(&self, id: &str) -> io::Result<PathBuf> {
        let free = free(&self.directory)?;
        self.paths.slots.move_film(id, &free.film)?;
        Ok(free.film)
    }

    /// When something was written last.
    pub fn changed(&self) -> Option<SystemTime> {
        self.paths.changed()
    }

    /// Writes the note.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn write_note(&self, session: &Session) -> Result<(), String> {
        write_note(&self.paths.note, session)
    }

    /// A function that writes the note, for another thread.
    pub fn note_writer(&self) -> impl FnOnce(&Session) -> Result<(), String> + Send + 'static {
        let path = self.paths.note.clone();
        move |session| write_note(&path, session)
    }

    /// Reads the note, if there is one.
    ///
    /// # Errors
    /// What is wrong with it, with the name of the file.
    pub fn note(&self) -> Result<Option<Session>, String> {
        let path = &self.paths.note;
        if !may_exist(path) {
            return Ok(None);
        }
        let bytes = read(path, "a note of a window", NOTE_LIMIT).map_err(|error| error.to_string())?;
        let damaged = |error| format!("{} cannot be understood: {error}", path.display());
        serde_json::from_slice(&bytes).map(Some).map_err(damaged)
    }

    /// Deletes the film.
    pub fn delete_film(&self) {
        // If it cannot be deleted, it is offered again.
        let _ = fs::remove_file(&self.paths.film);
    }

    /// Deletes the note.
    pub fn delete_note(&self) {
        let _ = fs::remove_file(&self.paths.note);
    }

    /// Makes the film of other files this window's.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn take_film(&self, other: &RecoveryFiles) -> io::Result<()> {
        fs::rename(&other.paths.film, &self.paths.film)
    }

    /// Leaves the film under another name, so that a later window offers it. Returns that name.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn set_film_aside(&self) -> io::Result<PathBuf> {
        let free = free(&self.directory)?;
        fs::rename(&self.paths.film, &free.film)?;
        Ok(free.film)
    }

    /// Makes what the last window left in order this window's. Returns whether there was a note.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn take_session(&self) -> io::Result<bool> {
        let _turn = turn(&self.directory);
        let session = Paths::of(&self.directory, SESSION);
        session.move_slots(&self.paths)?;
        match fs::rename(&session.note, &self.paths.note) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(error),
        }
        match fs::rename(&session.film, &self.paths.film) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Ok(true),
        }
    }

    /// Leaves film, note and kept pictures to the next window. What another window has left before, and no window has taken since, is
    /// kept under another name if something would be lost with it.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn leave_session(&self) -> io::Result<()> {
        let _turn = turn(&self.directory);
        let session = Paths::of(&self.directory, SESSION);
        // What cannot be read may be worth keeping.
        let is_changed = || match read(&session.note, "a note of a window", NOTE_LIMIT) {
            Ok(bytes) => !serde_json::from_slice::<Session>(&bytes).is_ok_and(|note| !note.is_changed),
            Err(_) => may_exist(&session.note),
        };
        if may_exist(&session.film) || session.slots.exists() || is_changed() {
            let free = free(&self.directory)?;
            session.move_slots(&free)?;
            for (from, to) in [(&session.film, &free.film), (&session.note, &free.note)] {
                if may_exist(from) {
                    fs::rename(from, to)?;
                }
            }
        }
        self.paths.move_slots(&session)?;
        if self.has_film() {
            fs::rename(&self.paths.film, &session.film)?;
        }
        fs::rename(&self.paths.note, &session.note)
    }
}

fn write_note(path: &Path, session: &Session) -> Result<(), String> {
    let text = serde_json::to_string_pretty(session).map_err(|error| error.to_string())?;
    write_text(path, &text).map_err(|error| error.to_string())
}

/// A name that nobody uses.
fn free(directory: &Path) -> io::Result<Paths> {
    let is_free = |paths: &Paths| paths.is_empty() && !may_exist(&paths.lock);
    Paths::new(directory).find(is_free).ok_or_else(|| io::Error::other("all names are taken"))
}

#[cfg(test)]
mod tests;
