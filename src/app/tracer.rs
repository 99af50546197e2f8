//! The window's side of a progressive render: what is wanted, what is running, and the newest picture as a texture.

use super::model::document::Document;
use super::texture::Texture;
use crate::backends::BackendChoice;
use crate::film::Film;
use crate::progressive::{Plan, Progressive, RenderRequest, Status, Stop, View};
use eframe::egui;
use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Target duration of a pass while the user moves something.
const MOVING_PASS: Duration = Duration::from_millis(10);

/// Target duration of a pass otherwise.
const STILL_PASS: Duration = Duration::from_millis(40);

/// Target latency of a preview in seconds, from input to display.
const PREVIEW_SECONDS: f64 = 0.05;

/// If a preview took longer than this many seconds, the next one is coarser.
const PREVIEW_SECONDS_LIMIT: f64 = 0.07;

/// The coarsest divisor of previews.
const DIVISOR_LIMIT: u32 = 8;

/// Samples per pixel that a render started during a pause traces before it stops.
const PAUSED_SAMPLES: u64 = 8;

/// The longest time between two pictures.
const PICTURE_INTERVAL_LIMIT: Duration = Duration::from_millis(250);

/// What should be rendered now.
pub struct Want<'a> {
    pub document: &'a Document,
    pub backend: &'a BackendChoice,
    pub stop: Stop,
    /// The view of the film.
    pub view: View,
    /// The user is moving something: a coarse picture now is better than a fine one later.
    pub is_moving: bool,
    /// The render is paused: a new picture is traced just far enough to be visible.
    pub is_paused: bool,
}

impl Want<'_> {
    fn plan(&self, is_held: bool) -> Plan {
        let pass_target = if self.is_moving { MOVING_PASS } else { STILL_PASS };
        let mut stop = self.stop;
        if is_held {
            stop.samples = Some(stop.samples.map_or(PAUSED_SAMPLES, |samples| samples.min(PAUSED_SAMPLES)));
        }
        Plan { pass_target, ..Plan::until(stop) }
    }
}

struct Started {
    document: Document,
    divisor: u32,
    run: u64,
    at: Instant,
    is_pictured: bool,
    /// The render began during a pause that still lasts.
    is_held: bool,
}

/// A picture on the screen.
pub struct Shown {
    /// The texture of the picture.
    pub texture: Texture,
    /// Samples per pixel.
    pub samples: u64,
    /// 1, or the factor by which a preview is smaller.
    pub divisor: u32,
    /// The document that it shows.
    pub document: Document,
}

/// A render thread and its latest results.
pub struct Tracer {
    progressive: Progressive,
    started: Option<Started>,
    shown: Option<Shown>,
    status: Arc<Status>,
    asked: Instant,
    /// The backend and plan last sent to the render thread.
    told: Option<(BackendChoice, Plan)>,
    view: View,
    /// Pixels per second of the last preview, from request to picture. It includes the cost of drawing the window.
    preview_speed: Option<f64>,
    moving_divisor: Option<u32>,
}

impl Tracer {
    pub fn new() -> io::Result<Self> {
        Ok(Tracer {
            progressive: Progressive::spawn()?,
            started: None,
            shown: None,
            status: Arc::default(),
            asked: Instant::now(),
            told: None,
            view: View::Picture,
            preview_speed: None,
            moving_divisor: None,
        })
    }

    /// Sets a callback that wakes the window when there is something new to show.
    pub fn wake(&self, context: &egui::Context) {
        let context = context.clone();
        self.progressive.set_notice(move || context.request_repaint());
    }

    /// The status as of this frame.
    pub fn status(&self) -> &Arc<Status> {
        &self.status
    }

    /// The newest picture.
    pub fn shown_mut(&mut self) -> Option<&mut Shown> {
        self.shown.as_mut()
    }

    /// The newest picture.
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// Whether the current film is the full-size film of the document.
    pub fn is_full(&self, document: &Document) -> bool {
        self.started.as_ref().is_some_and(|run| run.divisor == 1 && run.document.has_same_film(document))
    }

    /// Whether the current film is the document's, at any size.
    pub fn is_of(&self, document: &Document) -> bool {
        self.started.as_ref().is_some_and(|run| run.document.has_same_film(document))
    }

    /// Sets the view for pictures.
    fn look(&mut self, view: &View) {
        if !self.view.is_same(view) {
            self.view = view.clone();
            self.progressive.set_view(view.clone());
            self.progressive.ask_for_picture();
        }
    }

    /// Whether the document's film has samples.
    pub fn has_samples(&self, document: &Document) -> bool {
        self.is_full(document) && self.status.samples_per_pixel > 0
    }

    /// Takes the film, and waits for the end of its pass. The next request starts a new one.
    pub fn take_film(&mut self) -> Option<Film> {
        self.started = None;
        self.progressive.take_film()
    }

    /// Runs `look` with the film on the render thread.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        self.progressive.inspect(look);
    }

    pub fn pause(&self) {
        self.progressive.pause();
    }

    pub fn resume(&self) {
        self.progressive.resume();
    }

    /// Discards the film; the next request starts a new one.
    pub fn restart(&mut self) {
        self.started = None;
    }

    /// Stops rendering until the next request.
    pub fn abandon(&mut self) {
        if self.started.take().is_some() {
            self.progressive.abandon();
            self.shown = None;
        }
    }

    /// Continues a film of `document`.
    pub fn go_on_with(&mut self, film: Film, want: &Want<'_>) -> Result<(), String> {
        self.look(&want.view);
        self.start(want, 1, Some(film))
    }

    /// Takes new results. For a new picture, returns the time at which its render began.
    pub fn poll(&mut self, context: &egui::Context) -> Option<Instant> {
        self.status = Arc::new(self.progressive.status());
        let started = self.started.as_mut()?;
        let mut pictured = None;
        if let Some(picture) = self.progressive.newest_picture()
            && picture.run == started.run
        {
            let earlier = self.shown.take().map(|shown| shown.texture);
            self.shown = Some(Shown {
                texture: Texture::new([picture.width, picture.height], &picture.rgb8, earlier),
                samples: picture.samples_per_pixel,
                divisor: started.divisor,
                document: started.document.clone(),
            });
            if let Some(divisor) = &mut self.moving_divisor
                && !started.is_pictured
            {
                let took = started.at.elapsed().as_secs_f64().max(1e-3);
                self.preview_speed = Some(f64::from(picture.width) * f64::from(picture.height) / took);
                // During a move, previews only get coarser: getting finer again would make them flicker.
                if took > PREVIEW_SECONDS_LIMIT {
                    let coarser = f64::from(started.divisor) * (took / PREVIEW_SECONDS).sqrt();
                    *divisor = (coarser.ceil() as u32).clamp(*divisor, DIVISOR_LIMIT.max(*divisor));
                }
            }
            started.is_pictured = true;
            pictured = Some(started.at);
        }
        // After many samples, the picture changes slowly.
        let interval = match self.moving_divisor {
            Some(_) => Duration::ZERO,
            None => (started.at.elapsed() / 20).min(PICTURE_INTERVAL_LIMIT),
        };
        if self.asked.elapsed() >= interval || !started.is_pictured {
            self.progressive.ask_for_picture();
            self.asked = Instant::now();
        }
        if self.status.phase.is_working() {
            context.request_repaint_after(interval.max(Duration::from_millis(16)));
        }
        pictured
    }

    /// Renders what is wanted, at once or after the next picture.
    ///
    /// # Errors
    /// Why the document cannot be rendered; the current render continues.
    pub fn want(&mut self, want: &Want<'_>) -> Result<(), String> {
        self.look(&want.view);
        if !want.is_moving {
            self.moving_divisor = None;
        }
        let divisor = if want.is_moving { self.divisor(want.document) } else { 1 };
        if want.is_moving {
            self.moving_divisor = Some(divisor);
        }
        let is_at_it = self
            .started
            .as_ref()
            .is_some_and(|run| run.document.has_same_film(want.document) && run.divisor <= divisor);
        if is_at_it {
            self.adjust(want);
            return Ok(());
        }
        // Until a preview has been displayed, starting another one would only delay it.
        let is_unseen = self.started.as_ref().is_some_and(|run| !run.is_pictured);
        if want.is_moving && is_unseen && self.status.phase.is_working() {
            return Ok(());
        }
        self.start(want, divisor, None)
    }

    fn start(&mut self, want: &Want<'_>, divisor: u32, film: Option<Film>) -> Result<(), String> {
        let job = want.document.job(divisor).map_err(|error| error.to_string())?;
        let plan = want.plan(want.is_paused);
        let request = RenderRequest { film, ..RenderRequest::new(job, want.backend.clone(), plan.clone()) };
        self.progressive.start(request);
        self.progressive.ask_for_picture();
        self.status = Arc::new(self.progressive.status());
        self.started = Some(Started {
            document: want.document.clone(),
            divisor,
            run: self.status.run,
            at: Instant::now(),
            is_pictured: false,
            is_held: want.is_paused,
        });
        self.told = Some((want.backend.clone(), plan));
        Ok(())
    }

    /// Changes backend or plan and keeps the film.
    fn adjust(&mut self, want: &Want<'_>) {
        let is_held = self.started.as_mut().is_some_and(|run| {
            run.is_held &= want.is_paused;
            run.is_held
        });
        let plan = want.plan(is_held);
        let Some((told_backend, told_plan)) = &mut self.told else { return };
        if told_backend != want.backend {
            told_backend.clone_from(want.backend);
            self.progressive.switch_backend(want.backend.clone());
        }
        if *told_plan != plan {
            told_plan.clone_from(&plan);
            self.progressive.set_plan(plan);
        }
    }

    /// The divisor of previews, chosen so that the first pass is short.
    fn divisor(&self, document: &Document) -> u32 {
        self.moving_divisor.unwrap_or_else(|| {
            let pixels = f64::from(document.settings.width) * f64::from(document.settings.height);
            // An estimate for the first preview: the current render must stop first, and drawing takes time too.
            let speed = self.preview_speed.unwrap_or_else(|| (0.1 * self.status.paths_per_second()).max(1e6));
            let affordable = (speed * PREVIEW_SECONDS).max(1.0);
            ((pixels / affordable).sqrt().ceil() as u32).clamp(1, DIVISOR_LIMIT)
        })
    }
}
