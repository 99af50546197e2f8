//! The picture of a kept film.

use super::thread::KeptThread;
use crate::app::answers::Answers;
use crate::app::model::kept::Kept;
use crate::app::texture::Texture;
use crate::app::tracer::Shown;
use crate::progressive::View;
use eframe::egui::Context;
use std::sync::{Arc, Weak};

/// Pictures that stay when another one is shown, so that a flip between two does not flicker.
const HELD: usize = 2;

/// A picture that was resolved.
struct Held {
    /// [`Kept::number`].
    number: u64,
    view: View,
    shown: Shown,
}

/// A resolved picture: the kept one, the view, three bytes per pixel.
type Resolved = (Weak<Kept>, View, Vec<u8>);

/// The picture of a kept film, which a thread resolves.
#[derive(Default)]
pub struct KeptPicture {
    thread: KeptThread,
    /// The newest first.
    held: Vec<Held>,
    /// Can be upgraded as long as a picture is being resolved.
    waiting: Weak<()>,
    answers: Answers<Resolved>,
}

impl KeptPicture {
    /// The newest picture of `kept`.
    pub fn shown(&self, kept: &Kept) -> Option<&Shown> {
        self.held.iter().find(|held| held.number == kept.number()).map(|held| &held.shown)
    }

    /// The newest picture of `kept`.
    pub fn shown_mut(&mut self, kept: &Kept) -> Option<&mut Shown> {
        self.held.iter_mut().find(|held| held.number == kept.number()).map(|held| &mut held.shown)
    }

    /// Has `work` done on the thread that resolves the pictures.
    pub fn run(&self, work: impl FnOnce() + Send + 'static) {
        self.thread.run(work);
    }

    /// Takes the picture that was resolved, and has the film resolved in `view` if that is another one.
    pub fn follow(&mut self, context: &Context, kept: &Arc<Kept>, view: &View) {
        while let Some((of, view, rgb8)) = self.answers.take() {
            if let Some(of) = of.upgrade() {
                self.hold(&of, view, &rgb8);
            }
        }
        let place = self.held.iter().position(|held| held.number == kept.number());
        if let Some(place) = place {
            self.held[..=place].rotate_right(1);
        }
        let is_known = place.is_some() && self.held[0].view.is_same(view);
        if is_known || self.waiting.strong_count() > 0 {
            return;
        }
        let question = Arc::new(());
        self.waiting = Arc::downgrade(&question);
        let (kept, view, answer) = (Arc::clone(kept), view.clone(), self.answers.answer(context));
        self.thread.run(move || {
            let rgb8 = view.resolve(&kept.film, kept.document.rules().transfer, None);
            // Dropped first: the answer wakes a frame, which may ask for the next picture.
            drop(question);
            answer.give((Arc::downgrade(&kept), view, rgb8));
        });
    }

    fn hold(&mut self, kept: &Kept, view: View, rgb8: &[u8]) {
        let place = self.held.iter().position(|held| held.number == kept.number());
        let earlier = place.map(|place| self.held.remove(place).shown.texture);
        let texture = Texture::new(kept.size(), rgb8, earlier);
        let shown = Shown { texture, samples: kept.samples(), divisor: 1, document: kept.document.clone() };
        self.held.insert(0, Held { number: kept.number(), view, shown });
        self.held.truncate(HELD);
    }
}
