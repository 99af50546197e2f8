//! The window's side of a progressive render: what is wanted, what runs, and the newest picture as a texture.

use super::model::document::Document;
use super::texture::Texture;
use crate::backends::BackendChoice;
use crate::film::Film;
use crate::progressive::{Phase, Plan, Progressive, Status, Stop, View, Work};
use eframe::egui;
use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a pass should take while someone moves something.
const MOVING_PASS: Duration = Duration::from_millis(10);

/// What a pass should take else.
const STILL_PASS: Duration = Duration::from_millis(40);

/// What a preview should take until it is drawn, seconds: the time from the hand to the eye.
const PREVIEW_SECONDS: f64 = 0.05;

/// Beyond this, seconds, the next preview is coarser.
const PREVIEW_SECONDS_LIMIT: f64 = 0.07;

/// A preview is no coarser than this.
const DIVISOR_LIMIT: u32 = 8;

/// How far a picture is traced that is asked for during a pause, samples per pixel.
const PAUSED_SAMPLES: u64 = 8;

/// The longest time between two pictures.
const PICTURE_INTERVAL_LIMIT: Duration = Duration::from_millis(250);

/// What should be rendered.
pub struct Want<'a> {
    pub document: &'a Document,
    pub backend: &'a BackendChoice,
    pub stop: Stop,
    /// How the film is shown.
    pub view: View,
    /// Something moves: a coarse picture now is better than a fine one later.
    pub is_moving: bool,
    /// What is new is traced so far that it can be seen, and then waits.
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
    /// It began during a pause that has not ended since.
    is_held: bool,
}

/// A picture on the screen.
pub struct Shown {
    /// Its texture.
    pub texture: Texture,
    /// Samples per pixel.
    pub samples: u64,
    /// 1, or the preview's share of the size.
    pub divisor: u32,
    /// What it shows.
    pub document: Document,
}

/// A render thread and what is known of it.
pub struct Tracer {
    progressive: Progressive,
    started: Option<Started>,
    shown: Option<Shown>,
    status: Arc<Status>,
    asked: Instant,
    /// What the render thread was told last.
    told: Option<(BackendChoice, Plan)>,
    view: View,
    /// Pixels a second of the last preview, from its wish to its picture: drawing the window takes its part, too.
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

    /// Wakes the window when there is something to see.
    pub fn wake(&self, context: &egui::Context) {
        let context = context.clone();
        self.progressive.set_notice(move || context.request_repaint());
    }

    /// The numbers as of this frame.
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

    /// Whether the film that grows is that of the document at its full size.
    pub fn is_full(&self, document: &Document) -> bool {
        self.started.as_ref().is_some_and(|run| run.divisor == 1 && run.document.has_same_film(document))
    }

    /// Sets what pictures show.
    fn look(&mut self, view: &View) {
        let is_same = match (&self.view, view) {
            (View::Difference(old), View::Difference(new)) => Arc::ptr_eq(old, new),
            (old, new) => old == new,
        };
        if !is_same {
            self.view = view.clone();
            self.progressive.set_view(view.clone());
            self.progressive.ask_for_picture();
        }
    }

    /// Whether that film has samples.
    pub fn has_samples(&self, document: &Document) -> bool {
        self.is_full(document) && self.status.samples_per_pixel > 0
    }

    /// Reads the film on the render thread.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        self.progressive.inspect(look);
    }

    pub fn pause(&self) {
        self.progressive.pause();
    }

    pub fn resume(&self) {
        self.progressive.resume();
    }

    /// Throws the film away; the next wish begins anew.
    pub fn restart(&mut self) {
        self.started = None;
    }

    /// Nothing is rendered until the next wish.
    pub fn abandon(&mut self) {
        if self.started.take().is_some() {
            self.progressive.abandon();
            self.shown = None;
        }
    }

    /// Goes on with a film of `document`.
    pub fn go_on_with(&mut self, film: Film, want: &Want<'_>) -> Result<(), String> {
        self.look(&want.view);
        self.start(want, 1, Some(film))
    }

    /// Fetches what is new. Returns when the render of a new picture has begun.
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
                // A move that is under way gets coarser if it must; to get finer it would have to flicker.
                if took > PREVIEW_SECONDS_LIMIT {
                    let coarser = f64::from(started.divisor) * (took / PREVIEW_SECONDS).sqrt();
                    *divisor = (coarser.ceil() as u32).clamp(*divisor, DIVISOR_LIMIT.max(*divisor));
                }
            }
            started.is_pictured = true;
            pictured = Some(started.at);
        }
        // A picture that has been refined for long changes slowly.
        let interval = match self.moving_divisor {
            Some(_) => Duration::ZERO,
            None => (started.at.elapsed() / 20).min(PICTURE_INTERVAL_LIMIT),
        };
        if self.asked.elapsed() >= interval || !started.is_pictured {
            self.progressive.ask_for_picture();
            self.asked = Instant::now();
        }
        if matches!(self.status.phase, Phase::Preparing | Phase::Tracing) {
            context.request_repaint_after(interval.max(Duration::from_millis(16)));
        }
        pictured
    }

    /// Brings what runs in line with what is wanted, at once or as soon as there was a picture.
    ///
    /// # Errors
    /// Why the document cannot be rendered; what ran goes on.
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
        // Before a preview has been seen, another would only keep it from being so.
        let is_unseen = self.started.as_ref().is_some_and(|run| !run.is_pictured);
        if want.is_moving && is_unseen && matches!(self.status.phase, Phase::Preparing | Phase::Tracing) {
            return Ok(());
        }
        self.start(want, divisor, None)
    }

    fn start(&mut self, want: &Want<'_>, divisor: u32, film: Option<Film>) -> Result<(), String> {
        let job = want.document.job(divisor).map_err(|error| error.to_string())?;
        let plan = want.plan(want.is_paused);
        let work = Work { film, ..Work::new(job, want.backend.clone(), plan.clone()) };
        self.progressive.start(work);
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

    /// The film stays, whoever traces and whenever it ends.
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

    /// By how much a preview is smaller, so that its first pass is short.
    fn divisor(&self, document: &Document) -> u32 {
        self.moving_divisor.unwrap_or_else(|| {
            let pixels = f64::from(document.settings.width) * f64::from(document.settings.height);
            // Before the first preview: what runs must be stopped, and drawing takes its part.
            let speed = self.preview_speed.unwrap_or_else(|| (0.1 * self.status.paths_per_second()).max(1e6));
            let affordable = (speed * PREVIEW_SECONDS).max(1.0);
            ((pixels / affordable).sqrt().ceil() as u32).clamp(1, DIVISOR_LIMIT)
        })
    }
}
