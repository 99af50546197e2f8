//! A progressive render on its own thread: a film that grows pass by pass, while someone watches, pauses,
//! switches the backend or changes the job.
//!
//! Commands go through a channel and are obeyed between passes; what comes back is a small [`Status`] and, when
//! asked for, a [`Picture`]. No call here waits for the renderer, but [`Progressive::wait`],
//! [`Progressive::take_film`], [`Progressive::finish`] and dropping it.

mod guard;
mod passes;
mod pending;
mod plan;
mod render;
mod shared;
mod status;
mod view;
mod worker;

pub use passes::PassSizer;
pub use plan::{EndReason, NOISE_TARGET_FIRST_SAMPLES, Plan, Stop};
pub use shared::Picture;
pub use status::{Contribution, HistoryPoint, Phase, Status};
pub use view::{Reference, View, standard_error};

use crate::backends::{self, BackendChoice, BackendError};
use crate::film::Film;
use crate::render::{RenderJob, Renderer};
use shared::Shared;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use worker::{Command, Worker};

/// Makes renderers, on the render thread or, while another renders, beside it.
pub type Factory = Box<dyn FnMut(&BackendChoice) -> Result<Box<dyn Renderer>, BackendError> + Send>;

/// Something to render.
pub struct Work {
    /// The picture.
    pub job: RenderJob,
    /// Who renders it.
    pub backend: BackendChoice,
    /// A renderer of `backend` that is there already; else the render thread makes or reuses one.
    pub renderer: Option<Box<dyn Renderer>>,
    /// When it ends.
    pub plan: Plan,
    /// A film of `job` that goes on; else an empty one.
    pub film: Option<Film>,
}

impl Work {
    /// A render from the beginning.
    pub fn new(job: RenderJob, backend: BackendChoice, plan: Plan) -> Self {
        Work { job, backend, renderer: None, plan, film: None }
    }
}

/// The handle of a render thread.
pub struct Progressive {
    commands: Sender<Command>,
    shared: Arc<Shared>,
    run: u64,
    cancel: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Progressive {
    /// Starts the thread, with nothing to render yet.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn spawn() -> io::Result<Self> {
        Self::with_factory(Box::new(backends::create))
    }

    /// As [`Progressive::spawn`], with renderers from elsewhere.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn with_factory(factory: Factory) -> io::Result<Self> {
        let (commands, receiver) = mpsc::channel();
        let shared = Arc::new(Shared::default());
        let worker = Worker::new(receiver, Arc::clone(&shared), factory);
        let thread = thread::Builder::new().name("render".to_owned()).spawn(move || worker.run())?;
        Ok(Progressive {
            commands,
            shared,
            run: 0,
            cancel: Arc::new(AtomicBool::new(false)),
            thread: Some(thread),
        })
    }

    /// Begins `work`; what was being rendered is thrown away in the middle of its pass.
    pub fn start(&mut self, work: Work) {
        self.cancel.store(true, Ordering::Relaxed);
        self.cancel = Arc::new(AtomicBool::new(false));
        self.run += 1;
        self.shared.publish(&Status { run: self.run, phase: Phase::Preparing, ..Status::default() });
        self.send(Command::Start { run: self.run, work: Box::new(work), cancel: Arc::clone(&self.cancel) });
    }

    /// Throws away what is being rendered.
    pub fn abandon(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
        self.send(Command::Abandon);
    }

    /// Stops at the end of the pass and keeps the backend, film and all.
    pub fn pause(&self) {
        self.send(Command::Pause);
    }

    /// Goes on after a pause or a stop.
    pub fn resume(&self) {
        self.send(Command::Resume);
    }

    /// Ends the render at the end of the pass.
    pub fn stop(&self) {
        self.send(Command::Stop);
    }

    /// Lets another backend go on with the same film. If it cannot be had, the old one goes on.
    pub fn switch_backend(&self, backend: BackendChoice) {
        self.send(Command::Switch(backend));
    }

    /// Changes when the render ends. One that had ended goes on if there is something left to do.
    pub fn set_plan(&self, plan: Plan) {
        self.send(Command::SetPlan(plan));
    }

    /// The numbers as of the last pass.
    pub fn status(&self) -> Status {
        self.shared.status()
    }

    /// The newest picture, if there has been one since the last call. Asks for the next: see
    /// [`Progressive::ask_for_picture`].
    pub fn take_picture(&self) -> Option<Picture> {
        let picture = self.newest_picture();
        self.ask_for_picture();
        picture
    }

    /// The newest picture, if there has been one since the last call.
    pub fn newest_picture(&self) -> Option<Picture> {
        self.shared.take_picture()
    }

    /// Asks for one picture, which is resolved on the render thread as soon as there is something new to see: a
    /// picture that nobody asks for costs nothing.
    pub fn ask_for_picture(&self) {
        if self.shared.want_picture() {
            self.send(Command::Look);
        }
    }

    /// What pictures show from now on.
    pub fn set_view(&self, view: View) {
        self.send(Command::SetView(view));
    }

    /// Calls `notice` on the render thread when a picture is there or the phase has changed. It must be quick.
    pub fn set_notice(&self, notice: impl Fn() + Send + 'static) {
        self.shared.set_notice(Box::new(notice));
    }

    /// Runs `look` on the render thread with the film as of a pass's end; without a film it is dropped.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        self.send(Command::Inspect(Box::new(look)));
    }

    /// Waits until the status changes, at most `timeout`, and returns it.
    pub fn wait(&self, timeout: Duration) -> Status {
        self.shared.wait(timeout)
    }

    /// Waits until the render is over.
    pub fn wait_until_over(&self) -> Status {
        loop {
            let status = self.wait(Duration::from_millis(200));
            if status.phase.is_over() || status.phase == Phase::Idle {
                return status;
            }
        }
    }

    /// Ends the render after its pass and hands out the film; `None` if there is none.
    pub fn take_film(&self) -> Option<Film> {
        let (sender, receiver) = mpsc::channel();
        self.send(Command::Take(sender));
        receiver.recv().ok().flatten()
    }

    /// As [`Progressive::take_film`], and ends the thread.
    pub fn finish(self) -> Option<Film> {
        self.take_film()
    }

    /// A thread that has died has said so in the status, so that nothing is lost by not sending.
    fn send(&self, command: Command) {
        let _ = self.commands.send(command);
    }
}

impl Drop for Progressive {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            self.cancel.store(true, Ordering::Relaxed);
            self.send(Command::Finish);
            let _ = thread.join();
        }
    }
}
