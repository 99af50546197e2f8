//! What the status says about the film: counts, contributions, the error estimate and its history.

use super::Render;
use crate::progressive::{HistoryPoint, NOISE_TARGET_FIRST_SAMPLES};
use crate::render::{RenderError, Renderer, Stats};
use std::time::Instant;

/// Estimating the error may take at most one part in this many of the time.
const ERROR_ESTIMATE_SHARE: u32 = 20;

impl Render {
    /// Notes which backends added samples to a film that held `held` samples. Some can have arrived before a failure.
    pub(super) fn note_added(
        &mut self,
        renderer: &dyn Renderer,
        held: u64,
        outcome: &Result<Stats, RenderError>,
    ) {
        let added = self.film.sample_count().saturating_sub(held);
        if added > 0 {
            if let Ok(stats) = outcome {
                self.status.stats.add(stats);
            }
            for (info, samples) in renderer.credits(added) {
                self.status.credit(&info, samples);
            }
            self.note_film();
        }
    }

    /// Updates the status from the film.
    pub(super) fn note_film(&mut self) {
        let samples = self.film.sample_count();
        self.status.samples_per_pixel = samples;
        self.status.rejected_samples = self.film.rejected();
        let is_history = samples >= self.next_history_samples;
        let is_due = self.estimated_at.elapsed() >= self.estimate_took * ERROR_ESTIMATE_SHARE;
        if is_history || is_due {
            self.estimate_error();
        }
        if is_history {
            self.next_history_samples = (samples + 1).next_power_of_two();
            if let Some(error) = self.status.error {
                let backend = self.status.backend.as_ref().map_or("", |backend| backend.name);
                self.status.history.push(HistoryPoint {
                    backend,
                    samples_per_pixel: samples,
                    trace_seconds: self.status.trace.as_secs_f64(),
                    rmse_estimate: error.rmse,
                    rel_mse_estimate: error.rel_mse,
                });
            }
        }
    }

    /// Whether the film meets the noise target, by its latest estimate.
    pub(super) fn meets_noise_target(&self) -> bool {
        let error = self.status.error.as_ref();
        self.film.sample_count() >= NOISE_TARGET_FIRST_SAMPLES
            && self.plan.stop.noise.is_some_and(|target| self.film.meets(target, error, self.brightest()))
    }

    /// The largest radiance that a sample can have.
    fn brightest(&self) -> f64 {
        self.job.rules().brightest(self.job.scene())
    }

    pub(super) fn estimate_error(&mut self) {
        if self.estimated_samples != self.film.sample_count() {
            let begin = Instant::now();
            self.status.error = self.film.error();
            self.status.doubt = self.status.error.as_ref().and_then(|error| self.film.doubt(error));
            self.estimated_samples = self.film.sample_count();
            self.estimate_took = begin.elapsed();
            self.estimated_at = Instant::now();
        }
    }
}
