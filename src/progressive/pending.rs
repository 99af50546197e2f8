//! A pending backend, which is prepared on its own thread while the old one continues to render.

use super::Factory;
use super::cancel::Cancel;
use crate::backends::BackendChoice;
use crate::render::{RenderJob, Renderer};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A backend that will take over when it is ready.
pub(super) struct Pending {
    pub choice: BackendChoice,
    /// Delivers exactly one result.
    pub outcome: Receiver<Result<Ready, String>>,
}

/// A renderer that has prepared the job, and the time this took.
pub(super) struct Ready {
    pub renderer: Box<dyn Renderer>,
    pub took: Duration,
}

impl Pending {
    /// Starts to prepare `job`; `None` if the system cannot start a thread.
    pub fn start(
        choice: BackendChoice,
        job: &RenderJob,
        factory: &Arc<Mutex<Factory>>,
        cancel: &Arc<Cancel>,
    ) -> Option<Self> {
        let (sender, outcome) = mpsc::channel();
        let (wanted, job, factory) = (choice.clone(), job.clone(), Arc::clone(factory));
        let cancel = Arc::clone(cancel);
        let prepare = move || {
            let begin = Instant::now();
            let made = factory.lock().unwrap_or_else(PoisonError::into_inner)(&wanted);
            let ready = made.map_err(|error| error.to_string()).and_then(|mut renderer| {
                renderer.prepare(&job, &cancel.pass).map_err(|error| error.to_string())?;
                Ok(Ready { renderer, took: begin.elapsed() })
            });
            // If another backend was chosen meanwhile, nobody receives this.
            let _ = sender.send(ready);
        };
        std::thread::Builder::new().name("prepare".to_owned()).spawn(prepare).ok()?;
        Some(Pending { choice, outcome })
    }
}
