//! What is on the screen, the traced film or its denoised picture, and questions about it.

use super::answers::Query;
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

    /// Asks `query` about `key`. `look` finds the answer, if any, in the film or its denoised picture.
    pub fn ask<K: PartialEq, T: Send + 'static>(
        &self,
        context: &Context,
        query: &mut Query<K, T>,
        key: K,
        look: impl FnOnce(&Film) -> Option<T> + Send + 'static,
    ) {
        if let Some(answer) = query.ask(context, key) {
            self.inspect(move |film| look(film).into_iter().for_each(|found| answer.give_one(Ok(found))));
        }
    }
}
