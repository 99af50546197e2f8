//! The denoised picture of the film on the screen. It is made in the background when the film has twice the samples of the
//! one before, and at the end of a render or a pause.

use super::answers::Answers;
use super::kept::{FilmId, Subject};
use crate::denoise::{Denoised, Halves, denoise};
use crate::progressive::Phase;
use eframe::egui::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Fewer samples per pixel are not worth denoising.
const LEAST_SAMPLES: u64 = 4;

/// Filtering may take one in so many parts of the time, because it takes processors from the tracer.
const SHARE: u32 = 25;

/// A denoised picture of a film, or why there is none.
pub type Found = (FilmId, Result<Arc<Denoised>, String>);

#[derive(Default)]
pub struct Denoising {
    /// With the time that it took.
    answers: Answers<(Found, Duration)>,
    /// The film that is being denoised, and how to stop that.
    working: Option<(FilmId, Arc<AtomicBool>)>,
    /// The film that was denoised last, and its samples.
    last: Option<(FilmId, u64)>,
    rest_until: Option<Instant>,
}

impl Denoising {
    /// Asks for the film's denoised picture if it is time, and returns what was found since the last call.
    pub fn follow(&mut self, context: &Context, subject: &Subject<'_>, is_on: bool) -> Option<Found> {
        let (film, samples) = (subject.raw_id(), subject.samples());
        if let Some((_, stop)) = self.working.as_ref().filter(|(of, _)| !is_on || *of != film) {
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
                Err(reason) => working.map(|(film, _)| (film, Err(reason))),
            };
        }
        if !is_on {
            self.last = None;
        }
        let known = self.last.filter(|(of, _)| *of == film).map_or(0, |(_, samples)| samples);
        let phase = &subject.status().phase;
        let is_still = subject.is_kept() || phase.is_over() || *phase == Phase::Paused;
        let is_resting = known > 0 && self.rest_until.is_some_and(|until| Instant::now() < until);
        let is_due = if is_still { samples > known } else { samples >= 2 * known && !is_resting };
        if is_on && is_due && samples >= LEAST_SAMPLES && subject.has_samples() && self.working.is_none() {
            let stop = Arc::new(AtomicBool::new(false));
            (self.working, self.last) = (Some((film, Arc::clone(&stop))), Some((film, samples)));
            let answer = self.answers.promise(context);
            subject.inspect(move |film_sums| {
                let (begin, halves) = (Instant::now(), Halves::of(film_sums));
                answer.give_from("denoise", move || {
                    let outcome = halves.map_err(|reason| reason.to_string());
                    let outcome = outcome.and_then(|halves| denoise(halves, &stop).ok_or_else(String::new));
                    Ok(((film, outcome.map(Arc::new)), begin.elapsed()))
                });
            });
        }
        found
    }
}
