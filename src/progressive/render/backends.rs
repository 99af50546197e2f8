//! The backends of a render: preparing one, switching to another, and falling back after a failure.

use super::Render;
use crate::backends::BackendChoice;
use crate::progressive::guard::{Backend, dismiss, guarded};
use crate::progressive::pending::Pending;
use crate::progressive::{Factory, Phase};
use crate::render::RenderError;
use std::sync::mpsc::TryRecvError;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

impl Render {
    /// Switches to another backend once it is ready. Until then the current one continues.
    pub fn switch(&mut self, choice: BackendChoice, factory: &Arc<Mutex<Factory>>) {
        if self.pending.as_ref().is_some_and(|pending| pending.choice == choice) {
            return;
        }
        self.pending = None;
        if choice == self.choice {
            return;
        }
        if self.is_prepared {
            self.pending = Pending::start(choice.clone(), &self.job, factory, &self.cancel);
        }
        if self.pending.is_none() {
            self.change_backend(choice);
        }
    }

    /// Hands over to a backend that has become ready.
    pub(super) fn welcome_pending(&mut self, backend: &mut Option<Backend>) {
        let Some(pending) = self.pending.take() else { return };
        let outcome = match pending.outcome.try_recv() {
            Ok(outcome) => outcome,
            Err(TryRecvError::Empty) => {
                self.pending = Some(pending);
                return;
            }
            Err(TryRecvError::Disconnected) => Err("its preparation ended by a panic".to_owned()),
        };
        match outcome {
            Ok(mut ready) => {
                if let Some((_, old)) = backend
                    && let Err(error) = self.collect(old.as_mut())
                {
                    self.status.say(vec![error.to_string()]);
                    self.requested = self.film.samples().clone();
                }
                self.status.backend = Some(ready.renderer.info());
                self.status.say(ready.renderer.take_messages());
                self.status.kernel = ready.renderer.kernel();
                self.status.left_out = ready.renderer.kernel_contents().left_out;
                self.status.hierarchy += ready.renderer.hierarchy_time();
                self.status.prepare += ready.took;
                log::info!("switched from {} to {}", self.choice.name(), pending.choice.name());
                self.choice = pending.choice;
                dismiss(backend.replace((self.choice.clone(), ready.renderer)));
                self.sizer.restart();
            }
            Err(reason) => {
                self.status.given_up.push(pending.choice.name());
                self.status.say(vec![format!("{reason}; the {} continues", self.choice.name())]);
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
            self.note_film();
        }
        // What was not in the film is lost, and is rendered again.
        self.requested = self.film.samples().clone();
        self.failed.push(self.choice.clone());
        self.status.given_up.push(self.choice.name());
        log::error!("{} failed: {error}", self.choice.name());
        match BackendChoice::fallback(&self.failed) {
            Some(fallback) => {
                let name = fallback.words();
                self.status.say(vec![format!("{error}; {name} continues the same picture")]);
                self.change_backend(fallback);
            }
            None => self.status.phase = Phase::Failed(error.to_string()),
        }
    }

    /// Makes the backend if necessary, and has it prepare the job.
    pub(super) fn prepare(
        &mut self,
        backend: &mut Option<Backend>,
        factory: &Mutex<Factory>,
        begin: Instant,
    ) -> Result<(), RenderError> {
        // A complete film needs no renderer.
        if self.next_pass().is_none() {
            self.end_of_plan();
            return Ok(());
        }
        if backend.as_ref().is_none_or(|(choice, _)| *choice != self.choice) {
            let choice = &self.choice;
            let make = || Ok(factory.lock().unwrap_or_else(PoisonError::into_inner)(choice));
            match (guarded(choice.name(), make)?, &backend) {
                (Ok(renderer), _) => dismiss(backend.replace((self.choice.clone(), renderer))),
                (Err(error), Some((old, _))) => {
                    self.status.messages.push(format!("{error}; the {} continues", old.name()));
                    self.choice = old.clone();
                }
                (Err(error), None) => {
                    let (backend, reason) = (self.choice.name(), error.to_string());
                    return Err(RenderError::Backend { backend, reason });
                }
            }
        }
        if let Some((_, renderer)) = backend {
            match guarded(self.choice.name(), || renderer.prepare(&self.job, &self.cancel.stop)) {
                // The command to stop comes next.
                Err(RenderError::Cancelled) if !self.cancel.is_abandoned() => return Ok(()),
                outcome => outcome?,
            }
            self.status.backend = Some(renderer.info());
            self.status.say(renderer.take_messages());
            self.status.kernel = renderer.kernel();
            self.status.left_out = renderer.kernel_contents().left_out;
            self.status.hierarchy += renderer.hierarchy_time();
            self.is_prepared = true;
            self.status.phase = Phase::Tracing;
            self.status.prepare += begin.elapsed();
            let info = renderer.info();
            log::info!(
                "prepared in {:.3} s: {} {}, {} lanes, {} threads; kernel: {}",
                begin.elapsed().as_secs_f64(),
                info.name,
                info.device,
                info.lanes,
                info.threads,
                self.status.kernel
            );
        }
        Ok(())
    }
}
