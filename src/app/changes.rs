//! What the user has changed since the frame before: moves, gestures, and what undo comes back to.

use super::model::document::Document;
use eframe::egui::{Context, util::undoer::Undoer};
use std::time::{Duration, Instant};

/// After this long without a move the picture is rendered at its full size.
const SETTLE: Duration = Duration::from_millis(160);

/// The history of the document.
pub struct Changes {
    undo: Undoer<Document>,
    last: Document,
    moved: Option<Instant>,
    /// The changes of this frame belong to a move that has begun before.
    is_in_gesture: bool,
    /// A document that was taken back or made again is no change of its own.
    is_undoing: bool,
}

impl Changes {
    /// No change of `document` yet.
    pub fn new(document: Document) -> Self {
        Changes {
            undo: Undoer::default(),
            last: document,
            moved: None,
            is_in_gesture: false,
            is_undoing: false,
        }
    }

    /// Whether there is a change to take back.
    pub fn can_undo(&self, document: &Document) -> bool {
        self.undo.has_undo(document)
    }

    /// Whether there is a change to make again.
    pub fn can_redo(&self, document: &Document) -> bool {
        self.undo.has_redo(document)
    }

    /// Takes the last change back.
    pub fn undo(&mut self, document: &mut Document) {
        if let Some(earlier) = self.undo.undo(document) {
            document.clone_from(earlier);
            self.is_undoing = true;
        }
    }

    /// Makes the change again that was taken back last.
    pub fn redo(&mut self, document: &mut Document) {
        if let Some(later) = self.undo.redo(document) {
            document.clone_from(later);
            self.is_undoing = true;
        }
    }

    /// A change by hand: a preview comes first.
    pub fn note_move(&mut self) {
        self.moved = Some(Instant::now());
    }

    /// A command: what it changes is no part of a move.
    pub fn end_move(&mut self) {
        self.moved = None;
        self.is_in_gesture = false;
    }

    /// Whether something is being moved.
    pub fn is_moving(&self) -> bool {
        self.moved.is_some_and(|at| at.elapsed() < SETTLE)
    }

    /// The document has been replaced, which is no change of its film.
    pub fn adopt(&mut self, document: &Document) {
        self.last = document.clone();
    }

    /// Notes what has changed in this frame. Returns whether the film is another.
    pub fn follow(&mut self, context: &Context, document: &Document) -> bool {
        let is_by_hand = context.input(|input| input.pointer.any_down());
        let mut is_other_film = false;
        if *document != self.last {
            // What was before a change, or before a whole gesture, is what undo comes back to.
            if !self.is_in_gesture && !self.is_undoing {
                self.undo.add_undo(&self.last);
            }
            is_other_film = !document.has_same_film(&self.last);
            if is_other_film && is_by_hand {
                self.note_move();
            }
            self.last = document.clone();
        }
        self.is_undoing = false;
        self.is_in_gesture = self.is_moving() || is_by_hand;
        let now = context.input(|input| input.time);
        self.undo.feed_state(now, document);
        is_other_film
    }
}
