//! What is on the screen, the traced film or its denoised picture, and questions about it.

use super::answers::Answers;
use super::model::{Document, ViewState};
use super::tracing::Tracing;
use crate::denoise::Denoised;
use crate::film::Film;
use eframe::egui::Context;
use std::sync::Arc;

/// Tells pictures apart: the run of the render, and the samples of the denoised picture.
pub type PictureId = (u64, Option<u64>);

/// The traced film, or its denoised picture.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    pub document: &'a Document,
    pub tracing: &'a Tracing,
    pub denoised: Option<&'a Arc<Denoised>>,
}

impl<'a> Subject<'a> {
    pub fn new(view: &'a ViewState, document: &'a Document, tracing: &'a Tracing) -> Self {
        Subject { document, tracing, denoised: view.denoised_of(tracing.main.status().run) }
    }

    pub fn id(&self) -> PictureId {
        (self.tracing.main.status().run, self.denoised.map(|denoised| denoised.film.sample_count()))
    }

    /// Samples per pixel of the film.
    pub fn samples(&self) -> u64 {
        self.tracing.main.status().samples_per_pixel
    }

    /// Whether it is the film of its document at full size, and has samples.
    pub fn has_samples(&self) -> bool {
        self.tracing.main.has_samples(self.document)
    }

    /// Runs `look` with the film or its denoised picture on another thread.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        match self.denoised.map(Arc::clone) {
            Some(denoised) => self.tracing.main.inspect(move |_| look(&denoised.film)),
            None => self.tracing.main.inspect(look),
        }
    }
}

/// A question about what is on the screen, which is asked again when `K` has changed, one at a time.
pub struct Query<K, T> {
    asked: Option<K>,
    answers: Answers<T>,
}

impl<K, T> Default for Query<K, T> {
    fn default() -> Self {
        Query { asked: None, answers: Answers::default() }
    }
}

impl<K: PartialEq, T: Send + 'static> Query<K, T> {
    /// Takes the newest answer.
    pub fn take(&mut self) -> Option<T> {
        std::iter::from_fn(|| self.answers.take()).last().and_then(Result::ok)
    }

    /// Asks about `key`, unless that was asked last, or the question before is open. `look` finds the answer, if any, in the
    /// film.
    pub fn ask(
        &mut self,
        context: &Context,
        subject: &Subject<'_>,
        key: K,
        look: impl FnOnce(&Film) -> Option<T> + Send + 'static,
    ) {
        if !self.answers.is_open() && self.asked.as_ref() != Some(&key) {
            self.asked = Some(key);
            let answer = self.answers.answer(context);
            subject.inspect(move |film| look(film).into_iter().for_each(|found| answer.give_one(Ok(found))));
        }
    }
}
