//! Keeps pictures, and goes on from them. What is kept is in the model.

use super::{KeptPicture, Verdict, run};
use crate::app::answers::Answers;
use crate::app::dock::Cards;
use crate::app::model::{Document, Kept};
use crate::app::tracer::Tracer;
use crate::film::Film;
use eframe::egui::Context;
use std::sync::Arc;

/// A kept picture to go on from: a copy of its film, and the tracing time of its samples, if known.
pub struct Reopened {
    pub document: Document,
    pub film: Film,
    pub seconds: Option<f64>,
}

#[derive(Default)]
pub struct KeptActions {
    /// The pictures of the kept films that are shown.
    pub picture: KeptPicture,
    pub cards: Cards,
    pub verdict: Verdict,
    pub copied: Answers<Result<Kept, String>>,
    pub reopened: Answers<Result<Reopened, String>>,
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
        let answer = self.copied.answer_or(context, Err);
        main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give(copy.map(|film| Kept::new(document, film, status, seconds_before)));
        });
    }

    /// Copies a kept film to go on from it. The answer arrives in `reopened`.
    pub fn reopen(&self, context: &Context, kept: &Arc<Kept>) {
        let (kept, answer) = (Arc::clone(kept), self.reopened.answer_or(context, Err));
        run(move || {
            let seconds = kept.seconds_before.map(|before| before + kept.status.trace.as_secs_f64());
            let copy = kept.film.try_copy().map_err(|error| error.to_string());
            answer.give(copy.map(|film| Reopened { document: kept.document.clone(), film, seconds }));
        });
    }
}
