//! A progressive render on its own thread. The film grows pass by pass while the user watches, pauses, switches the
//! backend or changes the job.
//!
//! Commands are sent through a channel and obeyed between passes. The thread publishes a small [`Status`] and, on
//! request, a [`Picture`]. Only [`Progressive::wait`], [`Progressive::take_film`] and dropping the handle
//! wait for the renderer; no other call blocks.

pub mod describe;

mod passes;
mod plan;
mod render;
mod shared;
mod status;
mod view;
mod worker;

pub use crate::backends::Factory;
pub use passes::PassSizer;
pub use plan::{EndReason, NOISE_TARGET_FIRST_SAMPLES, NoiseOf, Plan, Stop};
pub use shared::Picture;
pub use status::{Contribution, HistoryPoint, Phase, Status};
pub use view::{ReferenceMeans, View};

use crate::backends::{self, BackendChoice};
use crate::film::Film;
use crate::job::render::{RenderJob, Renderer};
use crate::system::threads;
use render::{Cancel, Render};
use shared::Shared;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use worker::{Command, Worker};

/// A render to start.
pub struct RenderRequest {
    pub job: RenderJob,
    pub backend: BackendChoice,
    /// An existing renderer of `backend`; otherwise the render thread makes or reuses one.
    pub renderer: Option<Box<dyn Renderer>>,
    /// Which samples to render, and when to stop.
    pub plan: Plan,
    /// A film of `job` to continue; otherwise the render starts with an empty film.
    pub film: Option<Film>,
}

impl RenderRequest {
    pub fn new(job: RenderJob, backend: BackendChoice, plan: Plan) -> Self {
        RenderRequest { job, backend, renderer: None, plan, film: None }
    }
}

/// The handle of a render thread.
pub struct Progressive {
    commands: Sender<Command>,
    shared: Arc<Shared>,
    run: u64,
    cancel: Arc<Cancel>,
    thread: Option<JoinHandle<()>>,
    /// The worker without a thread of its own: it obeys at once, and whoever waits renders a pass.
    here: Option<Mutex<Worker>>,
}

impl Progressive {
    /// Starts the thread, which then waits for work.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn spawn() -> io::Result<Self> {
        Self::with_factory(Box::new(backends::create))
    }

    /// Like [`Progressive::spawn`], with renderers made by `factory`.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn with_factory(factory: Factory) -> io::Result<Self> {
        Self::with_worker(factory, threads::EXIST)
    }

    fn with_worker(factory: Factory, has_thread: bool) -> io::Result<Self> {
        let (commands, receiver) = mpsc::channel();
        let shared = Arc::new(Shared::default());
        let readers = Arc::clone(&shared);
        let mut worker = Worker::new(receiver, Arc::clone(&shared), factory);
        let (mut thread, mut here) = (None, None);
        if has_thread {
            let work = move || {
                if catch_unwind(AssertUnwindSafe(|| worker.run())).is_err() {
                    readers.died();
                }
            };
            thread = Some(thread::Builder::new().name("render".to_owned()).spawn(work)?);
        } else {
            here = Some(Mutex::new(worker));
        }
        Ok(Progressive { commands, shared, run: 0, cancel: Arc::default(), thread, here })
    }

    /// Starts a render. One in progress is abandoned in the middle of its pass.
    pub fn start(&mut self, request: RenderRequest) {
        self.cancel.abandon();
        self.cancel = Arc::default();
        self.run += 1;
        self.shared.publish(&Status { run: self.run, phase: Phase::Preparing, ..Status::default() });
        let (run, cancel) = (self.run, Arc::clone(&self.cancel));
        self.send(move |worker| worker.start(run, request, cancel));
    }

    /// Starts a render and returns its last status when it is over. `look` sees every status, at least one per
    /// [`Progressive::LOOK`], and may send commands.
    pub fn watch(&mut self, request: RenderRequest, look: impl FnMut(&Progressive, &Status)) -> Status {
        self.start(request);
        self.until_over(look)
    }

    /// Waits until the render is over.
    pub fn wait_until_over(&self) -> Status {
        self.until_over(|_, _| ())
    }

    fn until_over(&self, mut look: impl FnMut(&Progressive, &Status)) -> Status {
        loop {
            let status = self.wait(Progressive::LOOK);
            look(self, &status);
            if status.phase.is_over() || status.phase == Phase::Idle {
                return status;
            }
        }
    }

    /// Longest time between two calls of `look` in [`Progressive::watch`].
    pub const LOOK: Duration = Duration::from_millis(50);

    pub fn abandon(&mut self) {
        self.cancel.abandon();
        self.send(Worker::abandon);
    }

    /// Pauses at the end of the pass. The backend and the film are kept.
    pub fn pause(&self) {
        self.change(|render, _| render.pause());
    }

    /// Continues after a pause or a stop.
    pub fn resume(&self) {
        self.change(|render, _| {
            if matches!(render.status.phase, Phase::Paused | Phase::Done(EndReason::Stopped)) {
                render.resume();
            }
        });
    }

    /// Ends the render at the end of the pass, or during preparation.
    pub fn stop(&self) {
        self.cancel.stop.store(true, Ordering::Relaxed);
        self.change(|render, _| render.stop());
    }

    /// Continues the same film with another backend. If that backend is not available, the old one continues.
    pub fn switch_backend(&self, backend: BackendChoice) {
        self.change(|render, factory| render.switch(backend, factory));
    }

    /// Changes when the render ends. A finished render continues if the new plan has work left.
    pub fn set_plan(&self, plan: Plan) {
        self.send(|worker| worker.change(|render, _| render.set_plan(plan)));
    }

    /// The status after the last pass.
    pub fn status(&self) -> Status {
        self.shared.status()
    }

    /// Takes the newest picture, if there is a new one since the last call.
    pub fn newest_picture(&self) -> Option<Picture> {
        self.shared.take_picture()
    }

    /// Requests one picture. The render thread resolves it once there is something new to see, and resolves none
    /// without a request.
    pub fn ask_for_picture(&self) {
        if self.shared.want_picture() {
            // Wakes the thread.
            self.send(|_| ());
        }
    }

    /// Sets what later pictures show.
    pub fn set_view(&self, view: View) {
        self.send(|worker| worker.set_view(view));
    }

    /// Sets a callback that the render thread calls when a picture is ready or the phase has changed. It must be quick.
    pub fn set_notice(&self, notice: impl Fn() + Send + 'static) {
        self.shared.set_notice(Box::new(notice));
    }

    /// Runs `look` with the film on the render thread, at the end of a pass. Without a film, `look` is dropped.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        self.change(|render, _| render.watched("inspecting the film", |render| look(&render.film)));
    }

    /// Waits until the status changes, at most `timeout`, and returns it.
    pub fn wait(&self, timeout: Duration) -> Status {
        if self.act_here(true) { self.status() } else { self.shared.wait(timeout) }
    }

    /// Ends the render after the current pass and returns the film; `None` if there is no film.
    pub fn take_film(&self) -> Option<Film> {
        let (sender, receiver) = mpsc::channel();
        self.take(move |film, _| _ = sender.send(film));
        receiver.recv().ok()
    }

    /// Ends the render at the end of its pass. `take` gets its film and status, on the render thread; without a film, it is
    /// dropped. The next render begins after that, and does not cancel the pass.
    pub fn hand_over(&mut self, take: impl FnOnce(Film, Status) + Send + 'static) {
        std::mem::take(&mut self.cancel).stop.store(true, Ordering::Relaxed);
        self.take(take);
    }

    fn take(&self, take: impl FnOnce(Film, Status) + Send + 'static) {
        self.send(|worker| {
            if let Some((film, status)) = worker.take() {
                take(film, status);
            }
        });
    }

    /// Changes the render, once the samples that its renderer has deferred are in the film.
    fn change(&self, change: impl FnOnce(&mut Render, &Arc<Mutex<Factory>>) + Send + 'static) {
        self.send(|worker| {
            worker.finish_samples();
            worker.change(change);
        });
    }

    /// Sends a command. A dead thread has reported its end in the status, so a failed send can be ignored.
    fn send(&self, command: impl FnOnce(&mut Worker) + Send + 'static) {
        let _ = self.commands.send(Box::new(command));
        self.act_here(false);
    }

    /// Lets the worker act if it has no thread of its own. Returns whether it did.
    fn act_here(&self, renders: bool) -> bool {
        let worker = self.here.as_ref().map(|worker| worker.lock().unwrap_or_else(PoisonError::into_inner));
        worker.map(|mut worker| worker.act(renders)).is_some()
    }
}

impl Drop for Progressive {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            self.cancel.abandon();
            // Without a sender, the thread ends.
            self.commands = mpsc::channel().0;
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_render_without_a_thread_gives_the_same_film() {
        let job = crate::job::render::tests::sized("three-spheres", [12, 7]);
        let backend = BackendChoice::Reference { threads: Some(1) };
        let render = |has_thread: bool, stops: bool| {
            let plan = Plan::samples(64);
            let request = RenderRequest::new(job.clone(), backend.clone(), plan);
            let mut progressive = Progressive::with_worker(Box::new(backends::create), has_thread).unwrap();
            let status = progressive.watch(request, |progressive, status| {
                if stops && status.samples_per_pixel > 0 {
                    progressive.stop();
                }
            });
            (status.phase, progressive.take_film().unwrap())
        };
        let done = Phase::Done(EndReason::Samples);
        let (phase, film) = render(false, false);
        assert_eq!(phase, done);
        assert_eq!(render(true, false), (done, film));
        let (phase, film) = render(false, true);
        assert_eq!(phase, Phase::Done(EndReason::Stopped));
        assert!((1..64).contains(&film.sample_count()));
    }
}
