//! The render thread: it alternates between obeying commands and rendering passes.

use super::render::{Backend, Cancel, Render, dismiss};
use super::shared::Shared;
use super::{Factory, Phase, RenderRequest, Status, View};
use crate::film::Film;
use crate::job::render::RenderError;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError};
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// A request of [`super::Progressive`], carried out between two passes.
pub(super) type Command = Box<dyn FnOnce(&mut Worker) + Send>;

pub(super) struct Worker {
    commands: Receiver<Command>,
    shared: Arc<Shared>,
    factory: Arc<Mutex<Factory>>,
    backend: Option<Backend>,
    render: Option<Render>,
    view: View,
}

impl Worker {
    pub(super) fn new(commands: Receiver<Command>, shared: Arc<Shared>, factory: Factory) -> Self {
        let factory = Arc::new(Mutex::new(factory));
        Worker { commands, shared, factory, backend: None, render: None, view: View::Picture }
    }

    pub(super) fn run(&mut self) {
        loop {
            // No panic can corrupt the film: renderers promise not to touch it, and everything else only reads it.
            match catch_unwind(AssertUnwindSafe(|| self.turn())) {
                Ok(true) => {}
                Ok(false) => return,
                Err(payload) => {
                    self.give_up_backend(&RenderError::of_panic("the render thread", payload.as_ref()));
                }
            }
        }
    }

    /// Obeys a command or renders a pass. Returns whether there is more to do.
    fn turn(&mut self) -> bool {
        let received = if self.render.as_ref().is_some_and(Render::is_working) {
            self.commands.try_recv()
        } else {
            self.commands.recv().map_err(TryRecvError::from)
        };
        match received {
            Ok(command) => command(self),
            Err(TryRecvError::Empty) => self.step(),
            Err(TryRecvError::Disconnected) => return false,
        }
        self.show();
        true
    }

    /// Obeys what has been sent, and renders a pass if `renders`, on the caller's thread.
    pub(super) fn act(&mut self, renders: bool) {
        while let Ok(command) = self.commands.try_recv() {
            command(self);
        }
        if renders && self.render.as_ref().is_some_and(Render::is_working) {
            self.step();
        }
        self.show();
    }

    fn show(&mut self) {
        if let Some(render) = &mut self.render {
            render.watched("the picture", |render| render.show(&self.shared, &self.view));
        }
    }

    /// Changes the render, if there is one.
    pub(super) fn change(&mut self, change: impl FnOnce(&mut Render, &Arc<Mutex<Factory>>)) {
        if let Some(render) = &mut self.render {
            change(render, &self.factory);
            self.shared.publish(&render.status);
        }
    }

    pub(super) fn set_view(&mut self, view: View) {
        self.view = view;
        self.change(|render, _| render.pictured_samples = None);
    }

    pub(super) fn start(&mut self, run: u64, request: RenderRequest, cancel: Arc<Cancel>) {
        // Drop the old film before the new one is made, so that both need not fit into memory.
        self.render = None;
        let RenderRequest { job, backend: choice, renderer, plan, film } = request;
        if let Some(renderer) = renderer {
            self.backend = Some((choice.clone(), renderer));
        }
        let settings = job.settings();
        let new_film = || Film::try_new(settings.width, settings.height);
        match film.map_or_else(new_film, Ok) {
            Ok(film) => {
                let render = Render::new(run, job, choice, plan, film, cancel);
                self.shared.publish(&render.status);
                self.render = Some(render);
            }
            Err(error) => {
                let phase = Phase::Failed(error.to_string());
                self.shared.publish(&Status { run, phase, ..Status::default() });
            }
        }
    }

    /// Adds the renderer's deferred samples, before the film is read or another renderer continues it.
    pub(super) fn finish_samples(&mut self) {
        let (Some(render), Some((_, renderer))) = (&mut self.render, &mut self.backend) else { return };
        let begin = Instant::now();
        let outcome = render.finish_samples(renderer.as_mut());
        render.status.elapsed += begin.elapsed();
        if let Err(error) = outcome {
            self.give_up_backend(&error);
        }
    }

    /// Discards a renderer that failed. It is not used again, even for another job.
    fn give_up_backend(&mut self, error: &RenderError) {
        dismiss(self.backend.take());
        if let Some(render) = &mut self.render {
            render.fail(error);
            self.shared.publish(&render.status);
        }
    }

    pub(super) fn take(&mut self) -> Option<(Film, Status)> {
        self.finish_samples();
        let Render { film, status, .. } = self.render.take()?;
        if !status.phase.is_over() {
            self.shared.publish(&Status { phase: Phase::Idle, ..status.clone() });
        }
        Some((film, status))
    }

    pub(super) fn abandon(&mut self) {
        if let Some(render) = self.render.take() {
            self.shared.publish(&Status { phase: Phase::Idle, ..render.status });
        }
    }

    fn step(&mut self) {
        let Some(render) = &mut self.render else { return };
        match render.step(&mut self.backend, &self.factory, self.shared.is_picture_wanted()) {
            Ok(()) => self.shared.publish(&render.status),
            Err(RenderError::Cancelled) => self.abandon(),
            Err(error) => self.give_up_backend(&error),
        }
    }
}
