//! The window's side of a progressive render: what is wanted, what is running, and the newest picture as a texture.

use super::preview::{Preview, Previews};
use crate::app::model::Document;
use crate::app::toolkit::Texture;
use crate::backends::BackendChoice;
use crate::film::Film;
use crate::job::saved::SavedFilm;
use crate::progressive::{Plan, Progressive, RenderRequest, Status, Stop, View};
use eframe::egui;
use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// A film that was traced for longer than this many seconds is kept.
pub const LONG_SECONDS: f64 = 10.0;

/// Target duration of a pass while the user moves something.
const MOVING_PASS: Duration = Duration::from_millis(10);

/// Target duration of a pass otherwise.
const STILL_PASS: Duration = Duration::from_millis(40);

/// A smooth preview stays until the picture itself has this many samples per pixel: fewer are confetti.
const CLEARER_SAMPLES: u64 = 8;

/// The longest time for which a preview stays on the screen when there is something newer.
const PREVIEW_LIMIT: Duration = Duration::from_millis(500);

/// Samples per pixel that a render started during a pause traces before it stops.
const PAUSED_SAMPLES: u64 = 8;

/// The longest time between two pictures.
const PICTURE_INTERVAL_LIMIT: Duration = Duration::from_millis(250);

/// The render that the window wants now.
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
    fn plan(&self, is_held: bool, preview: Preview) -> Plan {
        let pass_target = if self.is_moving { MOVING_PASS } else { STILL_PASS };
        let mut stop = self.stop;
        if is_held {
            stop.samples = Some(stop.samples.map_or(PAUSED_SAMPLES, |samples| samples.min(PAUSED_SAMPLES)));
        }
        let preview = (preview.divisor > 1).then_some(preview.samples);
        Plan { pass_target, preview, ..Plan::until(stop) }
    }
}

/// A render that was started.
pub struct Started {
    document: Document,
    preview: Preview,
    run: u64,
    at: Instant,
    is_pictured: bool,
    /// The render began during a pause that still lasts.
    is_held: bool,
}

impl Started {
    pub fn document(&self) -> &Document {
        &self.document
    }
}

/// A film to keep, which the render thread gives when its pass has ended.
pub struct Left {
    pub document: Document,
    /// Tracing time of its samples from before its last run, if known.
    pub seconds_before: Option<f64>,
    pub film: Receiver<(Film, Status)>,
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
    /// The run of the render that it belongs to, as [`Status::run`].
    pub run: u64,
}

/// A render thread and its latest results.
pub struct Tracer {
    pub progressive: Progressive,
    pub started: Option<Started>,
    /// Tracing time of the film's samples from before this run; none if it is not known.
    pub seconds_before: Option<f64>,
    /// Films to keep of pictures that are no longer traced.
    pub left: Vec<Left>,
    shown: Option<Shown>,
    status: Arc<Status>,
    asked: Instant,
    /// The backend and plan last sent to the render thread.
    sent: Option<(BackendChoice, Plan)>,
    view: View,
    previews: Previews,
}

impl Tracer {
    pub fn new() -> io::Result<Self> {
        Ok(Tracer {
            progressive: Progressive::spawn()?,
            started: None,
            seconds_before: Some(0.0),
            left: Vec::new(),
            shown: None,
            status: Arc::default(),
            asked: Instant::now(),
            sent: None,
            view: View::Picture,
            previews: Previews::default(),
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
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// Samples per pixel of the newest picture; 0 as long as only that of an earlier film is there.
    pub fn shown_samples(&self) -> u64 {
        self.shown.as_ref().filter(|shown| shown.run == self.status.run).map_or(0, |shown| shown.samples)
    }

    /// The current run, if its film is the document's, at any size.
    pub fn run_of(&self, document: &Document) -> Option<&Started> {
        self.started.as_ref().filter(|run| run.document.has_same_film(document))
    }

    /// Whether the current film is the full-size film of the document.
    pub fn is_full(&self, document: &Document) -> bool {
        self.run_of(document).is_some_and(|run| run.preview.divisor == 1)
    }

    /// Whether there is a picture of the document, at any size.
    pub fn has_picture(&self, document: &Document) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.document.has_same_film(document))
    }

    /// Whether the render is a preview.
    pub fn is_coarse(&self) -> bool {
        self.started.as_ref().is_some_and(|run| run.preview.divisor > 1)
    }

    /// Whether the render began during a pause that lasts.
    pub fn is_held(&self) -> bool {
        self.started.as_ref().is_some_and(|run| run.is_held)
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

    /// Tracing time of the film's samples, if known.
    pub fn seconds(&self) -> Option<f64> {
        Some(self.seconds_before? + self.status.trace.as_secs_f64())
    }

    /// The way of the film to where it is kept, if it has taken long enough for that.
    fn way(&self) -> Option<(Sender<(Film, Status)>, Left)> {
        let document = &self.started.as_ref()?.document;
        let is_long = self.seconds().is_none_or(|seconds| seconds > LONG_SECONDS);
        let ((sender, film), seconds_before) = (channel(), self.seconds_before);
        let left = || (sender, Left { document: document.clone(), seconds_before, film });
        (is_long && self.has_samples(document)).then(left)
    }

    /// A copy of the film, if it has taken long enough to be kept.
    pub fn copy_long(&self) -> Option<Left> {
        let ((sender, left), status) = (self.way()?, Status::clone(&self.status));
        // Without memory for a copy, it is kept at its end alone.
        self.inspect(move |film| _ = film.try_copy().ok().and_then(|copy| sender.send((copy, status)).ok()));
        Some(left)
    }

    /// Ends the render. Its film is kept if it has taken long enough.
    pub fn leave(&mut self) {
        if let Some((sender, left)) = self.way() {
            self.progressive.hand_over(move |film, status| _ = sender.send((film, status)));
            self.left.push(left);
        }
        self.started = None;
    }

    /// Runs `look` with the film on the render thread.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        self.progressive.inspect(look);
    }

    /// Stops rendering until the next request.
    pub fn abandon(&mut self) {
        if self.started.is_some() {
            self.leave();
            self.progressive.abandon();
            self.shown = None;
        }
    }

    /// Takes new results.
    pub fn poll(&mut self, context: &egui::Context) {
        self.status = Arc::new(self.progressive.status());
        let Some(started) = &mut self.started else { return };
        if started.preview.divisor == 1 {
            self.previews.note_speed(&self.status);
        }
        if let Some(picture) = self.progressive.newest_picture().filter(|picture| picture.run == started.run)
        {
            let earlier = self.shown.take().map(|shown| shown.texture);
            self.shown = Some(Shown {
                texture: Texture::new([picture.width, picture.height], &picture.rgb8, earlier),
                samples: picture.samples_per_pixel,
                divisor: started.preview.divisor,
                document: started.document.clone(),
                run: started.run,
            });
            if !started.is_pictured && (self.previews.is_moving() || started.preview.divisor > 1) {
                let samples = picture.samples_per_pixel as f64;
                let samples = samples * f64::from(picture.width) * f64::from(picture.height);
                let seconds = started.at.elapsed().as_secs_f64();
                self.previews.pictured(&started.document, started.preview.divisor, samples, seconds);
            }
            started.is_pictured = true;
        }
        let (age, is_pictured) = (started.at.elapsed(), started.is_pictured);
        // After many samples, the picture changes slowly.
        let interval =
            if self.previews.is_moving() { Duration::ZERO } else { (age / 20).min(PICTURE_INTERVAL_LIMIT) };
        if (self.asked.elapsed() >= interval || !is_pictured) && !self.is_confetti() {
            self.progressive.ask_for_picture();
            self.asked = Instant::now();
        }
        if self.status.phase.is_working() {
            context.request_repaint_after(interval.max(Duration::from_millis(16)));
        }
    }

    /// Whether the preview on the screen looks better than the picture would now.
    fn is_confetti(&self) -> bool {
        let Some(started) = &self.started else { return false };
        let is_preview = |shown: &Shown| shown.divisor > 1 && shown.document.has_same_film(&started.document);
        started.preview.divisor == 1
            && self.status.phase.is_working()
            && self.status.samples_per_pixel < CLEARER_SAMPLES
            && started.at.elapsed() < PREVIEW_LIMIT
            && self.shown.as_ref().is_some_and(is_preview)
    }

    /// Renders what is wanted, at once or after the next picture; resumes the optional `film`.
    ///
    /// # Errors
    /// Why the document cannot be rendered; the current render continues.
    pub fn want(&mut self, want: &Want<'_>, film: Option<SavedFilm>) -> Result<(), String> {
        self.look(&want.view);
        if film.is_some() {
            return self.start(want, Preview::NONE, film);
        }
        let preview = if want.is_moving {
            self.previews.follow_move(want.document)
        } else {
            self.previews.end_move();
            self.still(want)
        };
        if self.run_of(want.document).is_some_and(|run| run.preview.divisor <= preview.divisor) {
            self.adjust(want);
            return Ok(());
        }
        // Until a preview has been displayed, starting another one would only delay it.
        let is_unseen = self.started.as_ref().is_some_and(|run| !run.is_pictured);
        if want.is_moving && is_unseen && self.status.phase.is_working() {
            return Ok(());
        }
        self.start(want, preview, None)
    }

    /// What to render of a picture that does not move. Previews are for the CPU: a GPU is fast or has to compile first.
    fn still(&self, want: &Want<'_>) -> Preview {
        let is_cpu = matches!(want.backend, BackendChoice::Cpu(_) | BackendChoice::Reference { .. });
        // The same picture at another size is on the screen already.
        let is_there = |shown: &Shown| shown.document.is_same_at_another_size(want.document);
        match self.run_of(want.document) {
            Some(run) if run.preview.divisor == 1 => Preview::NONE,
            Some(run) if !run.is_pictured && self.status.phase.is_working() => run.preview,
            Some(run) if is_cpu => self.previews.look(want.document, Some(run.preview.divisor)),
            None if is_cpu && !self.shown.as_ref().is_some_and(is_there) => {
                self.previews.look(want.document, None)
            }
            _ => Preview::NONE,
        }
    }

    fn start(&mut self, want: &Want<'_>, preview: Preview, film: Option<SavedFilm>) -> Result<(), String> {
        let job = want.document.job(preview.divisor).map_err(|error| error.to_string())?;
        self.leave();
        let (film, seconds) = film.map_or((None, Some(0.0)), |saved| (Some(saved.film), saved.seconds));
        self.seconds_before = seconds;
        let plan = want.plan(want.is_paused, preview);
        let request = RenderRequest { film, ..RenderRequest::new(job, want.backend.clone(), plan.clone()) };
        self.progressive.start(request);
        self.status = Arc::new(self.progressive.status());
        self.started = Some(Started {
            document: want.document.clone(),
            preview,
            run: self.status.run,
            at: Instant::now(),
            is_pictured: false,
            is_held: want.is_paused,
        });
        self.sent = Some((want.backend.clone(), plan));
        if !self.is_confetti() {
            self.progressive.ask_for_picture();
        }
        Ok(())
    }

    /// Changes backend or plan and keeps the film.
    fn adjust(&mut self, want: &Want<'_>) {
        let Some(run) = &mut self.started else { return };
        run.is_held &= want.is_paused;
        let plan = want.plan(run.is_held, run.preview);
        let Some((sent_backend, sent_plan)) = &mut self.sent else { return };
        if sent_backend != want.backend {
            sent_backend.clone_from(want.backend);
            self.progressive.switch_backend(want.backend.clone());
        }
        if *sent_plan != plan {
            sent_plan.clone_from(&plan);
            self.progressive.set_plan(plan);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::render_cpu::CpuOptions;
    use crate::stages::Stage;

    #[test]
    fn passes_are_short_in_motion_and_few_in_a_pause() {
        let document = Document::new(Origin::usual());
        let backend = BackendChoice::Cpu(CpuOptions::default());
        let plan = |stop, is_moving, is_held, preview| {
            let view = View::Picture;
            Want { document: &document, backend: &backend, stop, view, is_moving, is_paused: false }
                .plan(is_held, preview)
        };
        let stop = Stop::at_samples(100);
        let still = plan(stop, false, false, Preview::NONE);
        assert_eq!((still.pass_target, still.stop, still.preview), (Duration::from_millis(40), stop, None));
        let moving = plan(stop, true, false, Preview { divisor: 2, samples: 4 });
        assert_eq!((moving.pass_target, moving.preview), (Duration::from_millis(10), Some(4)));
        let held = |stop| plan(stop, false, true, Preview::NONE).stop.samples;
        assert_eq!([stop, Stop::at_samples(3), Stop::default()].map(held), [Some(8), Some(3), Some(8)]);
    }

    /// A small picture of a stage.
    fn small(stage: &str) -> Document {
        let mut document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
        document.give_size([16, 9]);
        document
    }

    fn cpu() -> BackendChoice {
        BackendChoice::Cpu(CpuOptions::default())
    }

    /// The render that a window with this document wants. It never ends.
    fn wish<'a>(document: &'a Document, backend: &'a BackendChoice, is_moving: bool) -> Want<'a> {
        Want {
            document,
            backend,
            stop: Stop::at_samples(4_000_000_000),
            view: View::Picture,
            is_moving,
            is_paused: false,
        }
    }

    #[test]
    fn a_preview_is_followed_by_the_picture_once_it_has_been_seen() {
        let (document, backend) = (small("metal"), cpu());
        let want = wish(&document, &backend, false);
        for is_pictured in [false, true] {
            let mut tracer = Tracer::new().unwrap();
            tracer.start(&want, Preview { divisor: 2, samples: 4 }, None).unwrap();
            assert!(tracer.run_of(&document).is_some() && !tracer.is_full(&document));
            tracer.started.as_mut().unwrap().is_pictured = is_pictured;
            tracer.want(&want, None).unwrap();
            assert_eq!(tracer.is_full(&document), is_pictured);
            // The same picture again continues.
            let run = tracer.status().run;
            tracer.want(&want, None).unwrap();
            assert_eq!(tracer.status().run, run);
            tracer.started = None;
            assert!(tracer.run_of(&document).is_none());
            tracer.want(&want, None).unwrap();
            assert_eq!((tracer.status().run, tracer.is_full(&document)), (run + 1, true), "it begins anew");
        }
    }

    /// It takes gigabytes, or is refused where there are too few.
    #[test]
    fn a_huge_picture_does_not_delay_the_next_one() {
        let (mut huge, document, backend) = (small("metal"), small("metal"), cpu());
        huge.give_size([16384, 16384]);
        let (mut tracer, context) = (Tracer::new().unwrap(), egui::Context::default());
        tracer.want(&wish(&huge, &backend, false), None).unwrap();
        std::thread::sleep(Duration::from_millis(300));
        let begin = Instant::now();
        while !tracer.has_samples(&document) {
            tracer.want(&wish(&document, &backend, false), None).unwrap();
            tracer.poll(&context);
            assert!(begin.elapsed() < Duration::from_secs(10));
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn what_cannot_be_rendered_is_refused_and_the_render_goes_on() {
        let (document, backend) = (small("metal"), cpu());
        let mut tracer = Tracer::new().unwrap();
        tracer.want(&wish(&document, &backend, false), None).unwrap();
        let run = tracer.status().run;
        let mut invalid = document.clone();
        invalid.settings.width = 0;
        let reason = tracer.want(&wish(&invalid, &backend, false), None).unwrap_err();
        assert!(reason.contains("width"), "{reason}");
        assert_eq!(tracer.status().run, run);
        assert!(tracer.run_of(&document).is_some() && tracer.run_of(&invalid).is_none());
    }
}
