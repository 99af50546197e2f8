//! Whether the film is identical to the film that it is compared with.

use super::answers::Answers;
use super::model::show::Show;
use super::model::view::ViewState;
use super::tracer::Tracer;
use crate::progressive::ReferenceMeans;
use eframe::egui::Context;
use std::sync::Arc;

/// The comparison of the film with a loaded one.
#[derive(Default)]
pub struct Identity {
    /// The loaded film, and the film's samples per pixel when it was last compared.
    compared: Option<(Arc<ReferenceMeans>, u64)>,
    is_same: bool,
    answers: Answers<bool>,
}

impl Identity {
    /// Whether the film and the loaded one are the same to the bit, as far as is known.
    pub fn is_same(&self) -> bool {
        self.is_same
    }

    /// Compares the films again after each change, while their difference is shown.
    pub fn follow(&mut self, view: &ViewState, main: &Tracer, context: &Context) {
        let is_shown = view.mode().is_none() && view.show() == Show::Difference;
        let Some(loaded) = view.reference.as_ref().filter(|_| is_shown) else {
            *self = Identity::default();
            return;
        };
        while let Some(is_same) = self.answers.take() {
            self.is_same = is_same;
        }
        let samples = main.shown().map_or(0, |shown| shown.samples);
        let is_known =
            |(film, count): &(Arc<ReferenceMeans>, u64)| Arc::ptr_eq(film, loaded) && *count == samples;
        if self.compared.as_ref().is_some_and(is_known) {
            return;
        }
        (self.compared, self.is_same) = (Some((Arc::clone(loaded), samples)), false);
        let (identity, answer) = (loaded.identity, self.answers.answer(context));
        main.inspect(move |film| answer.give(identity.is_some_and(|identity| identity.is_of(film))));
    }
}
