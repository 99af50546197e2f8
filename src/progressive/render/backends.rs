//! The backends of a render: preparing one, switching to another, and falling back after a failure.

use super::{Cancel, Render};
use crate::backends::{BackendChoice, close};
use crate::job::render::{RenderError, RenderJob, Renderer};
use crate::progressive::{Factory, Phase};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
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

fn make(factory: &Mutex<Factory>, choice: &BackendChoice) -> Result<Box<dyn Renderer>, RenderError> {
    let made = factory.lock().unwrap_or_else(PoisonError::into_inner)(choice);
    made.map_err(|error| RenderError::Backend { backend: choice.name(), reason: error.to_string() })
}

/// A prepared renderer and the time it took to prepare.
type Prepared = Result<(Box<dyn Renderer>, Duration), RenderError>;

/// A backend that is prepared on its own thread and takes over when it is ready, while the old one continues.
pub(super) struct Pending {
    choice: BackendChoice,
    /// Delivers one result.
    outcome: Receiver<Prepared>,
}

impl Pending {
    /// Starts to prepare `job`; `None` if the system cannot start a thread.
    fn start(
        choice: BackendChoice,
        job: &RenderJob,
        factory: &Arc<Mutex<Factory>>,
        cancel: &Arc<Cancel>,
    ) -> Option<Self> {
        let (sender, outcome) = mpsc::channel();
        let (wanted, job) = (choice.clone(), job.clone());
        let (factory, cancel) = (Arc::clone(factory), Arc::clone(cancel));
        let prepare = move || {
            let begin = Instant::now();
            let ready = make(&factory, &wanted).and_then(|mut renderer| {
                renderer.prepare(&job, &cancel.pass)?;
                Ok((renderer, begin.elapsed()))
            });
            // If another backend was chosen meanwhile, there is no receiver.
            let _ = sender.send(ready);
        };
        std::thread::Builder::new().name("prepare".to_owned()).spawn(prepare).ok()?;
        Some(Pending { choice, outcome })
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
            self.pending = Pending::start(choice.clone(), &self.job, factory, &self.cancel);
        }
        if self.pending.is_none() {
            self.change_backend(choice);
        }
    }

    /// Switches to the pending backend once it is ready.
    pub(super) fn take_over(&mut self, backend: &mut Option<Backend>) {
        let Some(pending) = &self.pending else { return };
        let outcome = match pending.outcome.try_recv() {
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => {
                let reason = "its preparation ended by a panic".to_owned();
                Err(RenderError::Backend { backend: pending.choice.name(), reason })
            }
            Ok(outcome) => outcome,
        };
        let choice = pending.choice.clone();
        self.pending = None;
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
