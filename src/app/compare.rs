//! A second picture beside the main one, for the wipe and the difference: another stage, or the same picture by the
//! book's own arithmetic.

use super::document::{Document, Origin};
use super::files::Message;
use super::tracer::{Tracer, Want};
use super::viewport::Show;
use crate::progressive::{Reference, View};
use crate::recipe::Recipe;
use crate::scene::Camera;
use crate::stages::Stage;
use eframe::egui;
use std::sync::Arc;
use std::sync::mpsc::Sender;

/// How two pictures are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// One at each side of a divider.
    Wipe,
    /// A heat map of where they differ.
    Difference,
}

/// What the main picture is compared with.
#[derive(Clone, Debug)]
pub enum Other {
    /// Another stage.
    Stage(&'static Stage),
    /// The same picture by the book's own arithmetic.
    ByTheBook(Arc<Origin>),
}

impl PartialEq for Other {
    /// Origins are never changed, so that it is enough to compare which one it is.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Other::Stage(a), Other::Stage(b)) => a == b,
            (Other::ByTheBook(a), Other::ByTheBook(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl Other {
    fn origin(&self) -> Origin {
        match self {
            Other::Stage(stage) => Origin::of_stage(stage),
            Other::ByTheBook(mine) => mine.by_the_book(),
        }
    }
}

/// The second picture.
pub struct Compare {
    /// Whether and how two pictures are compared.
    pub mode: Option<Mode>,
    /// With the book's arithmetic, where there is another stage to compare with.
    pub is_by_book: bool,
    /// With the next stage, where there is a pair.
    pub is_with_next: bool,
    /// Where the divider stands, `0..=1` of the picture's width.
    pub divider: f32,
    /// A film to compare with.
    pub reference: Option<Arc<Reference>>,
    /// The tracer of the second picture, once there has been one.
    pub tracer: Option<Tracer>,
    show: Show,
    origin: Option<(Other, Arc<Origin>)>,
    is_awake: bool,
    measured_samples: u64,
}

impl Default for Compare {
    fn default() -> Self {
        Compare {
            mode: None,
            is_by_book: false,
            is_with_next: false,
            divider: 0.5,
            reference: None,
            tracer: None,
            show: Show::Picture,
            origin: None,
            is_awake: false,
            measured_samples: 0,
        }
    }
}

impl Compare {
    pub fn toggle(&mut self, mode: Mode, is_by_book: bool) {
        let is_on = self.mode == Some(mode) && self.is_by_book == is_by_book;
        self.mode = if is_on { None } else { Some(mode) };
        self.is_by_book = is_by_book;
        self.measured_samples = 0;
    }

    /// What `document` is compared with; `None` if there is nothing.
    pub fn other(&self, document: &Document) -> Option<Other> {
        match document.stage().filter(|_| !self.is_by_book) {
            Some(stage) => self.other_of(stage).map(Other::Stage),
            None => {
                let origin = &document.origin;
                origin.is_other_by_the_book().then(|| Other::ByTheBook(Arc::clone(origin)))
            }
        }
    }

    /// Whether the camera is what `document` and the other picture differ in, so that each keeps its own.
    pub fn has_other_camera(&self, document: &Document) -> bool {
        !self.is_by_book && document.stage().is_some_and(|stage| self.is_of_cameras(stage))
    }

    /// The stage that `stage` is compared with.
    pub fn other_of(&self, stage: &'static Stage) -> Option<&'static Stage> {
        let pair = stage.pair.and_then(|id| Stage::find(id).ok());
        let next = stage.next().or_else(|| stage.previous());
        if self.is_with_next { next.or(pair) } else { pair.or(next) }
    }

    /// Whether the camera is what `stage` and the other differ in, so that each keeps its own.
    pub fn is_of_cameras(&self, stage: &'static Stage) -> bool {
        let mine = stage.recipe();
        self.other_of(stage).is_some_and(|other| differ_in_camera(&mine, &other.recipe()))
    }

    /// Whether what `document` is compared with has been pictured.
    pub fn has_picture(&self, document: &Document) -> bool {
        let shown = self.tracer.as_ref().and_then(Tracer::shown);
        match (self.other(document), &self.origin, shown) {
            (Some(wanted), Some((kept, origin)), Some(shown)) => {
                wanted == *kept && Arc::ptr_eq(origin, &shown.document.origin)
            }
            _ => false,
        }
    }

    pub fn pause(&self) {
        if let Some(tracer) = &self.tracer {
            tracer.pause();
        }
    }

    pub fn resume(&self) {
        if let Some(tracer) = &self.tracer {
            tracer.resume();
        }
    }

    /// What the main picture shows from now on.
    pub fn show(&mut self, main: &Tracer, show: Show) {
        self.show = show;
        self.measured_samples = 0;
        main.set_view(self.view());
    }

    fn view(&self) -> View {
        match (self.show, &self.reference) {
            (Show::Error, _) => View::StandardError,
            (Show::Difference, Some(reference)) => View::Difference(Arc::clone(reference)),
            (Show::Occupancy, _) => View::Occupancy,
            _ => View::Picture,
        }
    }

    /// The other picture's film has arrived.
    pub fn measured(&mut self, main: &Tracer, reference: Reference) {
        if self.mode == Some(Mode::Difference) {
            main.set_view(View::Difference(Arc::new(reference)));
        }
    }

    /// Has the second picture rendered, if there is to be one.
    pub fn follow(
        &mut self,
        context: &egui::Context,
        want: &Want<'_>,
        main: &Tracer,
        sender: &Sender<Message>,
    ) {
        let other = self.mode.and_then(|_| self.other(want.document));
        let Some(other) = other else {
            if let Some(tracer) = &mut self.tracer {
                tracer.abandon();
            }
            if self.measured_samples != 0 || self.mode.is_some() {
                self.mode = None;
                self.measured_samples = 0;
                main.set_view(self.view());
            }
            return;
        };
        if self.tracer.is_none() {
            // Without a second thread there is no second picture, and nothing else is lost.
            self.tracer = Tracer::new().ok();
        }
        let document = self.document_of(other, want.document);
        let Some(tracer) = &mut self.tracer else { return };
        if !self.is_awake {
            self.is_awake = true;
            tracer.wake(context);
        }
        let is_new = tracer.poll(context);
        // Both pictures end alike, so that what differs is not the noise.
        let want = Want {
            document: &document,
            backend: want.backend,
            stop: document.stop,
            is_moving: want.is_moving,
            is_paused: want.is_paused,
        };
        if tracer.want(&want).is_err() {
            self.mode = None;
        }
        let is_difference = self.mode == Some(Mode::Difference);
        if is_difference && is_new.is_some() && tracer.is_full(&document) {
            self.measured_samples = tracer.status().samples_per_pixel.max(1);
            let (sender, context) = (sender.clone(), context.clone());
            tracer.inspect(move |film| {
                // A window that has been closed wants no more pictures.
                let _ = sender.send(Message::Measured(Reference::of(film)));
                context.request_repaint();
            });
        } else if !is_difference && self.measured_samples != 0 {
            self.measured_samples = 0;
            main.set_view(self.view());
        }
    }

    fn document_of(&mut self, other: Other, mine: &Document) -> Document {
        if self.origin.as_ref().is_none_or(|(kept, _)| *kept != other) {
            self.origin = None;
        }
        let (_, origin) = self.origin.get_or_insert_with(|| {
            let origin = Arc::new(other.origin());
            (other, origin)
        });
        let (theirs, base) = (&origin.recipe, &mine.origin.recipe);
        let mut settings = mine.settings;
        if theirs.settings.max_depth != base.settings.max_depth {
            settings.max_depth = theirs.settings.max_depth;
        }
        let mut stop = mine.stop;
        if origin.usual_stop() != mine.origin.usual_stop() {
            stop = origin.usual_stop();
        }
        let camera = if differ_in_camera(base, theirs) {
            camera_of(&mine.camera, &base.camera, &theirs.camera)
        } else {
            mine.camera
        };
        Document { camera, settings, stop, origin: Arc::clone(origin) }
    }
}

/// Whether two pictures differ in nothing but the camera, so that it is what there is to compare.
fn differ_in_camera(a: &Recipe, b: &Recipe) -> bool {
    a.camera != b.camera && a.rules == b.rules && a.scene == b.scene
}

/// My camera, but for that in which the stages' cameras differ.
fn camera_of(mine: &Camera, base: &Camera, theirs: &Camera) -> Camera {
    fn choose<T: PartialEq>(mine: T, base: T, theirs: T) -> T {
        if base == theirs { mine } else { theirs }
    }
    Camera {
        look_from: choose(mine.look_from, base.look_from, theirs.look_from),
        look_at: choose(mine.look_at, base.look_at, theirs.look_at),
        vup: choose(mine.vup, base.vup, theirs.vup),
        vfov_degrees: choose(mine.vfov_degrees, base.vfov_degrees, theirs.vfov_degrees),
        defocus_angle_degrees: choose(
            mine.defocus_angle_degrees,
            base.defocus_angle_degrees,
            theirs.defocus_angle_degrees,
        ),
        focus_distance: choose(mine.focus_distance, base.focus_distance, theirs.focus_distance),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Surface;
    use crate::stress::shown_cases;

    #[test]
    fn the_others_camera_moves_along_but_keeps_its_own() {
        let base = Camera::BOOK;
        let theirs = Camera { vfov_degrees: 30.0, ..base };
        let mine = Camera { look_from: glam::DVec3::Z, vfov_degrees: 80.0, ..base };
        let camera = camera_of(&mine, &base, &theirs);
        assert_eq!((camera.look_from, camera.vfov_degrees), (glam::DVec3::Z, 30.0));
        assert_eq!(camera_of(&mine, &base, &base), mine);
    }

    #[test]
    fn the_other_stage_is_seen_by_my_camera_unless_that_is_the_difference() {
        let mut compare = Compare::default();
        let mut of_cameras = Vec::new();
        for stage in Stage::ALL {
            let mut mine = Document::new(Origin::of_stage(stage));
            mine.camera.look_from += glam::DVec3::new(0.25, 0.5, 0.125);
            let other = compare.other_of(stage).unwrap();
            let theirs = compare.document_of(Other::Stage(other), &mine);
            if compare.is_of_cameras(stage) {
                of_cameras.push(stage.id);
                assert_ne!(theirs.camera, mine.camera, "{}", stage.id);
            } else {
                assert_eq!(theirs.camera, mine.camera, "{}", stage.id);
            }
        }
        assert!(
            of_cameras.contains(&"view-distant") && !of_cameras.contains(&"glass-schlick"),
            "{of_cameras:?}"
        );
    }

    #[test]
    fn what_is_no_stage_is_compared_with_the_books_arithmetic() {
        let mut compare = Compare::default();
        for case in shown_cases() {
            let mine = Document::new(Origin::of_case(case));
            let other = compare.other(&mine).unwrap();
            assert_eq!(other, Other::ByTheBook(Arc::clone(&mine.origin)));
            let theirs = compare.document_of(other, &mine);
            assert_eq!(theirs.rules().surface, Surface::Book, "{}", case.id);
            assert_eq!(
                (theirs.camera, theirs.settings, theirs.stop),
                (mine.camera, mine.settings, mine.stop)
            );
        }
        let stage = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        assert!(matches!(compare.other(&stage), Some(Other::Stage(_))));
        compare.toggle(Mode::Wipe, true);
        assert!(matches!(compare.other(&stage), Some(Other::ByTheBook(_))));
        let no_rays = Document::new(Origin::of_stage(Stage::find("ppm-tiny").unwrap()));
        assert_eq!(compare.other(&no_rays), None);
    }

    #[test]
    fn every_stage_has_something_to_be_compared_with() {
        let mut compare = Compare::default();
        for stage in Stage::ALL {
            compare.is_with_next = false;
            let first = compare.other_of(stage);
            assert!(first.is_some_and(|other| other != stage));
            compare.is_with_next = true;
            assert!(compare.other_of(stage).is_some_and(|other| other != stage));
        }
    }
}
