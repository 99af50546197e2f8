//! A backend that is prepared on a thread of its own, while another renders.

use super::BackendChoice;
use crate::job::render::{RenderError, Renderer};
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Makes renderers, on the render thread or, while another renderer works, on a separate thread.
pub type Factory = Box<dyn FnMut(&BackendChoice) -> anyhow::Result<Box<dyn Renderer>> + Send>;

/// Makes a renderer.
///
/// # Errors
/// [`RenderError::Backend`] if it is not available.
pub fn make(factory: &Mutex<Factory>, choice: &BackendChoice) -> Result<Box<dyn Renderer>, RenderError> {
    let made = factory.lock().unwrap_or_else(PoisonError::into_inner)(choice);
    made.map_err(|error| RenderError::Backend { backend: choice.name(), reason: error.to_string() })
}

/// A prepared renderer and the time it took to prepare.
pub type Prepared = Result<(Box<dyn Renderer>, Duration), RenderError>;

/// A backend that takes over when it is ready, while the old one continues.
pub struct Pending {
    pub choice: BackendChoice,
    /// Delivers one result.
    outcome: Receiver<Prepared>,
}

impl Pending {
    /// Makes a renderer and starts to `prepare` it; `None` if the system cannot start a thread.
    pub fn start(
        choice: BackendChoice,
        factory: &Arc<Mutex<Factory>>,
        prepare: impl FnOnce(&mut dyn Renderer) -> Result<(), RenderError> + Send + 'static,
    ) -> Option<Self> {
        let (sender, outcome) = mpsc::channel();
        let (wanted, factory) = (choice.clone(), Arc::clone(factory));
        let work = move || {
            let begin = Instant::now();
            let ready = make(&factory, &wanted).and_then(|mut renderer| {
                prepare(renderer.as_mut())?;
                Ok((renderer, begin.elapsed()))
            });
            // If another backend was chosen meanwhile, there is no receiver.
            let _ = sender.send(ready);
        };
        std::thread::Builder::new().name("prepare".to_owned()).spawn(work).ok()?;
        Some(Pending { choice, outcome })
    }

    /// The renderer or its failure, once; `None` while it is being prepared.
    pub fn outcome(&self) -> Option<Prepared> {
        match self.outcome.try_recv() {
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                let reason = "its preparation ended by a panic".to_owned();
                Some(Err(RenderError::Backend { backend: self.choice.name(), reason }))
            }
            Ok(outcome) => Some(outcome),
        }
    }
}
