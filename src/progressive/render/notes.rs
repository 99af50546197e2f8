//! What the status says about the film: counts, contributions, the error estimate and its history.

use super::Render;
use crate::progressive::HistoryPoint;
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

    pub(super) fn estimate_error(&mut self) {
        if self.estimated_samples != self.film.sample_count() {
            let begin = Instant::now();
            self.status.error = self.film.error();
            let brightest = self.job.rules().brightest(self.job.scene());
            self.status.doubt = self.film.doubt(self.status.error.as_ref(), brightest);
            self.estimated_samples = self.film.sample_count();
            self.estimate_took = begin.elapsed();
            self.estimated_at = Instant::now();
        }
    }
}
