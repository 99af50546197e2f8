//! What a window keeps for the next one: the film of a long render, and what it shows.

mod autosave;
mod card;
mod files;
mod left;
mod paths;
mod turn;

pub use autosave::{Autosave, Saved, write_film};
pub use card::{Card, Choice};
pub use files::RecoveryFiles;
pub use left::{Left, Part};

use super::answers::Answers;
use super::model::document::Document;
use super::model::framing::Framing;
use super::model::kept_view::ShownSlots;
use super::model::session::{Restored, Session};
use super::model::view::ViewState;
use super::slot_files::{Keeper, SlotReader};
use crate::job::saved::{self, Opened, SavedFilm};
use crate::system::interrupt::Interrupt;
use eframe::egui::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The shortest time between two looks at the film.
const LOOKS_APART: Duration = Duration::from_millis(100);

/// The shortest time between two notes of what the window shows.
const NOTES_APART: Duration = Duration::from_secs(5);

/// A film or picture that was kept and has been read.
pub struct Arrival {
    /// The film and the picture that it describes.
    pub opened: Option<Result<Opened, String>>,
    /// The picture and the view as noted. With a film: only if the film belongs to it.
    pub restored: Option<Result<Restored, String>>,
}

/// What a window keeps.
pub struct Recovery {
    /// The window's own files, if it can have any.
    pub files: Option<RecoveryFiles>,
    /// Writes the film.
    pub autosave: Autosave,
    /// What other windows left.
    pub left: Vec<Left>,
    /// The card that offers it.
    pub card: Card,
    /// What is being opened.
    pub opening: Option<(Left, Part)>,
    /// The picture whose film is being read from the window's own file.
    pub resuming: Option<Document>,
    /// Parts that were left and have been read.
    pub arrivals: Answers<Arrival>,
    /// Writes the pictures in the slots, if the window can have files.
    pub keeper: Option<Keeper>,
    /// Reads kept pictures.
    pub reader: SlotReader,
    /// The slots to show once their pictures are there.
    pub shown_slots: Option<ShownSlots>,
    /// The window's own film.
    pub resumed: Answers<Result<SavedFilm, String>>,
    found: Answers<Vec<Left>>,
    notes: Answers<Result<(), String>>,
    noted: Option<(Document, bool)>,
    is_noting: bool,
    /// Samples were being added at the last look. A hidden window asks for the next look only then.
    pub is_working: bool,
    has_failed: bool,
    next_note: Instant,
    next_look: Instant,
    interrupt: Option<Arc<Interrupt>>,
}

impl Recovery {
    /// Keeps nothing yet. Films that took longer than `every` are written, and again each `every`.
    pub fn new(every: Duration) -> Self {
        Recovery {
            files: None,
            autosave: Autosave::new(every),
            left: Vec::new(),
            card: Card::default(),
            opening: None,
            resuming: None,
            arrivals: Answers::default(),
            keeper: None,
            reader: SlotReader::default(),
            shown_slots: None,
            resumed: Answers::default(),
            found: Answers::default(),
            notes: Answers::default(),
            noted: None,
            is_noting: false,
            is_working: false,
            has_failed: false,
            next_note: Instant::now() + NOTES_APART,
            next_look: Instant::now(),
            interrupt: None,
        }
    }

    /// Ends the window when a signal arrives.
    pub fn heed(&mut self, interrupt: Arc<Interrupt>) {
        self.interrupt = Some(interrupt);
    }

    /// The signals that end the window.
    pub fn interrupt(&self) -> Option<&Arc<Interrupt>> {
        self.interrupt.as_ref()
    }

    /// Looks for what other windows left, and reads the film of the last one.
    pub fn begin(&mut self, context: &Context) {
        let Some(files) = &self.files else { return };
        let directory = files.film().parent().map(PathBuf::from).unwrap_or_default();
        let substitute = |reason: String| {
            log::warn!("what other windows left is offered by the next window: {reason}");
            Vec::new()
        };
        self.found.ask("files", context, move || Left::all_in(&directory), substitute);
        if let Some(document) = self.resuming.take() {
            self.resume(context, &document);
        }
    }

    /// Reads the window's own film, which is of `document`.
    pub fn resume(&mut self, context: &Context, document: &Document) {
        let Some(files) = &self.files else { return };
        let (path, begun) = (files.film().to_owned(), document.clone());
        let read = move || {
            let job = begun.job(1).map_err(|error| error.to_string())?;
            saved::resume(&path, &job).map_err(|error| error.to_string())
        };
        self.resumed.ask("files", context, read, Err);
        self.resuming = Some(document.clone());
    }

    /// Takes what was found. Returns whether there is something to offer.
    pub fn follow(&mut self) -> bool {
        if let Some(found) = self.found.take() {
            self.left.extend(found);
        }
        !self.left.is_empty()
    }

    /// Opens a part of what was left, on a thread.
    pub fn open(&mut self, context: &Context, index: usize, part: Part) {
        if self.opening.is_some() || index >= self.left.len() {
            return;
        }
        let left = self.left.remove(index);
        let (session, path) = (left.session(part).cloned(), left.path(part));
        let read = move || {
            let opened = (part == Part::Film).then(|| saved::open(&path).map_err(|error| error.to_string()));
            let restored = session.map(|session| session.restore());
            let is_of_film = |restored: &Restored| match &opened {
                Some(Ok(opened)) => restored.document.job(1).is_ok_and(|job| job == opened.job),
                _ => true,
            };
            let restored =
                restored.filter(|restored| restored.as_ref().map_or(part == Part::Picture, is_of_film));
            Arrival { opened, restored }
        };
        let substitute = move |reason: String| match part {
            Part::Film => Arrival { opened: Some(Err(reason)), restored: None },
            Part::Picture | Part::Slots => Arrival { opened: None, restored: Some(Err(reason)) },
        };
        self.arrivals.ask("files", context, read, substitute);
        self.opening = Some((left, part));
    }

    /// Deletes a part of what was left.
    pub fn discard(&mut self, index: usize, part: Part) {
        if index < self.left.len() {
            let mut left = self.left.remove(index);
            left.settle(part);
            self.put_back(index, left);
        }
    }

    /// Offers the rest of what was left, if there is any.
    pub fn put_back(&mut self, index: usize, left: Left) {
        if left.rows().next().is_some() {
            self.left.insert(index.min(self.left.len()), left);
        }
    }

    /// Whether it is time to look at the film and at what the window shows.
    pub fn is_time(&mut self, context: &Context) -> bool {
        if self.is_working && self.files.is_some() {
            context.request_repaint_after(LOOKS_APART);
        }
        let now = Instant::now();
        let is_time = self.files.is_some() && now >= self.next_look;
        if is_time {
            self.next_look = now + LOOKS_APART;
        }
        is_time
    }

    /// Whether the film that was written last is of `document`.
    pub fn has_film_of(&self, document: &Document) -> bool {
        self.autosave.saved().is_some_and(|saved| saved.document.has_same_film(document))
    }

    /// Has a note written of what the window shows if that has changed. Returns why the last note could not be written,
    /// once.
    pub fn note(
        &mut self,
        context: &Context,
        (document, view, framing): (&Document, &ViewState, Option<Framing>),
        is_paused: bool,
    ) -> Option<String> {
        let mut words = None;
        if let Some(outcome) = self.notes.take() {
            self.is_noting = false;
            words = outcome.err().filter(|_| !self.has_failed);
            self.has_failed |= words.is_some();
        }
        let has_film = self.has_film_of(document);
        let is_known = match &self.noted {
            Some((noted, had_film)) => noted == document && *had_film == has_film,
            None => !document.is_changed() && !has_film,
        };
        if is_known || self.is_noting {
            return words;
        }
        // A film that has just been written needs its note: the note knows when the render ends.
        let had_film = self.noted.as_ref().is_some_and(|(_, had_film)| *had_film);
        let wait = self.next_note.saturating_duration_since(Instant::now());
        if !wait.is_zero() && had_film == has_film {
            context.request_repaint_after(wait);
            return words;
        }
        let Some(files) = &self.files else { return words };
        let (write, shown, view) = (files.note_writer(), document.clone(), view.clone());
        let session = move || Session::of(&shown, &view, is_paused).with_framing(framing).with_film(has_film);
        let work = move || write(&session());
        self.notes.ask("files", context, work, Err);
        self.is_noting = true;
        self.next_note = Instant::now() + NOTES_APART;
        self.noted = Some((document.clone(), has_film));
        words
    }

    /// Waits for a note that is being written.
    pub fn finish_notes(&mut self) {
        while self.is_noting && self.notes.wait().is_some() {
            self.is_noting = false;
        }
    }

    /// Has the next note written at once.
    pub fn note_soon(&mut self) {
        self.next_note = Instant::now();
    }
}

#[cfg(test)]
mod tests;
