//! Keeps what the window shows for the next window, and shows it again.

use super::changes::Changes;
use super::model::document::Document;
use super::model::framing::Framing;
use super::model::origin::Origin;
use super::model::session::{Restored, Session};
use super::model::view::ViewState;
use super::recovery::{Arrival, Choice, Left, Part, Recovery, RecoveryFiles, Saved, write_film};
use super::window::Window;
use crate::job::saved::{Content, Opened, SavedFilm};
use crate::progressive::describe::counted;
use crate::progressive::{Phase, Stop};
use crate::system::interrupt::Interrupt;
use eframe::egui::{Context, Rect, Ui, ViewportCommand};
use std::path::Path;
use std::sync::Arc;

impl Window {
    /// Keeps files in `directory` from now on, of which kept pictures may take `limit` bytes. Shows again what the last
    /// window showed, if `may_restore`.
    pub(super) fn begin_recovery(
        &mut self,
        directory: &Path,
        may_restore: bool,
        (stop, limit): (Option<Stop>, u64),
    ) {
        let mut files = match RecoveryFiles::claim(directory) {
            Ok(files) => files,
            Err(reason) => {
                self.toasts
                    .bad(format!("Nothing is autosaved, and kept pictures will not come back: {reason}"));
                return;
            }
        };
        if may_restore && let Err(reason) = self.take_session(&files) {
            self.toasts.bad(format!("What was shown last cannot be shown again: {reason}"));
            // What cannot be shown is left as it is, to be offered; the kept pictures are not concerned.
            let Ok(others) = RecoveryFiles::claim(directory) else { return };
            let taken = others.take_slots(&files);
            files = others;
            if let Err(error) = taken {
                self.toasts.bad(format!("Kept pictures stay where they are: {error}"));
            }
        }
        if let Some(stop) = stop {
            self.model.document.stop = stop;
        }
        self.begin_slots(&files, limit);
        self.recovery.files = Some(files);
    }

    fn take_session(&mut self, files: &RecoveryFiles) -> Result<(), String> {
        if !files.take_session().map_err(|error| error.to_string())? {
            return Ok(());
        }
        let Some(session) = files.note()? else { return Ok(()) };
        let restored = session.restore()?;
        let document = restored.document.clone();
        self.recovery.shown_slots = Some(restored.slots);
        self.show_restored(restored);
        self.changes = Changes::new(document.clone());
        if files.has_film() {
            self.recovery.resuming = Some(document);
        }
        Ok(())
    }

    fn show_restored(&mut self, restored: Restored) {
        let Restored { document, view, framing, is_paused, note, .. } = restored;
        self.show_document(document);
        self.show_view(view);
        match framing {
            Some(framing) => self.viewport.placement.show_as(framing),
            None => self.viewport.placement.fit(),
        }
        self.model.is_paused = is_paused;
        if let Some(note) = note {
            self.toasts.bad(note);
        }
    }

    /// Shows another view. A film that was loaded to compare with stays loaded, and kept pictures stay kept.
    fn show_view(&mut self, view: ViewState) {
        let reference = self.model.view.reference.take();
        let mut slots = std::mem::take(&mut self.model.view.slots);
        slots.look(None);
        self.model.view = view;
        (self.model.view.reference, self.model.view.slots) = (reference, slots);
    }

    /// Shows the usual first picture.
    pub(super) fn start_fresh(&mut self) {
        self.show_view(ViewState::default());
        self.viewport.placement.fit();
        self.model.is_paused = false;
        self.show_document(Document::new(Origin::usual()));
    }

    /// Ends the window in order when one of these signals arrives.
    pub(super) fn heed(&mut self, interrupt: Arc<Interrupt>) {
        self.recovery.heed(interrupt);
    }

    /// Takes what has been found and read.
    pub(super) fn receive_recovered(&mut self) {
        self.model.has_recovered = self.recovery.follow();
        while let Some(outcome) = self.recovery.resumed.take() {
            self.take_resumed(outcome);
        }
        while let Some(arrival) = self.recovery.arrivals.take() {
            if let Some((left, part)) = self.recovery.opening.take() {
                self.take_arrival(arrival, left, part);
            }
        }
    }

    /// Goes on with the film in the window's own file.
    fn take_resumed(&mut self, outcome: Result<SavedFilm, String>) {
        let Some(begun) = self.recovery.resuming.take() else { return };
        match outcome {
            Ok(film) if self.document().has_same_film(&begun) => {
                let samples = film.film.sample_count();
                self.toasts.good(format!("Continuing with {} per pixel", counted(samples, "sample")));
                self.go_on_recovered(film);
            }
            // Undo brings it back.
            Ok(film) => {
                let samples = film.film.sample_count();
                self.recovery.autosave.holds(Some(Saved { document: begun, samples }));
            }
            Err(reason) => {
                self.recovery.autosave.holds(None);
                let aside = self.recovery.files.as_ref().map(RecoveryFiles::set_film_aside);
                let place = match aside {
                    Some(Ok(path)) => format!("; it is kept as {}", path.display()),
                    _ => String::new(),
                };
                self.toasts.bad(format!("The film of this picture is not continued: {reason}{place}"));
            }
        }
    }

    /// Continues a film that is in the window's own file.
    fn go_on_recovered(&mut self, film: SavedFilm) {
        let samples = film.film.sample_count();
        self.adopt(film);
        self.recovery.autosave.holds(Some(Saved { document: self.model.document.clone(), samples }));
        self.recovery.note_soon();
    }

    /// Shows a part of what another window left.
    fn take_arrival(&mut self, arrival: Arrival, mut left: Left, part: Part) {
        let Arrival { opened, restored } = arrival;
        // A film may have been written since the last look.
        self.recovery.autosave.finish();
        let has_own_film = self.recovery.has_film_of(self.document());
        let film = match (opened, restored) {
            (Some(Ok(Opened { content: Content::Film(film), recipe, stage, .. })), restored) => {
                match restored {
                    Some(Ok(restored)) => self.show_restored(restored),
                    _ => {
                        left.separate();
                        self.show_document(Document::of_film(&recipe, stage));
                    }
                }
                Some(film)
            }
            (None, Some(Ok(restored))) => {
                self.show_restored(restored);
                None
            }
            (Some(Err(reason)), _) | (None, Some(Err(reason))) => {
                self.toasts.bad(format!("Not opened: {reason}"));
                left.mark(part, reason);
                self.recovery.put_back(0, left);
                return;
            }
            (Some(Ok(_)), _) | (None, None) => {
                self.toasts.bad(format!("Not opened: {} holds no picture", left.path(part).display()));
                return;
            }
        };
        self.toasts.good(format!("Opened {}", self.document().title()));
        if let (Some(film), Some(files)) = (film, &self.recovery.files) {
            // The film of the picture that was shown until now is offered by the next window.
            let aside = if has_own_film { files.set_film_aside().map(drop) } else { Ok(()) };
            if let Err(error) = aside.and_then(|()| files.take_film(&left.files)) {
                self.toasts.bad(format!("{} stays where it is: {error}", left.files.film().display()));
                self.adopt(film);
                return;
            }
            self.go_on_recovered(film);
        }
        left.settle(part);
        self.recovery.note_soon();
        self.recovery.put_back(0, left);
    }

    /// Draws the card with what was kept of other windows.
    pub(super) fn offer_recovered(&mut self, ui: &Ui, room: Rect) {
        let Recovery { card, left, opening, resuming, .. } = &mut self.recovery;
        match card.ui(ui, room, left, opening.is_some() || resuming.is_some()) {
            Some(Choice::Open(index, Part::Slots)) => self.take_left_slots(ui.ctx(), index),
            Some(Choice::Open(index, part)) => self.recovery.open(ui.ctx(), index, part),
            Some(Choice::Discard(index, part)) => self.recovery.discard(index, part),
            Some(Choice::Later) => self.recovery.left.clear(),
            None => {}
        }
        self.model.has_recovered = !self.recovery.left.is_empty();
    }

    /// Closes the card with what other windows left; the next window offers it again.
    pub(super) fn close_recovered(&mut self) {
        self.recovery.left.clear();
        self.model.has_recovered = false;
    }

    /// Has settings, kept pictures, the film and what the window shows written if it is time, also while the window is
    /// hidden.
    pub(super) fn write_recovery(&mut self, context: &Context) {
        if self.recovery.interrupt().is_some_and(|interrupt| interrupt.is_set()) {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
        self.keep_settings(context);
        self.keep_slots(context);
        if !self.recovery.is_time(context) {
            return;
        }
        let status = self.main.newest_status();
        self.recovery.is_working = status.phase.is_working();
        let Recovery { files, autosave, resuming, .. } = &mut self.recovery;
        let document = &self.model.document;
        if let Some(files) = files.as_ref().filter(|_| resuming.is_none())
            && let Some(words) =
                autosave.look(context, files.film(), (document, &self.main), &status, self.seconds_before)
        {
            self.toasts.bad(words);
        }
        // Undo has brought a picture back.
        let is_behind = |saved: &Saved| {
            saved.document.has_same_film(document) && status.samples_per_pixel < saved.samples
        };
        let is_settled =
            !matches!(status.phase, Phase::Idle | Phase::Preparing) && self.main.is_full(document);
        if is_settled && resuming.is_none() && autosave.saved().is_some_and(is_behind) {
            self.recovery.resume(context, document);
        }
        let framing = self.framing();
        let shown = (document, &self.model.view, framing);
        if let Some(reason) = self.recovery.note(context, shown, self.model.is_paused) {
            self.toasts.bad(format!("What this window shows is not kept: {reason}"));
        }
    }

    /// Leaves what the window shows to the next one, with the film if tracing it took long.
    pub fn end_in_order(&mut self) {
        self.finish_settings();
        let Some(files) = self.recovery.files.take() else { return };
        let interrupt = self.recovery.interrupt().cloned();
        let _writing = interrupt.as_ref().map(|interrupt| interrupt.while_writing("the picture"));
        self.recovery.autosave.finish();
        self.recovery.finish_notes();
        self.finish_slots();
        let document = self.model.document.clone();
        let has_film = match self.recovery.resuming.take() {
            // The film is still being read, so it is as it was.
            Some(begun) if begun.has_same_film(&document) => true,
            Some(_) => {
                // If that fails, the film stays with the picture, and the next window says that it is of another one.
                let _ = files.set_film_aside();
                false
            }
            None => self.leave_film(&files, &document),
        };
        let framing = self.framing();
        let session = Session::of(&document, &self.model.view, self.model.is_paused).with_framing(framing);
        if document.job(1).is_ok()
            && let Err(reason) = files.write_note(&session.with_film(has_film))
        {
            crate::system::console::note(&format!("weekender: what the window showed is not kept: {reason}"));
        }
        if let Err(error) = files.leave_session() {
            crate::system::console::note(&format!("weekender: what the window showed is not kept: {error}"));
        }
    }

    /// Zoom and pan of the live picture, if they do not follow from the viewport.
    fn framing(&self) -> Option<Framing> {
        let is_live = self.model.view.slots.looked().is_none();
        self.viewport.placement.framing(self.document().size()).filter(|_| is_live)
    }

    /// Writes the film of `document` if tracing it took long, and deletes that of another picture.
    fn leave_film(&mut self, files: &RecoveryFiles, document: &Document) -> bool {
        let status = self.main.newest_status();
        let is_long = self.recovery.autosave.is_long(document, &self.main, &status, self.seconds_before);
        if !is_long {
            files.delete_film();
            return false;
        }
        let saved = self.recovery.autosave.saved().filter(|saved| saved.document.has_same_film(document));
        let saved = saved.map(|saved| saved.samples);
        if saved.is_some_and(|saved| saved >= status.samples_per_pixel) {
            return true;
        }
        let outcome = self
            .main
            .take_film()
            .map(|film| write_film(files.film(), &film, (document, &status), self.seconds_before));
        if let Some(Err(reason)) = &outcome {
            crate::system::console::note(&format!("weekender: the film is not kept: {reason}"));
        }
        // What was written before is still there.
        matches!(outcome, Some(Ok(_))) || saved.is_some()
    }
}

#[cfg(test)]
mod tests;
