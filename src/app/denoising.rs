//! The denoised picture of the film on the screen. It is made in the background when the film has twice the samples of the
//! one before, and at the end of a render or a pause.

use super::answers::Answers;
use super::subject::Subject;
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

/// The denoised picture of a run's film, or why there is none.
pub type Found = (u64, Result<Arc<Denoised>, String>);

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
    pub fn follow(&mut self, context: &Context, subject: &Subject<'_>, is_on: bool) -> Option<Found> {
        let status = subject.tracing.main.status();
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
        let is_due = if is_still { samples > known } else { samples >= 2 * known && !is_resting };
        if is_on && is_due && samples >= LEAST_SAMPLES && subject.has_samples() && self.working.is_none() {
            let stop = Arc::new(AtomicBool::new(false));
            (self.working, self.last) = (Some((run, Arc::clone(&stop))), Some((run, samples)));
            let answer = self.answers.promise(context);
            subject.tracing.main.inspect(move |film| {
                let (begin, halves) = (Instant::now(), Halves::of(film));
                answer.give_from("denoise", move || {
                    let outcome = halves.map_err(|reason| reason.to_string());
                    let outcome = outcome.and_then(|halves| denoise(halves, &stop).ok_or_else(String::new));
                    Ok(((run, outcome.map(Arc::new)), begin.elapsed()))
                });
            });
        }
        found
    }
}
