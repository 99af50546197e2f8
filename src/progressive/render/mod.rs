//! The current render: its film, its backends and its status.

mod backends;

pub use backends::{Backend, dismiss, guarded};

use super::shared::{Picture, Shared};
use super::{
    EndReason, Factory, HistoryPoint, NOISE_TARGET_FIRST_SAMPLES, NoiseOf, PassSizer, Phase, Plan, Status,
    View,
};
use crate::backends::{BackendChoice, Pending};
use crate::denoise;
use crate::film::{Film, HALVES, PixelSum, SampleRanges};
use crate::job::render::{Control, Outcome, RenderError, RenderJob, Renderer, Stats};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Estimating the error may take at most one in this many parts of the time.
const ERROR_ESTIMATE_SHARE: u32 = 20;

/// Flags that end a long call of a renderer early, set by the handle. They are two because a [`Control`] lends a renderer
/// each alone: while it prepares and in the first pass, a stop cancels; later it must not.
#[derive(Default)]
pub struct Cancel {
    /// Ends a pass, which spoils the film.
    pub pass: AtomicBool,
    /// Ends preparing and the first pass, which can begin again, and passes that are quicker to undo than to finish.
    pub stop: AtomicBool,
}

impl Cancel {
    /// Ends all work for good.
    pub fn abandon(&self) {
        self.pass.store(true, Ordering::SeqCst);
        self.stop.store(true, Ordering::SeqCst);
    }

    fn is_abandoned(&self) -> bool {
        self.pass.load(Ordering::SeqCst)
    }

    /// Withdraws a request to stop that has been obeyed. It cannot erase an abandonment, which sets `pass` first: either
    /// it sets `stop` later than this, or this sees it.
    fn clear_stop(&self) {
        self.stop.store(false, Ordering::SeqCst);
        if self.is_abandoned() {
            self.stop.store(true, Ordering::SeqCst);
        }
    }
}

pub(super) struct Render {
    job: RenderJob,
    plan: Plan,
    pub film: Film,
    /// The film's samples, and those that the renderer has not added yet.
    requested: SampleRanges,
    cancel: Arc<Cancel>,
    choice: BackendChoice,
    failed: Vec<BackendChoice>,
    is_prepared: bool,
    pending: Option<Pending>,
    sizer: PassSizer,
    next_history_samples: u64,
    estimated_samples: u64,
    estimated_at: Instant,
    estimate_took: Duration,
    /// Samples in the last picture; `None` if the next request should resolve one even for the same film.
    pub pictured_samples: Option<u64>,
    pub status: Status,
}

impl Render {
    pub fn new(
        run: u64,
        job: RenderJob,
        choice: BackendChoice,
        plan: Plan,
        film: Film,
        cancel: Arc<Cancel>,
    ) -> Self {
        let (smallest, first) = plan.preview.map_or((HALVES, HALVES), |samples| (1, samples));
        let mut render = Render {
            sizer: PassSizer::new(smallest, first),
            next_history_samples: (film.sample_count() + 1).next_power_of_two(),
            estimated_samples: 0,
            estimated_at: Instant::now(),
            estimate_took: Duration::ZERO,
            pictured_samples: None,
            is_prepared: false,
            pending: None,
            status: Status { run, phase: Phase::Preparing, ..Status::default() },
            job,
            plan,
            requested: film.samples().clone(),
            film,
            cancel,
            choice,
            failed: Vec::new(),
        };
        render.status.planned_samples_per_pixel = render.planned_count();
        render.note_film();
        render
    }

    pub fn is_working(&self) -> bool {
        self.status.phase.is_working()
    }

    /// Changes when the render ends. A finished render continues if the new plan has work left.
    pub fn set_plan(&mut self, plan: Plan) {
        self.plan = plan;
        self.status.planned_samples_per_pixel = self.planned_count();
        if matches!(self.status.phase, Phase::Done(_)) {
            self.resume();
        }
    }

    /// Samples per pixel that the film will hold at the end.
    fn planned_count(&self) -> u64 {
        let mut samples = self.film.samples().clone();
        while let Some(gap) = samples.first_gap(self.plan.range(), u64::MAX) {
            // A gap never overlaps existing samples.
            if samples.insert(gap).is_err() {
                break;
            }
        }
        samples.count()
    }

    pub fn pause(&mut self) {
        if self.is_working() {
            self.status.phase = Phase::Paused;
        }
    }

    pub fn resume(&mut self) {
        self.status.phase = if self.is_prepared { Phase::Tracing } else { Phase::Preparing };
    }

    /// Obeys a stop. On resuming, whatever the stop ended begins again.
    pub fn stop(&mut self) {
        self.cancel.clear_stop();
        if !self.status.phase.is_over() {
            self.end(EndReason::Stopped);
        }
    }

    fn end(&mut self, reason: EndReason) {
        self.estimate_error();
        self.status.say(self.status.doubt.clone());
        log::info!("the render ended ({reason:?}) with {} samples per pixel", self.film.sample_count());
        self.status.phase = Phase::Done(reason);
    }

    /// Ends the render because no pass is left: all samples are done, or the time is up.
    fn end_of_plan(&mut self) {
        let is_whole = self.requested.first_gap(self.plan.range(), 1).is_none();
        self.end(if is_whole { EndReason::Samples } else { EndReason::TimeLimit });
    }

    /// Prepares the job if necessary; otherwise renders a pass.
    pub fn step(
        &mut self,
        backend: &mut Option<Backend>,
        factory: &Mutex<Factory>,
        is_picture_wanted: bool,
    ) -> Result<(), RenderError> {
        self.take_over(backend);
        let begin = Instant::now();
        let outcome = match backend {
            Some((_, renderer)) if self.is_prepared => self.pass(renderer.as_mut(), is_picture_wanted),
            _ => self.prepare(backend, factory),
        };
        self.status.elapsed += begin.elapsed();
        outcome
    }

    /// Runs `look`, which does not affect the film, and reports its panic.
    pub fn watched(&mut self, what: &'static str, look: impl FnOnce(&mut Self)) {
        let outcome = guarded(what, || {
            look(self);
            Ok(())
        });
        self.status.say(outcome.err().map(|error| error.to_string()));
    }

    /// The next samples; `None` if none are missing or no time is left for them.
    fn next_pass(&self) -> Option<Range<u64>> {
        let time_left = match self.plan.stop.time_limit() {
            // A picture without samples is of no use.
            Some(limit) if self.requested.count() > 0 => Some(limit.saturating_sub(self.status.elapsed)),
            _ => None,
        };
        self.sizer.next(&self.requested, self.plan.range(), time_left)
    }

    fn pass(&mut self, renderer: &mut dyn Renderer, is_picture_wanted: bool) -> Result<(), RenderError> {
        if self.meets_noise_target() {
            self.finish_samples(renderer)?;
            // Outstanding samples can show that the estimate was too low.
            self.estimate_error();
            if self.meets_noise_target() {
                self.end(EndReason::NoiseTarget);
                return Ok(());
            }
        }
        if self.sizer.is_new() {
            self.plan_first_pass(renderer)?;
        }
        let Some(mut range) = self.next_pass() else {
            self.finish_samples(renderer)?;
            self.end_of_plan();
            return Ok(());
        };
        let (samples, begin) = (range.clone(), Instant::now());
        let outcome = if self.requested.count() == 0 {
            self.first_pass(renderer, &mut range)
        } else {
            self.add(renderer, |renderer, job, film, cancel| {
                let control = Control { cancel: &cancel.pass, stop: &cancel.stop, may_defer: true };
                renderer.advance(job, samples, film, &control)
            })
        };
        let took = begin.elapsed();
        log::debug!("samples {range:?} in {:.3} ms: {outcome:?}", took.as_secs_f64() * 1e3);
        if outcome? == Outcome::Withdrawn {
            return Ok(());
        }
        self.sizer.measured(
            range.end - range.start,
            took,
            self.plan.later_pass_target(renderer.diagnostics().stops_early),
        );
        self.requested.insert(range)?;
        // A renderer can change during use (lose an adapter or give up threads), which it reports here.
        self.status.backend = Some(renderer.info());
        self.status.say(renderer.take_messages());
        if is_picture_wanted && self.film.sample_count() == 0 {
            // The first picture is the most urgent.
            self.finish_samples(renderer)?;
        } else if is_picture_wanted {
            guarded(self.choice.name(), || renderer.request_readback())?;
        }
        Ok(())
    }

    /// A stop should not leave a film without samples, but the first pass can be far longer than predicted, on a busy
    /// machine for instance. So a stop shortens `range` to the fewest samples.
    fn first_pass(
        &mut self,
        renderer: &mut dyn Renderer,
        range: &mut Range<u64>,
    ) -> Result<Outcome, RenderError> {
        let fewest = range.start..range.start + HALVES;
        if range.end > fewest.end {
            let samples = range.clone();
            let outcome = self.add(renderer, |renderer, job, film, cancel| {
                renderer.advance(job, samples, film, &Control::deferring(&cancel.stop))
            });
            if self.cancel.is_abandoned() || !matches!(outcome, Err(RenderError::Cancelled)) {
                return outcome;
            }
            // The cancelled pass has spoiled them.
            self.film.halves_mut().iter_mut().for_each(|sums| sums.fill(PixelSum::default()));
            range.clone_from(&fewest);
        }
        self.add(renderer, |renderer, job, film, cancel| {
            renderer.advance(job, range.clone(), film, &Control::deferring(&cancel.pass))
        })
    }

    /// Makes the first pass as long as the others in a batch render whose renderer can predict its time.
    fn plan_first_pass(&mut self, renderer: &mut dyn Renderer) -> Result<(), RenderError> {
        let Some(target) = self.plan.first_pass_target() else { return Ok(()) };
        let gap = self.requested.first_gap(self.plan.range(), u64::MAX);
        let wanted = gap.map_or(0, |gap| gap.end - gap.start);
        if wanted <= HALVES {
            return Ok(());
        }
        let begin = Instant::now();
        // A quick estimate suffices if all samples fit even at a quarter of its speed.
        for (one_in, caution) in [(128, 4.0), (16, 1.0)] {
            let estimate =
                guarded(self.choice.name(), || Ok(renderer.estimate_sample_time(one_in, &self.cancel.pass)));
            let Some(per_sample) = estimate? else { break };
            log::debug!("estimated from one pixel in {one_in}: {per_sample:?} or less for a sample");
            self.sizer.estimated(per_sample, target);
            if caution * wanted as f64 * per_sample.as_secs_f64() <= target.as_secs_f64() {
                break;
            }
        }
        self.status.trace += begin.elapsed();
        Ok(())
    }

    /// Adds the renderer's deferred samples to the film.
    pub fn finish_samples(&mut self, renderer: &mut dyn Renderer) -> Result<(), RenderError> {
        if self.requested != *self.film.samples() {
            self.add(renderer, |renderer, _, film, _| renderer.finish(film).map(Outcome::Added))?;
        }
        if self.requested != *self.film.samples() {
            let reason = format!(
                "it was asked for {} samples per pixel, but the film holds {}",
                self.requested.count(),
                self.film.sample_count()
            );
            return Err(RenderError::Backend { backend: self.choice.name(), reason });
        }
        Ok(())
    }

    /// Lets the renderer add samples to the film, and records who added how many in what time. Even a call that fails can
    /// have added deferred samples.
    fn add(
        &mut self,
        renderer: &mut dyn Renderer,
        work: impl FnOnce(&mut dyn Renderer, &RenderJob, &mut Film, &Cancel) -> Result<Outcome, RenderError>,
    ) -> Result<Outcome, RenderError> {
        let begin = Instant::now();
        let held = self.film.sample_count();
        let outcome = guarded(self.choice.name(), || work(renderer, &self.job, &mut self.film, &self.cancel));
        // Before the samples are recorded, because the history includes the seconds of their tracing.
        self.status.trace += begin.elapsed();
        let added = self.film.sample_count().saturating_sub(held);
        if added > 0 {
            let stats = outcome.as_ref().map_or(Stats::default(), |outcome| outcome.stats());
            self.status.stats.add(&stats);
            self.status.credit(&renderer.info(), added);
            self.note_film();
        }
        outcome
    }

    /// Resolves a picture if one was requested and there is something new to show.
    pub fn show(&mut self, shared: &Shared, view: &View) {
        let samples = self.film.sample_count();
        let is_new = self.pictured_samples != Some(samples);
        if !is_new || samples == 0 || !shared.is_picture_wanted() || self.cancel.is_abandoned() {
            return;
        }
        self.pictured_samples = Some(samples);
        let transfer = self.job.rules().transfer;
        // Previews are smoothed; heat maps show the film as it is.
        let is_smooth = self.plan.preview.is_some() && matches!(view, View::Picture | View::Exposed(_));
        let rgb8 = if is_smooth {
            view.resolve(&self.film.smoothed(), transfer)
        } else {
            view.resolve(&self.film, transfer)
        };
        let (width, height) = (self.film.width(), self.film.height());
        shared.put_picture(Picture { run: self.status.run, width, height, samples_per_pixel: samples, rgb8 });
    }

    /// Updates the status from the film.
    fn note_film(&mut self) {
        let samples = self.film.sample_count();
        self.status.samples_per_pixel = samples;
        self.status.rejected_samples = self.film.rejected();
        let is_history = samples >= self.next_history_samples;
        if is_history || self.estimated_at.elapsed() >= self.estimate_took * ERROR_ESTIMATE_SHARE {
            self.estimate_error();
        }
        if is_history {
            self.next_history_samples = (samples + 1).next_power_of_two();
            self.note_history();
        }
    }

    /// Adds the newest error to the history.
    fn note_history(&mut self) {
        let samples = self.film.sample_count();
        let is_known = self.status.history.last().is_some_and(|last| last.samples_per_pixel == samples);
        if let Some(error) = self.status.error.filter(|_| !is_known) {
            self.status.history.push(HistoryPoint {
                backend: self.status.backend.as_ref().map_or("", |backend| backend.name),
                samples_per_pixel: samples,
                trace_seconds: self.status.trace.as_secs_f64(),
                rmse_estimate: error.rmse,
                rel_mse_estimate: error.rel_mse,
            });
        }
    }

    /// Whether the picture that the film gives, denoised or not, meets the noise target by its latest estimate. While the
    /// film's own error is doubtful, so is that of the denoised picture.
    fn meets_noise_target(&self) -> bool {
        let Some(target) = self.plan.stop.noise else { return false };
        let film_meets = || self.film.meets(target, self.status.error.as_ref(), self.brightest());
        self.film.sample_count() >= NOISE_TARGET_FIRST_SAMPLES
            && match self.status.denoised {
                Some(denoised) => denoised.meets(target) && (self.status.doubt.is_none() || film_meets()),
                None => film_meets(),
            }
    }

    /// The largest radiance that a sample can have.
    fn brightest(&self) -> f64 {
        self.job.rules().brightest(self.job.scene())
    }

    fn estimate_error(&mut self) {
        if self.plan.preview.is_none() && self.estimated_samples != self.film.sample_count() {
            let begin = Instant::now();
            self.status.error = self.film.error();
            if self.plan.stop.noise_of == NoiseOf::Denoised && self.plan.stop.noise.is_some() {
                self.status.denoised = denoise::of_film(&self.film).ok().map(|denoised| denoised.error);
            }
            self.status.doubt = self.status.error.as_ref().and_then(|error| self.film.doubt(error));
            self.estimated_samples = self.film.sample_count();
            self.estimate_took = begin.elapsed();
            self.estimated_at = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obeyed_stop_does_not_erase_an_abandonment() {
        for _ in 0..2000 {
            let cancel = Cancel::default();
            cancel.stop.store(true, Ordering::Relaxed);
            std::thread::scope(|scope| {
                scope.spawn(|| cancel.abandon());
                cancel.clear_stop();
            });
            assert!(cancel.is_abandoned() && cancel.stop.load(Ordering::Relaxed));
        }
        let stopped = Cancel::default();
        stopped.stop.store(true, Ordering::Relaxed);
        stopped.clear_stop();
        assert!(!stopped.stop.load(Ordering::Relaxed));
    }
}
