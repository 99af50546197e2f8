//! The files that a window keeps for the next one.
//!
//! A running window has a film (`NAME.exr`), a note of what it shows (`NAME.json`), a folder with its kept pictures
//! (`NAME.slots`) and a lock (`NAME.lock`), which the system releases when the program ends for any reason. A window that
//! is closed in order leaves film, note and folder under the name `session`, and the next window makes them its own.
//! Files under other names, whose lock nobody holds, were left by a window that did not end in order.

use super::paths::{PREFIX, Paths};
use super::turn::turn;
use crate::app::model::session::Session;
use crate::app::slot_files::Folder;
use crate::files::{check_writable, read, write_text};
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

    /// Whether there is a film.
    pub fn has_film(&self) -> bool {
        self.paths.film.exists()
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
        if !path.exists() {
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
        let is_changed = || {
            let bytes = read(&session.note, "a note of a window", NOTE_LIMIT).ok()?;
            Some(serde_json::from_slice::<Session>(&bytes).ok()?.is_changed)
        };
        if session.film.exists() || session.slots.exists() || is_changed().unwrap_or(false) {
            let free = free(&self.directory)?;
            session.move_slots(&free)?;
            for (from, to) in [(&session.film, &free.film), (&session.note, &free.note)] {
                if from.exists() {
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
    let is_free = |paths: &Paths| paths.is_empty() && !paths.lock.exists();
    Paths::new(directory).find(is_free).ok_or_else(|| io::Error::other("all names are taken"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    fn write(files: &RecoveryFiles, title: &str, film: Option<&str>) {
        files.write_note(&serde_json::from_value(serde_json::json!({ "title": title })).unwrap()).unwrap();
        if let Some(film) = film {
            fs::write(files.film(), film).unwrap();
        }
    }

    fn title(files: &RecoveryFiles) -> String {
        files.note().unwrap().unwrap().title
    }

    #[test]
    fn only_files_of_windows_that_are_gone_are_left() {
        let directory = tempfile::tempdir().unwrap();
        let at = directory.path();
        let [first, second] = [(); 2].map(|()| RecoveryFiles::claim(at).unwrap());
        assert_ne!(first.film(), second.film());
        write(&first, "first", Some("film"));
        write(&second, "second", None);
        assert!(RecoveryFiles::left_in(at).is_empty(), "both windows run");
        drop(first);
        let [left] = RecoveryFiles::left_in(at).try_into().unwrap();
        assert_eq!((title(&left).as_str(), left.has_film()), ("first", true));
        assert!(RecoveryFiles::left_in(at).is_empty(), "who offers it has it");
        drop(left);
        assert_eq!(RecoveryFiles::left_in(at).len(), 1, "and gives it back");
        let [left] = RecoveryFiles::left_in(at).try_into().unwrap();
        left.delete_film();
        left.delete_note();
        drop(left);
        second.delete_note();
        drop(second);
        assert_eq!(names(at), <[&str; 0]>::default(), "nothing stays where nothing was kept");
    }

    #[test]
    fn a_film_without_a_lock_or_a_note_is_found() {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("window-1-1.exr"), "film").unwrap();
        fs::write(directory.path().join("window-2-1.json"), "no note").unwrap();
        fs::write(directory.path().join("other.exr"), "film").unwrap();
        let left = RecoveryFiles::left_in(directory.path());
        assert_eq!(left.len(), 2);
        let told = left.iter().find_map(|files| files.note().err()).unwrap();
        assert!(told.contains("window-2-1.json"), "{told}");
    }

    #[test]
    fn a_session_goes_from_window_to_window() {
        let directory = tempfile::tempdir().unwrap();
        let at = directory.path();
        let first = RecoveryFiles::claim(at).unwrap();
        assert!(!first.take_session().unwrap());
        write(&first, "first", Some("film"));
        first.leave_session().unwrap();
        drop(first);
        assert!(RecoveryFiles::left_in(at).is_empty(), "it ended in order");
        let [second, third] = [(); 2].map(|()| RecoveryFiles::claim(at).unwrap());
        assert!(second.take_session().unwrap());
        assert_eq!((title(&second).as_str(), second.has_film()), ("first", true));
        assert!(!third.take_session().unwrap(), "one window takes it");
        // It is this window's now: if the window is killed, the film is left.
        drop(second);
        assert_eq!(RecoveryFiles::left_in(at).len(), 1);
    }

    #[test]
    fn a_session_that_no_window_has_taken_is_replaced_only_if_nothing_is_lost() {
        let directory = tempfile::tempdir().unwrap();
        let at = directory.path();
        let leave = |title: &str, film| {
            let files = RecoveryFiles::claim(at).unwrap();
            write(&files, title, film);
            files.leave_session().unwrap();
        };
        leave("plain", None);
        leave("long", Some("film"));
        assert!(RecoveryFiles::left_in(at).is_empty(), "the plain one cost nothing");
        leave("newest", None);
        let [left] = RecoveryFiles::left_in(at).try_into().unwrap();
        assert_eq!((title(&left).as_str(), left.has_film()), ("long", true));
        let last = RecoveryFiles::claim(at).unwrap();
        assert!(last.take_session().unwrap() && title(&last) == "newest" && !last.has_film());
    }

    #[test]
    fn a_film_is_set_aside() {
        let directory = tempfile::tempdir().unwrap();
        let [files, other] = [(); 2].map(|()| RecoveryFiles::claim(directory.path()).unwrap());
        write(&files, "mine", Some("film"));
        let aside = files.set_film_aside().unwrap();
        assert!(aside.exists() && !files.has_film());
        assert_ne!(aside, other.film(), "that name is another window's");
        let [left] = RecoveryFiles::left_in(directory.path()).try_into().unwrap();
        assert_eq!(left.film(), aside);
        files.take_film(&left).unwrap();
        assert!(files.has_film() && !left.has_film());
    }

    #[test]
    fn a_directory_that_cannot_be_is_named() {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("file"), "").unwrap();
        let told = RecoveryFiles::claim(&directory.path().join("file/deeper")).unwrap_err();
        assert!(told.contains("file/deeper"), "{told}");
    }

    #[test]
    fn changes_and_kept_pictures_that_no_window_has_taken_are_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let at = directory.path();
        let leave = |note: serde_json::Value, has_slots: bool| {
            let files = RecoveryFiles::claim(at).unwrap();
            files.write_note(&serde_json::from_value(note).unwrap()).unwrap();
            if has_slots {
                fs::create_dir(files.slots().path()).unwrap();
                fs::write(files.slots().film("1"), "a film").unwrap();
            }
            files.leave_session().unwrap();
        };
        leave(serde_json::json!({ "title": "changed", "is_changed": true }), false);
        leave(serde_json::json!({ "title": "keeping" }), true);
        leave(serde_json::json!({ "title": "newest" }), false);
        let mut left = RecoveryFiles::left_in(at);
        left.sort_by_key(title);
        let found: Vec<_> = left.iter().map(|files| (title(files), files.slots().exists())).collect();
        assert_eq!(found, [("changed".to_owned(), false), ("keeping".to_owned(), true)]);
    }
}
