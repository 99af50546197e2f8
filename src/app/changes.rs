//! Tracks what the user has changed since the previous frame: moves, gestures and undo steps.

use super::model::Document;
use eframe::egui::Context;
use std::time::{Duration, Instant};

/// After this long without a move the picture is rendered at its full size.
const SETTLE: Duration = Duration::from_millis(160);

/// So many changes can be undone.
const STEPS: usize = 100;

/// The history of the document.
pub struct Changes {
    /// The document before each change, oldest first.
    undo: Vec<Document>,
    redo: Vec<Document>,
    last: Document,
    moved: Option<Instant>,
    /// A move was noted in this frame, however long the frame takes.
    has_moved: bool,
    /// Something is being moved, or a button of the mouse is held.
    is_in_gesture: bool,
    /// The step to undo has been added for the present gesture.
    has_step: bool,
    /// The document was changed by undo or redo, which is not a new undo step.
    is_undoing: bool,
}

impl Changes {
    /// A history that starts with `document`.
    pub fn new(document: Document) -> Self {
        Changes {
            undo: Vec::new(),
            redo: Vec::new(),
            last: document,
            moved: None,
            has_moved: false,
            is_in_gesture: false,
            has_step: false,
            is_undoing: false,
        }
    }

    /// The document of the frame before.
    pub fn last(&self) -> &Document {
        &self.last
    }

    /// What [`Changes::undo`] brings back.
    pub fn earlier(&self, document: &Document) -> Option<&Document> {
        self.undo.iter().rev().find(|earlier| *earlier != document)
    }

    /// What [`Changes::redo`] brings back.
    pub fn later(&self) -> Option<&Document> {
        self.redo.last()
    }

    /// Undoes the last change. One that came to nothing, such as a drag back, is skipped.
    pub fn undo(&mut self, document: &mut Document) {
        while let Some(earlier) = self.undo.pop() {
            if earlier != *document {
                self.redo.push(restore(document, earlier));
                self.is_undoing = true;
                break;
            }
        }
    }

    /// Redoes the change that was undone last.
    pub fn redo(&mut self, document: &mut Document) {
        if let Some(later) = self.redo.pop() {
            self.undo.push(restore(document, later));
            self.is_undoing = true;
        }
    }

    /// Notes a change by hand, which is previewed first.
    pub fn note_move(&mut self) {
        self.moved = Some(Instant::now());
        self.has_moved = true;
    }

    /// Ends the move. The changes of a command are not part of it.
    pub fn end_move(&mut self) {
        self.moved = None;
        (self.has_moved, self.is_in_gesture, self.has_step) = (false, false, false);
    }

    /// Whether something is being moved, or a button of the mouse is held.
    pub fn is_in_gesture(&self) -> bool {
        self.is_in_gesture
    }

    /// Whether something is being moved.
    pub fn is_moving(&self) -> bool {
        self.moved.is_some_and(|at| at.elapsed() < SETTLE)
    }

    /// Accepts a replaced document without treating it as a change of the film.
    pub fn adopt(&mut self, document: &Document) {
        self.last = document.clone();
    }

    /// Notes what has changed in this frame. Returns whether the document now needs a different film.
    pub fn follow(&mut self, context: &Context, document: &Document) -> bool {
        let is_by_hand = context.input(|input| input.pointer.any_down());
        let is_other_film = !document.has_same_film(&self.last);
        let before = std::mem::replace(&mut self.last, document.clone());
        if *document != before {
            // Undo returns to the state before a change, or before a whole gesture.
            if !self.has_step && !self.is_undoing {
                self.add(before);
            }
            self.has_step = true;
            if is_other_film && is_by_hand {
                self.note_move();
            }
        }
        self.is_undoing = false;
        self.is_in_gesture = std::mem::take(&mut self.has_moved) || self.is_moving() || is_by_hand;
        self.has_step &= self.is_in_gesture;
        is_other_film
    }

    fn add(&mut self, before: Document) {
        self.redo.clear();
        self.undo.push(before);
        if self.undo.len() > STEPS {
            self.undo.remove(0);
        }
    }
}

/// Replaces `document` by its state before or after a change, and returns it. A size that follows the viewport or the book
/// stays.
fn restore(document: &mut Document, state: Document) -> Document {
    let before = std::mem::replace(document, state);
    let follows = !before.has_own_size && !document.has_own_size;
    if follows && std::sync::Arc::ptr_eq(&before.origin, &document.origin) {
        document.set_size(before.size());
    }
    before
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use eframe::egui::{Event, Modifiers, PointerButton, Pos2, RawInput};

    #[test]
    fn a_move_with_long_frames_is_one_step() {
        let (context, mut document) = (Context::default(), Document::new(Origin::usual()));
        let mut changes = Changes::new(document.clone());
        let first = document.camera;
        for step in 1..=3 {
            changes.note_move();
            changes.moved = Instant::now().checked_sub(2 * SETTLE);
            document.camera.vfov_degrees += f64::from(step);
            assert!(changes.follow(&context, &document));
        }
        changes.undo(&mut document);
        assert_eq!(document.camera, first);
        assert!(changes.earlier(&document).is_none());
    }

    /// A document of which something was changed, so that its film is another one.
    fn change(document: &mut Document) {
        document.camera.vfov_degrees += 1.0;
    }

    #[test]
    fn changes_are_taken_back_and_made_again() {
        let (context, mut document) = (Context::default(), Document::new(Origin::usual()));
        let mut changes = Changes::new(document.clone());
        assert!(!changes.follow(&context, &document), "nothing has changed");
        let cameras: Vec<_> = (0..3)
            .map(|_| {
                let before = document.camera;
                change(&mut document);
                assert!(changes.follow(&context, &document));
                assert!(!changes.follow(&context, &document), "not again");
                before
            })
            .collect();
        let last = document.camera;
        assert!(changes.earlier(&document).is_some() && changes.later().is_none());
        for camera in cameras.into_iter().rev() {
            changes.undo(&mut document);
            assert_eq!(document.camera, camera);
            assert!(changes.follow(&context, &document));
        }
        assert!(changes.earlier(&document).is_none() && changes.later().is_some());
        for _ in 0..3 {
            changes.redo(&mut document);
            changes.follow(&context, &document);
        }
        assert_eq!(document.camera, last);
        assert!(changes.later().is_none());
    }

    #[test]
    fn a_change_that_needs_no_other_film_can_be_taken_back_too() {
        let (context, mut document) = (Context::default(), Document::new(Origin::usual()));
        let mut changes = Changes::new(document.clone());
        document.stop.seconds = Some(7.0);
        assert!(!changes.follow(&context, &document), "the same film goes on");
        assert!(changes.earlier(&document).is_some());
        changes.undo(&mut document);
        assert_eq!(document.stop.seconds, None);
    }

    /// Presses or releases the button of the pointer.
    fn press(context: &Context, pressed: bool) {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        let event = Event::PointerButton { pos: Pos2::ZERO, button, pressed, modifiers };
        let input = RawInput { events: vec![event], ..RawInput::default() };
        context.run_ui(input, |_| {}).textures_delta.clear();
    }

    #[test]
    fn what_is_changed_while_the_button_is_held_is_one_step() {
        let (context, mut document) = (Context::default(), Document::new(Origin::usual()));
        let mut changes = Changes::new(document.clone());
        press(&context, true);
        assert!(!changes.follow(&context, &document), "nothing has changed yet");
        for seconds in [7.0, 8.0] {
            document.stop.seconds = Some(seconds);
            assert!(!changes.follow(&context, &document));
            assert!(changes.moved.is_none(), "the film goes on, so nothing is previewed");
        }
        press(&context, false);
        changes.follow(&context, &document);
        document.stop.seconds = Some(9.0);
        changes.follow(&context, &document);
        for expected in [Some(8.0), None] {
            changes.undo(&mut document);
            changes.follow(&context, &document);
            assert_eq!(document.stop.seconds, expected);
        }
        assert!(changes.earlier(&document).is_none());
    }
}
