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
use crate::interrupt::Interrupt;
use crate::saved::{self, Opened, SavedFilm};
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
        // Without a thread, the next window offers it.
        let _ = self.found.ask("files", context, move || Left::all_in(&directory));
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
        if self.resumed.ask("files", context, read).is_ok() {
            self.resuming = Some(document.clone());
        }
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
        match self.arrivals.ask("files", context, read) {
            Ok(()) => self.opening = Some((left, part)),
            Err(_) => self.left.insert(index, left),
        }
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
        self.is_noting = self.notes.ask("files", context, work).is_ok();
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
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::app::tests::sleep_after;
    use crate::stages::Stage;
    use std::path::Path;

    fn metal() -> Document {
        Document::new(Origin::of_stage(Stage::find("metal").unwrap()))
    }

    #[test]
    fn a_note_that_cannot_be_written_is_told_of_once() {
        let mut recovery = Recovery::new(Duration::from_secs(3600));
        let (context, view, document) = (Context::default(), ViewState::default(), metal());
        let mut tell = |outcome: Result<(), &str>| {
            recovery.notes.answer(&context).give(outcome.map_err(str::to_owned));
            recovery.note(&context, (&document, &view, None), false)
        };
        assert_eq!(tell(Ok(())), None);
        assert_eq!(tell(Err("the disk is full")).as_deref(), Some("the disk is full"));
        assert_eq!(
            [tell(Err("the disk is full")), tell(Ok(())), tell(Err("the disk is full"))],
            [None, None, None]
        );
    }

    #[test]
    fn each_change_is_noted_once_and_not_too_often() {
        let directory = tempfile::tempdir().unwrap();
        let mut recovery = Recovery::new(Duration::from_secs(3600));
        recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
        let (context, view) = (Context::default(), ViewState::default());
        let later = Instant::now() + Duration::from_secs(3600);
        let mut document = metal();
        // Whether a note was written, if the next one may be written then.
        let is_noted = |recovery: &mut Recovery, document: &Document, next: Instant| {
            recovery.next_note = next;
            assert_eq!(recovery.note(&context, (document, &view, None), true), None);
            let is_noting = recovery.is_noting;
            recovery.finish_notes();
            assert!(!recovery.is_noting);
            is_noting
        };
        let noted = |recovery: &Recovery| recovery.files.as_ref().unwrap().note().unwrap();
        let now = Instant::now();
        assert!(!is_noted(&mut recovery, &document, now) && noted(&recovery).is_none(), "nothing is changed");
        document.camera.vfov_degrees = 33.0;
        assert!(!is_noted(&mut recovery, &document, later), "too soon");
        assert!(is_noted(&mut recovery, &document, now));
        assert!(recovery.next_note > now + NOTES_APART / 2);
        let found = noted(&recovery).unwrap();
        assert!(found.is_changed && !found.has_film && found.restore().unwrap().is_paused);
        assert!(!is_noted(&mut recovery, &document, now), "once");
        recovery.autosave.holds(Some(Saved { document: document.clone(), samples: 1 }));
        assert!(is_noted(&mut recovery, &document, later), "a film needs its note at once");
        assert!(noted(&recovery).unwrap().has_film);
        recovery.note_soon();
        assert!(recovery.next_note <= Instant::now());
    }

    #[test]
    fn a_window_that_keeps_nothing_never_looks() {
        let directory = tempfile::tempdir().unwrap();
        let (mut recovery, context) = (Recovery::new(Duration::from_secs(3600)), Context::default());
        let now = Instant::now();
        recovery.next_look = now;
        assert!(!recovery.is_time(&context));
        recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
        assert!(recovery.is_time(&context));
        assert!(recovery.next_look >= now + LOOKS_APART, "the next look is later");
        recovery.next_look = now + Duration::from_secs(3600);
        assert!(!recovery.is_time(&context));
    }

    /// What three windows left in a directory.
    fn left_by_three(directory: &Path) -> Recovery {
        for name in ["window-1-1.exr", "window-2-1.exr", "window-3-1.exr"] {
            std::fs::write(directory.join(name), "a film").unwrap();
        }
        let mut recovery = Recovery::new(Duration::from_secs(3600));
        recovery.left = Left::all_in(directory);
        recovery
    }

    fn films(recovery: &Recovery) -> Vec<PathBuf> {
        recovery.left.iter().map(|left| left.path(Part::Film)).collect()
    }

    #[test]
    fn what_is_not_opened_after_all_keeps_its_place() {
        let directory = tempfile::tempdir().unwrap();
        let mut recovery = left_by_three(directory.path());
        let all = films(&recovery);
        assert_eq!(all.len(), 3);
        for (from, to) in [(0, 0), (1, 1), (2, 2), (2, 9)] {
            let left = recovery.left.remove(from);
            recovery.put_back(to, left);
            assert_eq!(films(&recovery), all, "{from} to {to}");
        }
        recovery.discard(3, Part::Film);
        assert_eq!(films(&recovery), all, "there is none");
        recovery.discard(1, Part::Film);
        assert_eq!(films(&recovery), [all[0].clone(), all[2].clone()]);
        assert_eq!([0, 1, 2].map(|index| all[index].exists()), [true, false, true]);
    }

    #[test]
    fn one_thing_is_opened_at_a_time() {
        let directory = tempfile::tempdir().unwrap();
        let mut recovery = left_by_three(directory.path());
        let (all, context) = (films(&recovery), Context::default());
        recovery.open(&context, 3, Part::Film);
        assert!(recovery.opening.is_none(), "there is none");
        for _ in 0..2 {
            recovery.open(&context, 1, Part::Film);
        }
        assert_eq!(films(&recovery), [all[0].clone(), all[2].clone()]);
        assert!(recovery.opening.as_ref().is_some_and(|(left, _)| left.path(Part::Film) == all[1]));
        let arrival = recovery.arrivals.wait().unwrap();
        assert!(arrival.opened.is_some_and(|opened| opened.is_err()) && arrival.restored.is_none());
    }

    #[test]
    fn a_window_that_works_is_woken_for_the_next_look() {
        let directory = tempfile::tempdir().unwrap();
        let (mut recovery, context) = (Recovery::new(Duration::from_secs(3600)), Context::default());
        let is_woken = |recovery: &mut Recovery| {
            sleep_after(&context, |context| _ = recovery.is_time(context)) <= LOOKS_APART
        };
        recovery.is_working = true;
        assert!(!is_woken(&mut recovery), "it keeps nothing");
        recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
        assert!(is_woken(&mut recovery));
        recovery.is_working = false;
        assert!(!is_woken(&mut recovery));
    }
}
