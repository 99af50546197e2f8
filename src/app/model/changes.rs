//! Tracks what the user has changed since the previous frame: moves, gestures and undo steps.

use super::{Document, Model, Partner, Source};
use eframe::egui::Context;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// After this long without a move the picture is rendered at its full size.
const SETTLE: Duration = Duration::from_millis(160);

/// Maximum number of undo steps.
const STEPS: usize = 100;

/// What has changed since the frame before, once nothing more changes the document in this one.
#[derive(Clone, Copy)]
pub struct Changed {
    pub document: bool,
    /// Another picture is shown.
    pub picture: bool,
    /// The document needs a different film.
    pub film: bool,
    /// Of the same picture, when the render ends.
    pub stop: bool,
    /// What it is compared with, if that is asked for.
    pub partner: bool,
}

/// The history of the document.
pub struct Changes {
    /// The document at the end of each change or gesture, oldest first.
    done: VecDeque<Document>,
    /// The documents that were undone, the next one to redo last.
    undone: Vec<Document>,
    /// The document of the frame before, and what it was compared with.
    pub last: Document,
    partner: Option<Partner>,
    moved: Option<Instant>,
    /// A move was noted in this frame, however long the frame takes.
    has_moved: bool,
    /// Something is being moved, or a button of the mouse is held.
    pub is_in_gesture: bool,
}

impl Changes {
    /// A history that starts with `document`.
    pub fn new(document: Document) -> Self {
        let (done, undone) = ([document.clone()].into(), Vec::new());
        let (moved, partner) = (None, None);
        Changes { done, undone, last: document, partner, moved, has_moved: false, is_in_gesture: false }
    }

    /// A history of these documents, oldest first; `shown` is the last one.
    pub fn of_steps(steps: &[Document], shown: Document) -> Self {
        let mut changes = Changes::new(steps.first().unwrap_or(&shown).clone());
        steps.iter().for_each(|step| end_step(&mut changes.done, step));
        Changes { last: shown, ..changes }
    }

    /// The document, and at most `count` states before it, oldest first.
    pub fn last_steps(&self, document: &Document, count: usize) -> Vec<Document> {
        let mut done = self.done.clone();
        end_step(&mut done, document);
        done.drain(..done.len().saturating_sub(count + 1));
        done.into()
    }

    /// All documents of the history.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut Document> {
        self.done.iter_mut().chain(&mut self.undone).chain([&mut self.last])
    }

    /// What undo and redo would change, in words.
    pub fn labels(&self, document: &Document) -> [Option<&'static str>; 2] {
        let undone = self.earlier(document).map(|earlier| document.difference(earlier));
        [undone, self.later(document).map(|later| later.difference(document))]
    }

    /// The last state of a picture from this source.
    pub fn last_of(&self, source: &Source) -> Option<&Document> {
        [&self.last].into_iter().chain(self.done.iter().rev()).find(|done| done.origin.source == *source)
    }

    fn earlier(&self, document: &Document) -> Option<&Document> {
        self.done.iter().rev().take(2).find(|done| *done != document)
    }

    fn later(&self, document: &Document) -> Option<&Document> {
        self.undone.last().filter(|_| self.done.back() == Some(document))
    }

    /// Undoes the last change.
    pub fn undo(&mut self, document: &mut Document) {
        let Some(earlier) = self.earlier(document).cloned() else { return };
        if self.done.back() == Some(&*document) {
            self.done.pop_back();
        }
        self.undone.push(document.clone());
        restore(document, earlier);
    }

    /// Redoes the change that was undone last.
    pub fn redo(&mut self, document: &mut Document) {
        let Some(later) = self.later(document).cloned() else { return };
        self.done.extend(self.undone.pop());
        restore(document, later);
    }

    /// Notes a change by hand, which is previewed first.
    pub fn note_move(&mut self) {
        self.moved = Some(Instant::now());
        self.has_moved = true;
    }

    /// Ends the move. The changes of a command are not part of it.
    pub fn end_move(&mut self) {
        end_step(&mut self.done, &self.last);
        (self.moved, self.has_moved, self.is_in_gesture) = (None, false, false);
    }

    /// Whether something is being moved.
    pub fn is_moving(&self) -> bool {
        self.moved.is_some_and(|at| at.elapsed() < SETTLE)
    }

    /// Compares the model with that of the frame before.
    pub fn look(&mut self, model: &Model) -> Changed {
        let (document, last) = (&model.document, &self.last);
        let partner = model.view.compared(document);
        let picture = !Arc::ptr_eq(&document.origin, &last.origin);
        Changed {
            document: document != last,
            picture,
            film: !document.has_same_film(last),
            stop: !picture && document.stop != last.stop,
            partner: std::mem::replace(&mut self.partner, partner) != partner,
        }
    }

    /// Notes what has changed in this frame. The picture of a check, a visit, is no step.
    pub fn follow(&mut self, context: &Context, document: &Document, changed: Changed, is_visit: bool) {
        let is_by_hand = context.input(|input| input.pointer.any_down());
        if changed.document && changed.film && is_by_hand {
            self.note_move();
        }
        self.last = document.clone();
        self.is_in_gesture = std::mem::take(&mut self.has_moved) || self.is_moving() || is_by_hand;
        if self.done.back() != Some(document) {
            self.undone.clear();
        }
        if !self.is_in_gesture && !is_visit {
            end_step(&mut self.done, document);
        }
    }
}

/// Ends a step at `document`, if it has changed since the last one.
fn end_step(done: &mut VecDeque<Document>, document: &Document) {
    if done.back() != Some(document) {
        done.push_back(document.clone());
        done.drain(..done.len().saturating_sub(STEPS));
    }
}

/// Replaces `document` by another state of it. A size that follows the viewport or the book stays.
fn restore(document: &mut Document, state: Document) {
    let before = std::mem::replace(document, state);
    let follows = !before.has_own_size && !document.has_own_size;
    if follows && Arc::ptr_eq(&before.origin, &document.origin) {
        document.set_size(before.size());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::app::tests::window;
    use crate::progressive::Stop;
    use eframe::egui::{Event, Modifiers, PointerButton, Pos2, RawInput};

    /// Follows `document`. Returns whether it needs a different film.
    fn follow(changes: &mut Changes, context: &Context, document: &Document, is_visit: bool) -> bool {
        let mut model = window("weekender --stage metal --size 16x9 --device cpu").model.clone();
        model.document = document.clone();
        let changed = changes.look(&model);
        changes.follow(context, document, changed, is_visit);
        changed.film
    }

    #[test]
    fn a_move_with_long_frames_is_one_undo_step() {
        let (context, mut document) = (Context::default(), Document::new(Origin::usual()));
        let mut changes = Changes::new(document.clone());
        let first = document.camera;
        for step in 1..=3 {
            changes.note_move();
            changes.moved = Instant::now().checked_sub(2 * SETTLE);
            document.camera.vfov_degrees += f64::from(step);
            assert!(follow(&mut changes, &context, &document, false));
        }
        changes.undo(&mut document);
        assert_eq!(document.camera, first);
        assert!(changes.earlier(&document).is_none());
    }

    /// Presses or releases the button of the pointer.
    fn press(context: &Context, pressed: bool) {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        let event = Event::PointerButton { pos: Pos2::ZERO, button, pressed, modifiers };
        let input = RawInput { events: vec![event], ..RawInput::default() };
        context.run_ui(input, |_| {}).textures_delta.clear();
    }

    #[test]
    fn a_drag_is_one_undo_step() {
        let (context, mut document) = (Context::default(), Document::new(Origin::usual()));
        let mut changes = Changes::new(document.clone());
        press(&context, true);
        assert!(!follow(&mut changes, &context, &document, false), "nothing has changed yet");
        for seconds in [7.0, 8.0] {
            document.stop.seconds = Some(seconds);
            assert!(!follow(&mut changes, &context, &document, false));
            assert!(changes.moved.is_none(), "the film stays the same, so nothing is previewed");
        }
        press(&context, false);
        follow(&mut changes, &context, &document, false);
        document.stop.seconds = Some(9.0);
        follow(&mut changes, &context, &document, false);
        // A visit to another picture is no step.
        let visited = Document { stop: Stop::at_samples(5), ..document.clone() };
        follow(&mut changes, &context, &visited, true);
        follow(&mut changes, &context, &document, false);
        for expected in [Some(8.0), None] {
            changes.undo(&mut document);
            follow(&mut changes, &context, &document, false);
            assert_eq!(document.stop.seconds, expected);
        }
        assert!(changes.earlier(&document).is_none());
    }
}
