//! The subject on the screen: the traced film or its denoised picture, which is made in the background when the film has twice
//! the samples of the one before, and at the end of a render or a pause. What is saved or copied has all samples.

use super::Tracing;
use crate::app::model::{Document, Found, Model};
use crate::app::toolkit::Answers;
use crate::denoise::{Denoised, Halves, denoise};
use crate::film::Film;
use crate::progressive::Phase;
use eframe::egui::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Fewer samples per pixel are not worth denoising.
const LEAST_SAMPLES: u64 = 4;

/// Filtering takes at most one part in this many of the time, because it takes processors from the tracer, as long as the
/// picture on the screen has less error than the raw one.
const SHARE: u32 = 25;

/// Tells pictures apart: the run of the render, and the samples of the denoised picture.
pub type PictureId = (u64, Option<u64>);

/// The traced film, or its denoised picture.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    pub model: &'a Model,
    pub tracing: &'a Tracing,
}

impl<'a> Subject<'a> {
    pub fn document(&self) -> &'a Document {
        &self.model.document
    }

    fn denoised(&self) -> Option<&'a Arc<Denoised>> {
        self.model.view.denoised_of(self.tracing.main.status().run)
    }

    pub fn id(&self) -> PictureId {
        (self.tracing.main.status().run, self.denoised().map(|denoised| denoised.film.sample_count()))
    }

    /// Whether it is the film of its document at full size, and has samples.
    pub fn has_samples(&self) -> bool {
        self.tracing.main.has_samples(self.document())
    }

    /// Runs `look` with the film or its denoised picture on another thread.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        match self.denoised().map(Arc::clone) {
            Some(denoised) => self.tracing.main.inspect(move |_| look(&denoised.film)),
            None => self.tracing.main.inspect(look),
        }
    }
}

#[derive(Default)]
pub struct Denoising {
    /// With the time that it took.
    answers: Answers<(Found, Duration)>,
    /// The run whose film is being denoised, and how to stop that.
    working: Option<(u64, Arc<AtomicBool>)>,
    /// The run whose film was denoised last, and its samples.
    last: Option<(u64, u64)>,
    rest_until: Option<Instant>,
}

impl Denoising {
    /// Asks for the film's denoised picture if it is time, and returns what was found since the last call.
    pub fn follow(&mut self, context: &Context, subject: &Subject<'_>) -> Option<Found> {
        let (status, is_on) = (subject.tracing.main.status(), subject.model.view.is_denoised);
        let (run, samples) = (status.run, status.samples_per_pixel);
        if let Some((_, stop)) = self.working.as_ref().filter(|(of, _)| !is_on || *of != run) {
            stop.store(true, Ordering::Relaxed);
        }
        let mut found = None;
        while let Some(outcome) = self.answers.take() {
            let working = self.working.take();
            if let Ok((_, took)) = outcome {
                self.rest_until = Some(Instant::now() + took * SHARE);
            }
            found = match outcome {
                Ok((answer, _)) => Some(answer),
                Err(reason) => working.map(|(run, _)| (run, Err(reason))),
            };
        }
        if !is_on {
            self.last = None;
        }
        let known = self.last.filter(|(of, _)| *of == run).map_or(0, |(_, samples)| samples);
        let is_still = status.phase.is_over() || status.phase == Phase::Paused;
        let is_resting = known > 0 && self.rest_until.is_some_and(|until| Instant::now() < until);
        // As soon as the raw picture is better than the one on the screen, that one has to go.
        let is_outdone = || {
            let errors = status.error.zip(subject.denoised());
            errors.is_some_and(|(raw, denoised)| raw.rmse < denoised.error.rmse())
        };
        let is_due =
            if is_still { samples > known } else { samples >= 2 * known && (!is_resting || is_outdone()) };
        if is_on && is_due && samples >= LEAST_SAMPLES && subject.has_samples() && self.working.is_none() {
            let stop = Arc::new(AtomicBool::new(false));
            (self.working, self.last) = (Some((run, Arc::clone(&stop))), Some((run, samples)));
            let answer = self.answers.promise(context);
            subject.tracing.main.inspect(move |film| {
                let (begin, halves) = (Instant::now(), Halves::of(film));
                answer.give_from("denoise", move || {
                    let outcome = halves.map_err(|reason| reason.to_string());
                    let outcome = outcome.and_then(|halves| denoise(halves, &stop).ok_or_else(String::new));
                    let outcome =
                        outcome.and_then(|found| found.checked().map_err(|reason| reason.to_string()));
                    Ok(((run, outcome.map(Arc::new)), begin.elapsed()))
                });
            });
        }
        found
    }
}
