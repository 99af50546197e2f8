//! The current render: its film, its backends and its status.

mod backends;
mod notes;

use super::cancel::Cancel;
use super::guard::{Backend, guarded};
use super::pending::Pending;
use super::shared::{Picture, Shared};
use super::{EndReason, Factory, PassSizer, Phase, Plan, Status, View};
use crate::backends::BackendChoice;
use crate::film::{Film, SampleRanges};
use crate::render::{RenderError, RenderJob, Renderer, TileOccupancy};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The current render.
pub(super) struct Render {
    job: RenderJob,
    plan: Plan,
    film: Film,
    /// The samples of the film, and those that the renderer has not added to it yet.
    requested: SampleRanges,
    cancel: Arc<Cancel>,
    choice: BackendChoice,
    /// The backends that have failed.
    failed: Vec<BackendChoice>,
    is_prepared: bool,
    pending: Option<Pending>,
    sizer: PassSizer,
    next_history_samples: u64,
    estimated_samples: u64,
    estimated_at: Instant,
    estimate_took: Duration,
    pictured_samples: Option<u64>,
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
        let mut render = Render {
            sizer: PassSizer::new(film.halves().len()).begin_with(plan.preview.unwrap_or(1)),
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

    pub fn film(&self) -> &Film {
        &self.film
    }

    pub fn into_film(self) -> (Film, Status) {
        (self.film, self.status)
    }

    /// Makes the next request resolve a picture even if the film has not changed.
    pub fn forget_picture(&mut self) {
        self.pictured_samples = None;
    }

    /// Lets preparing and passes go on if the render is resumed after the stop that is now obeyed.
    pub fn stop_is_obeyed(&self) {
        self.cancel.stop_is_obeyed();
    }

    /// Changes when the render ends. A finished render continues if the new plan has work left.
    pub fn set_plan(&mut self, plan: Plan) {
        self.plan = plan;
        self.status.planned_samples_per_pixel = self.planned_count();
        if matches!(self.status.phase, Phase::Done(_)) {
            self.go_on();
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

    pub fn go_on(&mut self) {
        self.status.phase = if self.is_prepared { Phase::Tracing } else { Phase::Preparing };
    }

    pub fn end(&mut self, reason: EndReason) {
        self.estimate_error();
        self.status.say(self.status.doubt.iter().cloned().collect());
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
        self.welcome_pending(backend);
        let begin = Instant::now();
        let outcome = match backend {
            _ if !self.is_prepared => self.prepare(backend, factory, begin),
            Some((_, renderer)) => self.pass(renderer.as_mut(), is_picture_wanted),
            None => Ok(()),
        };
        self.status.elapsed += begin.elapsed();
        outcome
    }

    /// Reports a problem that does not affect the film.
    pub fn complain(&mut self, error: &RenderError) {
        self.status.say(vec![error.to_string()]);
    }

    /// The next samples; `None` if none are missing or no time is left for them.
    fn next_pass(&self) -> Option<std::ops::Range<u64>> {
        let time_left = match self.plan.stop.time_limit() {
            // A picture without a sample is of no use to anyone.
            Some(limit) if self.requested.count() > 0 => Some(limit.saturating_sub(self.status.elapsed)),
            _ => None,
        };
        self.sizer.next(&self.requested, self.plan.range(), time_left)
    }

    fn pass(&mut self, renderer: &mut dyn Renderer, is_picture_wanted: bool) -> Result<(), RenderError> {
        if self.meets_noise_target() {
            self.collect(renderer)?;
            // The samples that were outstanding can show that the estimate was too low.
            self.estimate_error();
            if self.meets_noise_target() {
                self.end(EndReason::NoiseTarget);
                return Ok(());
            }
        }
        if self.sizer.is_new() {
            self.plan_first_pass(renderer)?;
        }
        let Some(range) = self.next_pass() else {
            self.collect(renderer)?;
            self.end_of_plan();
            return Ok(());
        };
        let begin = Instant::now();
        let added = range.end - range.start;
        let held = self.film.sample_count();
        let outcome = guarded(self.choice.name(), || {
            let (range, film, cancel) = (range.clone(), &mut self.film, &self.cancel);
            if self.requested.count() == 0 {
                // A stop is not to leave a film without a sample.
                renderer.advance(&self.job, range, film, &cancel.pass).map(Some)
            } else {
                renderer.advance_unless(&self.job, range, film, &cancel.pass, &cancel.stop)
            }
        });
        // Measured before the samples are noted, because the history includes the seconds of their tracing.
        let took = begin.elapsed();
        self.status.trace += took;
        if matches!(outcome, Ok(None)) {
            log::debug!(
                "pass of samples {}..{} given up after {:.3} s",
                range.start,
                range.end,
                took.as_secs_f64()
            );
            return Ok(());
        }
        let outcome = outcome.map(Option::unwrap_or_default);
        self.note_added(renderer, held, &outcome);
        log::debug!(
            "pass of samples {}..{} took {:.3} ms; the film holds {}",
            range.start,
            range.end,
            took.as_secs_f64() * 1e3,
            self.film.sample_count()
        );
        outcome?;
        self.requested.insert(range)?;
        self.sizer.measured(added, took, self.plan.later_pass_target(renderer.heeds_stop()));
        // A renderer can change during use (it lost an adapter or gave up threads) and then reports it here.
        self.status.backend = Some(renderer.info());
        self.status.say(renderer.take_messages());
        if is_picture_wanted && self.film.sample_count() == 0 {
            // Users wait most eagerly for the first picture.
            self.collect(renderer)?;
        } else if is_picture_wanted {
            guarded(self.choice.name(), || renderer.fetch())?;
        }
        Ok(())
    }

    /// Makes the first pass as long as the others if nobody waits for it and the renderer can tell how long it will take.
    fn plan_first_pass(&mut self, renderer: &mut dyn Renderer) -> Result<(), RenderError> {
        let Some(target) = self.plan.first_pass_target() else { return Ok(()) };
        let gap = self.requested.first_gap(self.plan.range(), u64::MAX);
        let wanted = gap.map_or(0, |gap| gap.end - gap.start);
        if wanted <= self.film.halves().len() as u64 {
            return Ok(());
        }
        let begin = Instant::now();
        let mut estimate = None;
        // A small part of the picture does if all samples fit, even should the rest take four times as long.
        for (one_in, caution) in [(128, 4.0), (16, 1.0)] {
            let outcome = guarded(self.choice.name(), || {
                Ok(renderer.try_out(&mut self.film, one_in, &self.cancel.pass))
            });
            estimate = outcome?;
            let fits = |per_sample: &Duration| {
                caution * wanted as f64 * per_sample.as_secs_f64() <= target.as_secs_f64()
            };
            if estimate.as_ref().is_none_or(fits) {
                break;
            }
        }
        self.status.trace += begin.elapsed();
        if let Some(per_sample) = estimate {
            log::debug!("a trial: a sample takes {:.3} ms or less", per_sample.as_secs_f64() * 1e3);
            self.sizer.estimated(per_sample, target);
        }
        Ok(())
    }

    /// Adds the renderer's outstanding samples to the film.
    pub fn collect(&mut self, renderer: &mut dyn Renderer) -> Result<(), RenderError> {
        if self.requested != *self.film.samples() {
            let begin = Instant::now();
            let held = self.film.sample_count();
            let outcome = guarded(self.choice.name(), || renderer.collect(&mut self.film));
            self.status.trace += begin.elapsed();
            self.note_added(renderer, held, &outcome);
            outcome?;
        }
        if self.requested != *self.film.samples() {
            let reason = format!(
                "it was to trace {} samples per pixel, but the film holds {}",
                self.requested.count(),
                self.film.sample_count()
            );
            return Err(RenderError::Backend { backend: self.choice.name(), reason });
        }
        Ok(())
    }

    /// Resolves a picture if one was requested and there is something new to show.
    pub fn show(&mut self, shared: &Shared, view: &View, renderer: Option<&dyn Renderer>) {
        let samples = self.film.sample_count();
        let is_new = self.pictured_samples != Some(samples);
        if is_new && samples > 0 && shared.is_picture_wanted() && !self.cancel.is_abandoned() {
            self.pictured_samples = Some(samples);
            let renderer = renderer.filter(|_| *view == View::Occupancy);
            let occupancy = renderer.and_then(Renderer::tile_occupancy);
            shared.put_picture(Picture {
                run: self.status.run,
                width: self.film.width(),
                height: self.film.height(),
                samples_per_pixel: samples,
                rgb8: self.resolve(view, occupancy.as_ref()),
            });
        }
    }

    /// Resolves the film. A preview is smoothed; heat maps show what is there.
    fn resolve(&self, view: &View, occupancy: Option<&TileOccupancy>) -> Vec<u8> {
        let transfer = self.job.rules().transfer;
        match view {
            View::Picture | View::Exposed(_) if self.plan.preview.is_some() => {
                view.resolve(&self.film.smoothed(), transfer, occupancy)
            }
            _ => view.resolve(&self.film, transfer, occupancy),
        }
    }
}
