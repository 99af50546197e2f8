//! Keeps pictures. What is kept is in the model.

use super::{KeptPicture, Verdict};
use crate::app::answers::Answers;
use crate::app::dock::Cards;
use crate::app::model::{Document, Kept};
use crate::app::tracer::Tracer;
use eframe::egui::Context;
use std::sync::Arc;

#[derive(Default)]
pub struct KeptActions {
    /// The pictures of the kept films that are shown.
    pub picture: KeptPicture,
    pub cards: Cards,
    pub verdict: Verdict,
    pub copied: Answers<Kept>,
    /// The picture is to be kept as soon as it has samples.
    pub is_wanted: bool,
}

impl KeptActions {
    /// Copies the traced film. The answer arrives in `copied`.
    pub fn copy(
        &mut self,
        context: &Context,
        (document, main): (&Document, &Tracer),
        seconds_before: Option<f64>,
    ) {
        self.is_wanted = false;
        let (document, status) = (document.clone(), Arc::clone(main.status()));
        let answer = self.copied.promise(context);
        main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give(copy.map(|film| Kept::new(document, film, status, seconds_before)));
        });
    }
}
