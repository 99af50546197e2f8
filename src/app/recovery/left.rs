//! What a window left that ended without being closed.

use super::files::RecoveryFiles;
use crate::app::model::session::Session;
use crate::app::slot_files::Entry;
use crate::film::{checkpoint, key};
use crate::progressive::describe::counted;
use crate::stages::Stage;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A part of what was left that is opened or deleted by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A film, with the picture that it belongs to.
    Film,
    /// A changed picture without samples.
    Picture,
    /// The kept pictures.
    Slots,
}

/// A part in words.
pub struct Row {
    /// Which part.
    pub part: Part,
    /// The name of the picture.
    pub title: String,
    /// Samples, size and age.
    pub about: String,
    /// Why it cannot be opened, if so.
    pub fault: Option<String>,
}

/// What a film file says about itself.
struct FilmWords {
    title: String,
    samples: u64,
    size: [u32; 2],
}

impl FilmWords {
    fn read(path: &Path) -> Result<FilmWords, String> {
        let head = checkpoint::read_head(path).map_err(|error| error.to_string())?;
        let stage = head.description.get(key::STAGE).and_then(|id| Stage::find(id).ok());
        let scene = || head.description.get(key::SCENE).unwrap_or("A film").to_owned();
        Ok(FilmWords {
            title: stage.map_or_else(scene, |stage| format!("{} {}", stage.section, stage.title)),
            samples: head.samples.count(),
            size: [head.width, head.height],
        })
    }
}

/// Files that were left, and what they hold.
pub struct Left {
    /// The files, which no other window takes meanwhile.
    pub files: RecoveryFiles,
    session: Option<Result<Session, String>>,
    film: Option<Result<FilmWords, String>>,
    /// The kept pictures, or why they cannot be listed.
    kept: Result<Vec<Entry>, String>,
    changed: Option<SystemTime>,
}

impl Left {
    /// What is in `directory`, newest first. What nothing would be lost with is deleted.
    pub fn all_in(directory: &Path) -> Vec<Left> {
        let mut all: Vec<Left> = RecoveryFiles::left_in(directory).into_iter().map(Left::of).collect();
        all.iter().for_each(Left::tidy);
        all.retain(|left| left.rows().next().is_some());
        all
    }

    fn of(files: RecoveryFiles) -> Left {
        Left {
            session: files.note().transpose(),
            film: files.has_film().then(|| FilmWords::read(files.film())),
            kept: listed(&files),
            changed: files.changed(),
            files,
        }
    }

    /// Deletes a note that says nothing more than the film, or that names an unchanged picture, and a list of kept pictures
    /// that are not there.
    fn tidy(&self) {
        if self.has_no_kept() {
            self.files.slots().clear();
        }
        if self.rows().next().is_none() {
            self.files.delete_note();
        }
    }

    /// The note that belongs to this part.
    pub fn session(&self, part: Part) -> Option<&Session> {
        let session = self.session.as_ref()?.as_ref().ok()?;
        match part {
            Part::Film => session.has_film.then_some(session),
            Part::Picture => Some(session),
            Part::Slots => None,
        }
    }

    /// The kept pictures, as far as they can be listed.
    pub fn kept(&self) -> &[Entry] {
        self.kept.as_deref().unwrap_or_default()
    }

    /// Whether it is known that there are no kept pictures.
    fn has_no_kept(&self) -> bool {
        self.kept.as_ref().is_ok_and(Vec::is_empty)
    }

    /// Looks anew which kept pictures there are.
    pub fn count_kept(&mut self) {
        self.kept = listed(&self.files);
        if self.has_no_kept() {
            self.settle(Part::Slots);
        }
    }

    /// The file of a part.
    pub fn path(&self, part: Part) -> PathBuf {
        match part {
            Part::Film => self.files.film().to_owned(),
            Part::Picture => self.files.film().with_extension("json"),
            Part::Slots => self.files.slots().path().to_owned(),
        }
    }

    /// Notes why a part cannot be opened.
    pub fn mark(&mut self, part: Part, fault: String) {
        match part {
            Part::Film => self.film = Some(Err(fault)),
            Part::Picture => self.session = Some(Err(fault)),
            // Each is read by itself.
            Part::Slots => {}
        }
    }

    /// Notes that the film is not of the noted picture, so that each is offered by itself.
    pub fn separate(&mut self) {
        if let Some(Ok(session)) = &mut self.session
            && session.has_film
        {
            session.has_film = false;
            // If it cannot be written, the two are told apart again when they are opened.
            let _ = self.files.write_note(session);
        }
    }

    /// Forgets a part that was opened or deleted, and deletes what is left of its files.
    pub fn settle(&mut self, part: Part) {
        if part == Part::Film {
            self.files.delete_film();
            self.film = None;
        }
        if part == Part::Slots {
            self.kept = self.files.slots().delete_all().map(|()| Vec::new());
        }
        if part == Part::Picture || (part == Part::Film && self.session(Part::Film).is_some()) {
            self.files.delete_note();
            self.session = None;
        }
        self.tidy();
    }

    /// The parts in words.
    pub fn rows(&self) -> impl Iterator<Item = Row> {
        let age = self.changed.and_then(|changed| changed.elapsed().ok()).map(ago).unwrap_or_default();
        let row = |part, title: &str, about: &str, fault| Row {
            part,
            title: title.to_owned(),
            about: if about.is_empty() { age.clone() } else { format!("{about}, {age}") },
            fault,
        };
        let session = self.session.as_ref();
        let known = self.session(Part::Film).map(|session| session.title.as_str());
        let film = self.film.as_ref().map(|film| match film {
            Ok(FilmWords { title, samples, size: [width, height] }) => {
                let about = format!("{} per pixel, {width}x{height}", counted(*samples, "sample"));
                row(Part::Film, known.unwrap_or(title), &about, None)
            }
            Err(fault) => row(Part::Film, known.unwrap_or("A film"), "", Some(fault.clone())),
        });
        let picture = match session {
            Some(Ok(session)) if session.is_changed && !(session.has_film && self.film.is_some()) => {
                Some(row(Part::Picture, &session.title, "changed camera, settings or spheres", None))
            }
            Some(Err(fault)) => Some(row(Part::Picture, "A picture", "", Some(fault.clone()))),
            _ => None,
        };
        let kept = match &self.kept {
            Ok(kept) if kept.is_empty() => None,
            Ok(kept) => {
                let names: Vec<&str> = kept.iter().map(|entry| entry.name.as_str()).collect();
                let title = counted(names.len() as u64, "kept picture");
                Some(row(Part::Slots, &title, &names.join("; "), None))
            }
            Err(fault) => Some(row(Part::Slots, "Kept pictures", "", Some(fault.clone()))),
        };
        film.into_iter().chain(picture).chain(kept)
    }
}

fn listed(files: &RecoveryFiles) -> Result<Vec<Entry>, String> {
    files.slots().listing().map(|listing| listing.entries)
}

/// How long ago something was, in words.
fn ago(age: Duration) -> String {
    let minutes = age.as_secs() / 60;
    match minutes {
        0 => "just now".to_owned(),
        1..60 => format!("{minutes} min ago"),
        60..2880 => format!("{} h ago", minutes / 60),
        _ => format!("{} days ago", minutes / 1440),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nothing_is_lost_with_is_not_offered() {
        let directory = tempfile::tempdir().unwrap();
        let write = |is_changed: bool, has_film: bool| {
            let files = RecoveryFiles::claim(directory.path()).unwrap();
            let session = serde_json::json!({ "title": "x", "is_changed": is_changed, "has_film": has_film });
            let session: Session = serde_json::from_value(session).unwrap();
            files.write_note(&session).unwrap();
        };
        write(false, false);
        write(false, true);
        assert!(Left::all_in(directory.path()).is_empty());
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
        // The film that it mentions is gone.
        write(true, true);
        let [left] = Left::all_in(directory.path()).try_into().ok().unwrap();
        assert_eq!(left.rows().map(|row| row.part).collect::<Vec<_>>(), [Part::Picture]);
    }

    #[test]
    fn damaged_files_are_named_until_they_are_deleted() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        std::fs::write(at("window-1-1.exr"), "not a film").unwrap();
        std::fs::write(at("window-1-1.json"), "{").unwrap();
        let mut all = Left::all_in(directory.path());
        for (part, name) in [(Part::Film, "window-1-1.exr"), (Part::Picture, "window-1-1.json")] {
            let fault = all[0].rows().find(|row| row.part == part).unwrap().fault.unwrap();
            assert!(fault.contains(name), "{fault}");
        }
        all[0].settle(Part::Film);
        assert!(!at("window-1-1.exr").exists() && at("window-1-1.json").exists());
        all[0].settle(Part::Picture);
        drop(all);
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}
