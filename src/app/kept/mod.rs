//! Kept films: their pictures, the question whether one differs from the traced picture by noise alone, and the film on
//! the screen, which is the traced one or a kept one. What is kept is in the model.

mod subject;
#[cfg(test)]
pub mod tests;
mod verdict;

pub use subject::{FilmId, Query, Subject};
pub use verdict::Verdict;

use super::answers::{Answers, caught};
use super::model::{Document, Kept};
use super::texture::Texture;
use super::tracer::Shown;
use super::tracing::Tracing;
use crate::progressive::View;
use eframe::egui::Context;
use std::sync::mpsc::{SendError, Sender, channel};
use std::sync::{Arc, LazyLock, Weak};

type Work = Box<dyn FnOnce() + Send>;

/// Does work on a kept film, which may take longer than a frame, after the work that was asked for before.
pub fn run(work: impl FnOnce() + Send + 'static) {
    static WORKER: LazyLock<Sender<Work>> = LazyLock::new(|| {
        let (sender, receiver) = channel::<Work>();
        // Whoever asked learns of a panic from the answer that never came.
        let work = move || receiver.iter().for_each(|work| _ = caught(work));
        // Without a thread, sending fails.
        let _ = std::thread::Builder::new().name("kept".to_owned()).spawn(work);
        sender
    });
    if let Err(SendError(work)) = WORKER.send(Box::new(work)) {
        let _ = caught(work);
    }
}

#[derive(Default)]
pub struct KeptActions {
    /// The pictures of the kept films that are shown.
    pub picture: KeptPicture,
    pub verdict: Verdict,
    pub copied: Answers<Kept>,
    /// The picture is to be kept as soon as it has samples.
    pub is_wanted: bool,
}

impl KeptActions {
    /// Copies the traced film if that was asked for and it has samples. The answer arrives in `copied`.
    pub fn follow(&mut self, context: &Context, document: &Document, tracing: &Tracing) {
        let Tracing { main, seconds_before, .. } = tracing;
        if !self.is_wanted || !main.has_samples(document) {
            return;
        }
        self.is_wanted = false;
        let (document, status, seconds_before) =
            (document.clone(), Arc::clone(main.status()), *seconds_before);
        let answer = self.copied.promise(context);
        main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give(copy.map(|film| Kept::new(document, film, status, seconds_before)));
        });
    }
}

struct Held {
    of: Weak<Kept>,
    view: View,
    shown: Shown,
}

/// The pictures of kept films that were shown. They stay, so that a flip between two doesn't flicker.
#[derive(Default)]
pub struct KeptPicture {
    held: Vec<Held>,
    /// The kept picture, the view, and three bytes per pixel.
    answers: Answers<(Arc<Kept>, View, Vec<u8>)>,
}

impl KeptPicture {
    /// The newest picture of `kept`.
    pub fn shown(&self, kept: &Kept) -> Option<&Shown> {
        self.held.iter().find(|held| held.of.as_ptr() == std::ptr::from_ref(kept)).map(|held| &held.shown)
    }

    /// Takes the picture that was resolved, and has the film resolved in `view` if that is another one.
    pub fn follow(&mut self, context: &Context, kept: &Arc<Kept>, view: &View) {
        while let Some(Ok((of, view, rgb8))) = self.answers.take() {
            self.hold(&of, view, &rgb8);
        }
        self.held.retain(|held| held.of.strong_count() > 0);
        let is_known = |held: &Held| held.of.as_ptr() == Arc::as_ptr(kept) && held.view.is_same(view);
        if self.answers.is_open() || self.held.iter().any(is_known) {
            return;
        }
        let answer = self.answers.answer(context);
        let (kept, view) = (Arc::clone(kept), view.clone());
        run(move || {
            let rgb8 = view.resolve(&kept.film, kept.document.rules().transfer, None);
            answer.give(Ok((kept, view, rgb8)));
        });
    }

    fn hold(&mut self, kept: &Arc<Kept>, view: View, rgb8: &[u8]) {
        let of = Arc::downgrade(kept);
        let place = self.held.iter().position(|held| held.of.ptr_eq(&of));
        let earlier = place.map(|place| self.held.swap_remove(place).shown.texture);
        let texture = Texture::new(kept.size(), rgb8, earlier);
        let (document, run) = (kept.document.clone(), kept.status.run);
        let shown = Shown { texture, samples: kept.samples(), divisor: 1, document, run };
        self.held.push(Held { of, view, shown });
    }
}
