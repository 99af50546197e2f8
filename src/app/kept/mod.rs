//! Pictures that are kept to compare with: taking them, showing them beside the traced one, and the question whether one
//! differs from that by noise alone. The list of them is in the model.

mod verdict;

pub use verdict::Verdict;

use super::answers::Answers;
use super::model::{Document, Kept};
use super::texture::Texture;
use super::tracer::Shown;
use super::tracing::Tracing;
use crate::progressive::View;
use eframe::egui::Context;
use std::sync::Arc;

#[derive(Default)]
pub struct KeptActions {
    pub verdict: Verdict,
    pub copied: Answers<Kept>,
    /// The picture is to be kept as soon as it has samples.
    pub is_wanted: bool,
}

impl KeptActions {
    /// Copies the traced film if that was asked for and it has samples. The answer arrives in `copied`.
    pub fn follow(&mut self, context: &Context, document: &Document, tracing: &Tracing) {
        if !self.is_wanted || !tracing.main.has_samples(document) {
            return;
        }
        self.is_wanted = false;
        let (document, answer) = (document.clone(), self.copied.promise(context));
        let seconds = tracing.seconds();
        tracing.main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give_from("keep", move || copy.map(|film| Kept::new(document, film, seconds)));
        });
    }
}

/// The picture of a kept film, resolved on a thread.
#[derive(Default)]
pub struct KeptPicture {
    resolved: Option<(u64, View, Shown)>,
    /// The kept picture, the view, and three bytes per pixel.
    answers: Answers<(Arc<Kept>, View, Vec<u8>)>,
}

impl KeptPicture {
    /// The newest picture of `kept`.
    pub fn shown(&self, kept: &Kept) -> Option<&Shown> {
        self.resolved.as_ref().filter(|(of, ..)| *of == kept.number).map(|(_, _, shown)| shown)
    }

    /// Takes the picture that was resolved, and has the film resolved in `view` if that is another one.
    pub fn follow(&mut self, context: &Context, kept: &Arc<Kept>, view: &View) {
        while let Some(Ok((of, view, rgb8))) = self.answers.take() {
            let earlier = self.resolved.take().map(|(_, _, shown)| shown.texture);
            let texture = Texture::new(of.size(), &rgb8, earlier);
            let document = of.document.clone();
            let shown = Shown { texture, samples: of.samples(), divisor: 1, document, run: 0 };
            self.resolved = Some((of.number, view, shown));
        }
        let is_known = |(of, in_view, _): &(u64, View, Shown)| *of == kept.number && in_view.is_same(view);
        if self.answers.is_open() || self.resolved.as_ref().is_some_and(is_known) {
            return;
        }
        let (kept, view) = (Arc::clone(kept), view.clone());
        self.answers.ask("kept", context, move || {
            let rgb8 = view.resolve(&kept.film, kept.document.rules().transfer, None);
            Ok((kept, view, rgb8))
        });
    }
}
