//! The backends of a render: preparing one, switching to another, and falling back after a failure.

use super::Render;
use crate::backends::{BackendChoice, Factory, Pending, close, make};
use crate::job::render::{RenderError, Renderer};
use crate::progressive::Phase;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A renderer and the choice it was made from.
pub type Backend = (BackendChoice, Box<dyn Renderer>);

/// Runs `work`, turning a panic into an error of `backend`. The film is then unchanged, as renderers promise.
pub fn guarded<T>(
    backend: &'static str,
    work: impl FnOnce() -> Result<T, RenderError>,
) -> Result<T, RenderError> {
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|payload| Err(RenderError::of_panic(backend, payload.as_ref())))
}

/// Closes a backend that is no longer used.
pub fn dismiss(backend: Option<Backend>) {
    if backend.is_some() {
        close(backend);
    }
}

impl Render {
    /// Switches to another backend once it is ready. Until then the current one continues.
    pub fn switch(&mut self, choice: BackendChoice, factory: &Arc<Mutex<Factory>>) {
        if self.pending.as_ref().is_some_and(|pending| pending.choice == choice) {
            return;
        }
        self.pending = None;
        if choice != self.choice && self.is_prepared {
            let (job, cancel) = (self.job.clone(), Arc::clone(&self.cancel));
            let prepare = move |renderer: &mut dyn Renderer| renderer.prepare(&job, &cancel.pass);
            self.pending = Pending::start(choice.clone(), factory, prepare);
        }
        if self.pending.is_none() {
            self.change_backend(choice);
        }
    }

    /// Switches to the pending backend once it is ready.
    pub(super) fn take_over(&mut self, backend: &mut Option<Backend>) {
        let Some(outcome) = self.pending.as_ref().and_then(Pending::outcome) else { return };
        let Some(Pending { choice, .. }) = self.pending.take() else { return };
        match outcome {
            Ok((mut renderer, took)) => {
                if let Some((_, old)) = backend
                    && let Err(error) = self.finish_samples(old.as_mut())
                {
                    self.status.say([error.to_string()]);
                    self.requested = self.film.samples().clone();
                }
                // Where the curve of the old one ends.
                self.estimate_error();
                self.note_history();
                self.note_prepared(renderer.as_mut(), took);
                self.choice = choice.clone();
                dismiss(backend.replace((choice, renderer)));
                self.sizer.restart();
            }
            Err(error) => {
                self.status.given_up.push(choice.name());
                self.status.say([format!("{error}; the {} continues", self.choice.name())]);
            }
        }
    }

    fn change_backend(&mut self, choice: BackendChoice) {
        self.pending = None;
        if choice != self.choice {
            self.choice = choice;
            self.is_prepared = false;
            self.sizer.restart();
            if self.is_working() {
                self.status.phase = Phase::Preparing;
            }
        }
    }

    /// Continues the film with the next backend that has not failed, or ends the render if there is none.
    pub fn fail(&mut self, error: &RenderError) {
        if matches!(error, RenderError::FilmLost { .. }) {
            self.film = self.job.new_film();
            (self.status.contributions, self.status.history) = Default::default();
            (self.status.stats, self.next_history_samples) = Default::default();
            self.note_film();
        }
        // Samples that were not in the film are lost, and rendered again.
        self.requested = self.film.samples().clone();
        self.failed.push(self.choice.clone());
        self.status.given_up.push(self.choice.name());
        log::error!("{} failed: {error}", self.choice.name());
        match BackendChoice::fallback(&self.failed) {
            Some(fallback) => {
                self.status.say([format!("{error}; {} continues the same picture", fallback.words())]);
                self.change_backend(fallback);
            }
            None => self.status.phase = Phase::Failed(error.to_string()),
        }
    }

    /// Makes the backend if necessary and has it prepare the job.
    pub(super) fn prepare(
        &mut self,
        backend: &mut Option<Backend>,
        factory: &Mutex<Factory>,
    ) -> Result<(), RenderError> {
        // A complete film needs no renderer.
        if self.next_pass().is_none() {
            self.end_of_plan();
            return Ok(());
        }
        let begin = Instant::now();
        if backend.as_ref().is_none_or(|(choice, _)| *choice != self.choice) {
            match (guarded(self.choice.name(), || make(factory, &self.choice)), &backend) {
                (Ok(renderer), _) => dismiss(backend.replace((self.choice.clone(), renderer))),
                (Err(error), Some((old, _))) => {
                    self.status.say([format!("{error}; the {} continues", old.name())]);
                    self.choice = old.clone();
                }
                (Err(error), None) => return Err(error),
            }
        }
        let Some((_, renderer)) = backend else { return Ok(()) };
        match guarded(self.choice.name(), || renderer.prepare(&self.job, &self.cancel.stop)) {
            // The command to stop comes next.
            Err(RenderError::Cancelled) if !self.cancel.is_abandoned() => return Ok(()),
            outcome => outcome?,
        }
        self.note_prepared(renderer.as_mut(), begin.elapsed());
        self.is_prepared = true;
        self.status.phase = Phase::Tracing;
        Ok(())
    }

    fn note_prepared(&mut self, renderer: &mut dyn Renderer, took: Duration) {
        let info = renderer.info();
        let kernel = renderer.diagnostics().kernel;
        (self.status.kernel, self.status.left_out) = (kernel.about, kernel.left_out);
        self.status.hierarchy += kernel.hierarchy_time;
        self.status.prepare += took;
        self.status.say(renderer.take_messages());
        log::info!("prepared {info:?} in {:.3} s; kernel: {}", took.as_secs_f64(), self.status.kernel);
        self.status.backend = Some(info);
    }
}
