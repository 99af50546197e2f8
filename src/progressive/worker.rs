//! The render thread: obeys commands, then renders a pass, and so on.

use super::shared::{Picture, Shared};
use super::{Factory, PassSizer, Phase, Plan, Status, View, Work};
use crate::backends::BackendChoice;
use crate::film::{Film, SampleRanges};
use crate::progressive::{EndReason, HistoryPoint};
use crate::render::{RenderError, RenderJob, Renderer, Stats};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

pub(super) enum Command {
    Start { run: u64, work: Box<Work>, cancel: Arc<AtomicBool> },
    Abandon,
    Pause,
    Resume,
    Stop,
    Switch(BackendChoice),
    SetPlan(Plan),
    Inspect(Box<dyn FnOnce(&Film) + Send>),
    Look,
    SetView(View),
    Take(Sender<Option<Film>>),
    Finish,
}

/// Estimating the error may take at most one part in this of the time.
const ERROR_ESTIMATE_SHARE: u32 = 20;

pub(super) struct Worker {
    commands: Receiver<Command>,
    shared: Arc<Shared>,
    factory: Arc<Mutex<Factory>>,
    backend: Option<(BackendChoice, Box<dyn Renderer>)>,
    render: Option<Render>,
    view: View,
}

/// The render at hand.
struct Render {
    job: RenderJob,
    plan: Plan,
    film: Film,
    /// The samples of the film, and those that the renderer has not added to it yet.
    dealt: SampleRanges,
    cancel: Arc<AtomicBool>,
    choice: BackendChoice,
    is_prepared: bool,
    upcoming: Option<Upcoming>,
    sizer: PassSizer,
    next_history_samples: u64,
    estimated_samples: u64,
    estimated_at: Instant,
    estimate_took: Duration,
    pictured_samples: Option<u64>,
    status: Status,
}

/// A backend that gets ready on a thread of its own while the old one renders on.
struct Upcoming {
    choice: BackendChoice,
    outcome: Receiver<Result<Ready, String>>,
}

/// A renderer that has prepared the job, and what that took.
struct Ready {
    renderer: Box<dyn Renderer>,
    took: Duration,
}

impl Upcoming {
    /// Starts to prepare `job`; `None` if the system gives no thread.
    fn start(
        choice: BackendChoice,
        job: &RenderJob,
        factory: &Arc<Mutex<Factory>>,
        cancel: &Arc<AtomicBool>,
    ) -> Option<Self> {
        let (sender, outcome) = mpsc::channel();
        let (wanted, job, factory) = (choice.clone(), job.clone(), Arc::clone(factory));
        let cancel = Arc::clone(cancel);
        let prepare = move || {
            let begin = Instant::now();
            let made = factory.lock().unwrap_or_else(PoisonError::into_inner)(&wanted);
            let ready = made.map_err(|error| error.to_string()).and_then(|mut renderer| {
                renderer.prepare(&job, &cancel).map_err(|error| error.to_string())?;
                Ok(Ready { renderer, took: begin.elapsed() })
            });
            // Nobody waits any more if another backend was chosen meanwhile.
            let _ = sender.send(ready);
        };
        std::thread::Builder::new().name("prepare".to_owned()).spawn(prepare).ok()?;
        Some(Upcoming { choice, outcome })
    }
}

/// Tells the readers if the thread ends by a panic.
struct DeathNote(Arc<Shared>);

impl Drop for DeathNote {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.died();
        }
    }
}

impl Worker {
    pub(super) fn new(commands: Receiver<Command>, shared: Arc<Shared>, factory: Factory) -> Self {
        Worker {
            commands,
            shared,
            factory: Arc::new(Mutex::new(factory)),
            backend: None,
            render: None,
            view: View::Picture,
        }
    }

    pub(super) fn run(mut self) {
        let _note = DeathNote(Arc::clone(&self.shared));
        loop {
            let is_working = self.render.as_ref().is_some_and(Render::is_working);
            let command = if is_working {
                match self.commands.try_recv() {
                    Ok(command) => Some(command),
                    Err(TryRecvError::Empty) => None,
                    Err(TryRecvError::Disconnected) => Some(Command::Finish),
                }
            } else {
                Some(self.commands.recv().unwrap_or(Command::Finish))
            };
            match command {
                Some(Command::Finish) => return,
                Some(Command::Take(taker)) => {
                    // A taker who has gone away does not want it.
                    let _ = taker.send(self.take_film());
                    continue;
                }
                Some(command) => self.obey(command),
                None => self.step(),
            }
            if let Some(render) = &mut self.render {
                let renderer = self.backend.as_ref().map(|(_, renderer)| renderer.as_ref());
                render.show(&self.shared, &self.view, renderer);
            }
        }
    }

    fn obey(&mut self, command: Command) {
        if let Command::Start { run, work, cancel } = command {
            self.start(run, *work, cancel);
            return;
        }
        if let Command::SetView(view) = command {
            self.view = view;
            if let Some(render) = &mut self.render {
                render.pictured_samples = None;
            }
            return;
        }
        if !matches!(command, Command::Abandon | Command::Look | Command::SetPlan(_)) {
            self.collect();
        }
        let Some(render) = &mut self.render else { return };
        let is_stopped = render.status.phase == Phase::Done(EndReason::Stopped);
        match command {
            Command::Abandon => {
                self.abandon();
                return;
            }
            Command::Pause if render.is_working() => render.status.phase = Phase::Paused,
            Command::Resume if is_stopped || render.status.phase == Phase::Paused => render.go_on(),
            Command::Stop if !render.status.phase.is_over() => render.end(EndReason::Stopped),
            Command::Switch(choice) => render.switch(choice, &self.factory),
            Command::SetPlan(plan) => {
                render.plan = plan;
                render.status.planned_samples_per_pixel = render.planned_count();
                if matches!(render.status.phase, Phase::Done(_)) {
                    render.go_on();
                }
            }
            Command::Inspect(look) => look(&render.film),
            _ => {}
        }
        self.shared.publish(&render.status);
    }

    fn start(&mut self, run: u64, work: Work, cancel: Arc<AtomicBool>) {
        // The old film goes before the new one comes, so that both need not fit into memory.
        self.render = None;
        let Work { job, backend: choice, renderer, plan, film } = work;
        if let Some(renderer) = renderer {
            self.backend = Some((choice.clone(), renderer));
        }
        let settings = job.settings();
        let new_film = || Film::try_new(settings.width, settings.height, settings.half_count());
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

    /// Brings the film up to date: it is about to be looked at, or someone else goes on with it.
    fn collect(&mut self) {
        let (Some(render), Some((_, renderer))) = (&mut self.render, &mut self.backend) else { return };
        let begin = Instant::now();
        let outcome = render.collect(renderer.as_mut());
        render.status.elapsed += begin.elapsed();
        if let Err(error) = outcome {
            self.give_up_backend(&error);
        }
    }

    /// A renderer that failed is not asked again, not even for another job.
    fn give_up_backend(&mut self, error: &RenderError) {
        self.backend = None;
        if let Some(render) = &mut self.render {
            render.fail(&error.to_string());
            self.shared.publish(&render.status);
        }
    }

    fn take_film(&mut self) -> Option<Film> {
        self.collect();
        let Render { film, status, .. } = self.render.take()?;
        if !status.phase.is_over() {
            self.shared.publish(&Status { phase: Phase::Idle, ..status });
        }
        Some(film)
    }

    fn abandon(&mut self) {
        if let Some(render) = self.render.take() {
            self.shared.publish(&Status { phase: Phase::Idle, ..render.status });
        }
    }

    /// Prepares if need be, else renders a pass.
    fn step(&mut self) {
        let Some(render) = &mut self.render else { return };
        render.welcome_upcoming(&mut self.backend);
        let begin = Instant::now();
        let outcome = if render.is_prepared {
            match &mut self.backend {
                Some((_, renderer)) => render.pass(renderer.as_mut(), self.shared.is_picture_wanted(), begin),
                None => Ok(()),
            }
        } else {
            render.prepare(&mut self.backend, &self.factory, begin)
        };
        render.status.elapsed += begin.elapsed();
        match outcome {
            Ok(()) => self.shared.publish(&render.status),
            Err(RenderError::Cancelled) => self.abandon(),
            Err(error) => self.give_up_backend(&error),
        }
    }
}

impl Render {
    fn new(
        run: u64,
        job: RenderJob,
        choice: BackendChoice,
        plan: Plan,
        film: Film,
        cancel: Arc<AtomicBool>,
    ) -> Self {
        let mut render = Render {
            sizer: PassSizer::new(film.halves().len()),
            next_history_samples: (film.sample_count() + 1).next_power_of_two(),
            estimated_samples: 0,
            estimated_at: Instant::now(),
            estimate_took: Duration::ZERO,
            pictured_samples: None,
            is_prepared: false,
            upcoming: None,
            status: Status { run, phase: Phase::Preparing, ..Status::default() },
            job,
            plan,
            dealt: film.samples().clone(),
            film,
            cancel,
            choice,
        };
        render.status.planned_samples_per_pixel = render.planned_count();
        render.note_film();
        render
    }

    fn is_working(&self) -> bool {
        matches!(self.status.phase, Phase::Preparing | Phase::Tracing)
    }

    fn planned_count(&self) -> u64 {
        let mut samples = self.film.samples().clone();
        while let Some(gap) = samples.first_gap(self.plan.samples.clone(), u64::MAX) {
            // A gap does not overlap what is there.
            if samples.insert(gap).is_err() {
                break;
            }
        }
        samples.count()
    }

    fn go_on(&mut self) {
        self.status.phase = if self.is_prepared { Phase::Tracing } else { Phase::Preparing };
    }

    fn end(&mut self, reason: EndReason) {
        self.estimate_error();
        self.status.phase = Phase::Done(reason);
    }

    /// Ends because no pass is left: all samples are there, or the time is over.
    fn end_of_plan(&mut self) {
        let is_whole = self.dealt.first_gap(self.plan.samples.clone(), 1).is_none();
        self.end(if is_whole { EndReason::Samples } else { EndReason::TimeLimit });
    }

    /// Lets another backend take over once it is ready; until then the present one goes on.
    fn switch(&mut self, choice: BackendChoice, factory: &Arc<Mutex<Factory>>) {
        if self.upcoming.as_ref().is_some_and(|upcoming| upcoming.choice == choice) {
            return;
        }
        self.upcoming = None;
        if choice == self.choice {
            return;
        }
        if self.is_prepared {
            self.upcoming = Upcoming::start(choice.clone(), &self.job, factory, &self.cancel);
        }
        if self.upcoming.is_none() {
            self.change_backend(choice);
        }
    }

    /// Hands over to a backend that has become ready.
    fn welcome_upcoming(&mut self, backend: &mut Option<(BackendChoice, Box<dyn Renderer>)>) {
        let Some(upcoming) = self.upcoming.take() else { return };
        let outcome = match upcoming.outcome.try_recv() {
            Ok(outcome) => outcome,
            Err(TryRecvError::Empty) => {
                self.upcoming = Some(upcoming);
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
                    self.dealt = self.film.samples().clone();
                }
                self.status.backend = Some(ready.renderer.info());
                self.status.say(ready.renderer.take_messages());
                self.status.kernel = ready.renderer.kernel();
                self.status.hierarchy += ready.renderer.hierarchy_time();
                self.status.prepare += ready.took;
                self.choice = upcoming.choice;
                *backend = Some((self.choice.clone(), ready.renderer));
                self.sizer.restart();
            }
            Err(reason) => {
                self.status.say(vec![format!("{reason}; the {} goes on", self.choice.name())]);
            }
        }
    }

    fn change_backend(&mut self, choice: BackendChoice) {
        self.upcoming = None;
        if choice != self.choice {
            self.choice = choice;
            self.is_prepared = false;
            self.sizer.restart();
            if self.is_working() {
                self.status.phase = Phase::Preparing;
            }
        }
    }

    /// Lets the fallback go on with the film, or gives up if that was the one that failed.
    fn fail(&mut self, reason: &str) {
        // What was not in the film is lost, and is rendered again.
        self.dealt = self.film.samples().clone();
        let fallback = BackendChoice::fallback();
        if self.choice == fallback {
            self.status.phase = Phase::Failed(reason.to_owned());
        } else {
            self.status.messages.push(format!("{reason}; the CPU goes on with the same picture"));
            self.change_backend(fallback);
        }
    }

    fn prepare(
        &mut self,
        backend: &mut Option<(BackendChoice, Box<dyn Renderer>)>,
        factory: &Mutex<Factory>,
        begin: Instant,
    ) -> Result<(), RenderError> {
        // A film with everything in it needs no renderer.
        if self.next_pass().is_none() {
            self.end_of_plan();
            return Ok(());
        }
        if backend.as_ref().is_none_or(|(choice, _)| *choice != self.choice) {
            let made = factory.lock().unwrap_or_else(PoisonError::into_inner)(&self.choice);
            match (made, &backend) {
                (Ok(renderer), _) => *backend = Some((self.choice.clone(), renderer)),
                (Err(error), Some((old, _))) => {
                    self.status.messages.push(format!("{error}; the {} goes on", old.name()));
                    self.choice = old.clone();
                }
                (Err(error), None) => {
                    self.fail(&error.to_string());
                    return Ok(());
                }
            }
        }
        if let Some((_, renderer)) = backend {
            renderer.prepare(&self.job, &self.cancel)?;
            self.status.backend = Some(renderer.info());
            self.status.say(renderer.take_messages());
            self.status.kernel = renderer.kernel();
            self.status.hierarchy += renderer.hierarchy_time();
            self.is_prepared = true;
            self.status.phase = Phase::Tracing;
            self.status.prepare += begin.elapsed();
        }
        Ok(())
    }

    /// The samples that are next; `None` when none are missing or there is no time left for them.
    fn next_pass(&self) -> Option<std::ops::Range<u64>> {
        let time_left = match self.plan.time_limit {
            // A picture without a sample is of no use to anyone.
            Some(limit) if self.dealt.count() > 0 => Some(limit.saturating_sub(self.status.elapsed)),
            _ => None,
        };
        self.sizer.next(&self.dealt, self.plan.samples.clone(), time_left)
    }

    fn pass(
        &mut self,
        renderer: &mut dyn Renderer,
        is_picture_wanted: bool,
        begin: Instant,
    ) -> Result<(), RenderError> {
        if self.plan.noise_reached(self.film.sample_count(), self.status.error) {
            self.collect(renderer)?;
            self.end(EndReason::NoiseTarget);
            return Ok(());
        }
        let Some(range) = self.next_pass() else {
            self.collect(renderer)?;
            self.end_of_plan();
            return Ok(());
        };
        let added = range.end - range.start;
        let held = self.film.sample_count();
        let outcome = renderer.advance(&self.job, range.clone(), &mut self.film, &self.cancel);
        self.note_added(renderer, held, &outcome);
        outcome?;
        self.dealt.insert(range)?;
        let took = begin.elapsed();
        self.sizer.measured(added, took, self.plan.pass_target);
        self.status.trace += took;
        // A renderer that changes with use (an adapter lost, threads given up) says so.
        self.status.backend = Some(renderer.info());
        self.status.say(renderer.take_messages());
        if is_picture_wanted && self.film.sample_count() == 0 {
            // The first picture is what someone waits for most.
            self.collect(renderer)?;
        } else if is_picture_wanted {
            renderer.fetch()?;
        }
        Ok(())
    }

    /// Adds to the film what the renderer still has.
    fn collect(&mut self, renderer: &mut dyn Renderer) -> Result<(), RenderError> {
        if self.dealt != *self.film.samples() {
            let begin = Instant::now();
            let held = self.film.sample_count();
            let outcome = renderer.collect(&mut self.film);
            self.status.trace += begin.elapsed();
            self.note_added(renderer, held, &outcome);
            outcome?;
        }
        Ok(())
    }

    /// Notes who added to a film that held `held` samples, and what. Some can have come before a failure.
    fn note_added(&mut self, renderer: &dyn Renderer, held: u64, outcome: &Result<Stats, RenderError>) {
        let added = self.film.sample_count() - held;
        if added > 0 {
            if let Ok(stats) = outcome {
                self.status.stats.add(stats);
            }
            for (info, samples) in renderer.credits(added) {
                self.status.credit(&info, samples);
            }
            self.note_film();
        }
    }

    /// Brings the status up to date with the film.
    fn note_film(&mut self) {
        let samples = self.film.sample_count();
        self.status.samples_per_pixel = samples;
        self.status.rejected_samples = self.film.rejected();
        let is_history = samples >= self.next_history_samples;
        let is_due = self.estimated_at.elapsed() >= self.estimate_took * ERROR_ESTIMATE_SHARE;
        if is_history || is_due {
            self.estimate_error();
        }
        if is_history {
            self.next_history_samples = (samples + 1).next_power_of_two();
            if let Some(error) = self.status.error {
                let backend = self.status.backend.as_ref().map_or("", |backend| backend.name);
                self.status.history.push(HistoryPoint {
                    backend,
                    samples_per_pixel: samples,
                    trace_seconds: self.status.trace.as_secs_f64(),
                    rmse_estimate: error.rmse,
                    rel_mse_estimate: error.rel_mse,
                });
            }
        }
    }

    fn estimate_error(&mut self) {
        if self.estimated_samples != self.film.sample_count() {
            let begin = Instant::now();
            self.status.error = self.film.error();
            self.estimated_samples = self.film.sample_count();
            self.estimate_took = begin.elapsed();
            self.estimated_at = Instant::now();
        }
    }

    /// Resolves a picture if someone waits for one that he has not seen.
    fn show(&mut self, shared: &Shared, view: &View, renderer: Option<&dyn Renderer>) {
        let samples = self.film.sample_count();
        let is_new = self.pictured_samples != Some(samples);
        if is_new && samples > 0 && shared.is_picture_wanted() && !self.cancel.load(Ordering::Relaxed) {
            self.pictured_samples = Some(samples);
            let renderer = renderer.filter(|_| *view == View::Occupancy);
            let occupancy = renderer.and_then(Renderer::tile_occupancy);
            shared.put_picture(Picture {
                run: self.status.run,
                width: self.film.width(),
                height: self.film.height(),
                samples_per_pixel: samples,
                rgb8: view.resolve(&self.film, self.job.rules().transfer, occupancy.as_ref()),
            });
        }
    }
}
