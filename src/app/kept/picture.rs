//! The pictures of kept films.

use super::run;
use crate::app::answers::Answers;
use crate::app::model::Kept;
use crate::app::texture::Texture;
use crate::app::tracer::Shown;
use crate::progressive::View;
use eframe::egui::Context;
use std::sync::{Arc, Weak};

struct Held {
    of: Weak<Kept>,
    view: View,
    shown: Shown,
}

/// The kept picture, the view, and three bytes per pixel.
type Resolved = (Arc<Kept>, View, Vec<u8>);

/// The pictures of kept films that were shown. They stay, so that a flip between two doesn't flicker.
#[derive(Default)]
pub struct KeptPicture {
    held: Vec<Held>,
    answers: Answers<Resolved>,
}

impl KeptPicture {
    /// The newest picture of `kept`.
    pub fn shown(&self, kept: &Kept) -> Option<&Shown> {
        self.held.iter().find(|held| held.of.as_ptr() == std::ptr::from_ref(kept)).map(|held| &held.shown)
    }

    /// The newest picture of `kept`.
    pub fn shown_mut(&mut self, kept: &Kept) -> Option<&mut Shown> {
        let held = self.held.iter_mut().find(|held| held.of.as_ptr() == std::ptr::from_ref(kept));
        held.map(|held| &mut held.shown)
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
