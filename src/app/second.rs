//! The second picture for the wipe and the difference: another stage, the same picture by the book's own arithmetic, or a
//! picture that was kept.

use super::answers::Answers;
use super::model::{Document, Kept, Mode, Origin, Other, ViewState, differ_in_camera};
use super::texture::Texture;
use super::tracer::{Shown, Tracer, Want};
use crate::progressive::{ReferenceMeans, View};
use eframe::egui::Context;
use std::sync::Arc;

/// The second picture.
#[derive(Default)]
pub struct Second {
    /// `None` until a second picture is needed.
    tracer: Option<Tracer>,
    pub of: Option<(Other, Arc<Origin>)>,
    /// The picture, if it was kept.
    picture: KeptPicture,
    /// Its film when it was last read.
    pub film: Option<Arc<ReferenceMeans>>,
    films: Answers<(Arc<Origin>, Arc<ReferenceMeans>)>,
}

impl Second {
    /// The newest second picture.
    pub fn shown(&self, view: &ViewState) -> Option<&Shown> {
        match view.compared_kept() {
            Some(place) => self.picture.shown(view.kept.get(place)?),
            None => self.tracer.as_ref().and_then(Tracer::shown),
        }
    }

    pub fn pause(&self) {
        self.tracer.iter().for_each(Tracer::pause);
    }

    pub fn resume(&self) {
        self.tracer.iter().for_each(Tracer::resume);
    }

    /// Takes the film if it has been read.
    pub fn receive(&mut self) {
        while let Some(Ok((origin, film))) = self.films.take() {
            if self.of.as_ref().is_some_and(|(_, of)| Arc::ptr_eq(of, &origin)) {
                self.film = Some(film);
            }
        }
    }

    /// Renders the second picture, if one is needed; `want` is what the main picture renders. Returns whether one is
    /// needed.
    pub fn follow(&mut self, context: &Context, view: &ViewState, want: &Want<'_>) -> bool {
        let Some(other) = view.compared(want.document) else {
            if let Some(tracer) = &mut self.tracer {
                tracer.abandon();
            }
            self.film = None;
            // A kept picture may have been deleted.
            self.of = self.of.take().filter(|(other, _)| !matches!(other, Other::Kept(_)));
            return false;
        };
        if let Other::Kept(kept) = other {
            self.follow_kept(context, view, kept);
            return true;
        }
        let document = self.document_of(other, want.document);
        if self.tracer.is_none() {
            // Without a thread there is no second picture, but everything else works.
            self.tracer = Tracer::new().ok();
            if let Some(tracer) = &self.tracer {
                tracer.wake(context);
            }
        }
        let Some(tracer) = &mut self.tracer else { return false };
        let is_new = tracer.poll(context).is_some();
        // Both pictures have the same stop condition, so that they do not differ in their noise.
        let stop = document.stop;
        let is_possible =
            tracer.want(&Want { document: &document, stop, view: view.tone.of_picture(), ..*want }).is_ok();
        let is_full = tracer.is_full(&document);
        let has_picture = tracer.has_picture(&document);
        let is_waiting = self.films.is_open();
        if view.mode() != Some(Mode::Difference) {
            self.film = None;
        } else if is_full && has_picture && !is_waiting && (is_new || self.film.is_none()) {
            let (answer, origin) = (self.films.answer(context), Arc::clone(&document.origin));
            tracer.inspect(move |film| {
                answer.give(Ok((origin, Arc::new(ReferenceMeans::of(film)))));
            });
        }
        is_possible
    }

    /// Shows a picture that was kept.
    fn follow_kept(&mut self, context: &Context, view: &ViewState, kept: Arc<Kept>) {
        if let Some(tracer) = &mut self.tracer {
            tracer.abandon();
        }
        self.picture.resolved.retain(|(number, ..)| view.kept.iter().any(|kept| kept.number == *number));
        self.picture.follow(context, &kept, &view.tone.of_picture());
        self.film = (view.mode() == Some(Mode::Difference)).then(|| Arc::clone(&kept.means));
        let origin = Arc::clone(&kept.document.origin);
        self.of = Some((Other::Kept(kept), origin));
    }

    fn document_of(&mut self, other: Other, mine: &Document) -> Document {
        if self.of.as_ref().is_none_or(|(kept, _)| *kept != other) {
            (self.of, self.film) = (None, None);
        }
        let (_, origin) = self.of.get_or_insert_with(|| {
            let origin = other.origin();
            (other, origin)
        });
        let (theirs, base) = (&origin.recipe, &mine.origin.recipe);
        let mut settings = mine.settings;
        if theirs.settings.max_depth != base.settings.max_depth {
            settings.max_depth = theirs.settings.max_depth;
        }
        let usual_stop = origin.usual_stop();
        let stop = if usual_stop == mine.origin.usual_stop() { mine.stop } else { usual_stop };
        let camera = if differ_in_camera(base, theirs) { theirs.camera } else { mine.camera };
        Document { camera, settings, stop, ..Document::of(Arc::clone(origin)) }
    }
}

/// The pictures of kept films, resolved on a thread. All stay, so that a flip between two does not flicker.
#[derive(Default)]
struct KeptPicture {
    /// The number of the kept picture, the view, and its picture.
    resolved: Vec<(u64, View, Shown)>,
    /// The kept picture, the view, and three bytes per pixel.
    answers: Answers<(Arc<Kept>, View, Vec<u8>)>,
}

impl KeptPicture {
    /// The newest picture of `kept`.
    fn shown(&self, kept: &Kept) -> Option<&Shown> {
        self.resolved.iter().find(|(of, ..)| *of == kept.number).map(|(_, _, shown)| shown)
    }

    /// Takes the picture that was resolved, and has the film resolved in `view` if that is another one.
    fn follow(&mut self, context: &Context, kept: &Arc<Kept>, view: &View) {
        while let Some(Ok((of, view, rgb8))) = self.answers.take() {
            let place = self.resolved.iter().position(|(number, ..)| *number == of.number);
            let earlier = place.map(|place| self.resolved.swap_remove(place).2.texture);
            let texture = Texture::new(of.size(), &rgb8, earlier);
            let document = of.document.clone();
            let shown = Shown { texture, samples: of.samples(), divisor: 1, document, run: 0 };
            self.resolved.push((of.number, view, shown));
        }
        let is_known = |(of, in_view, _): &(u64, View, Shown)| *of == kept.number && in_view.is_same(view);
        if self.answers.is_open() || self.resolved.iter().any(is_known) {
            return;
        }
        let (kept, view) = (Arc::clone(kept), view.clone());
        self.answers.ask("kept", context, move || {
            let rgb8 = view.resolve(&kept.film, kept.document.rules().transfer, None);
            Ok((kept, view, rgb8))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::{differ_in_camera, partner};
    use crate::measure::stress::shown_cases;
    use crate::stages::{Stage, SurfaceRule};

    #[test]
    fn a_film_is_taken_only_for_the_picture_that_is_compared() {
        let (mut second, context) = (Second::default(), Context::default());
        let stage = &Stage::ALL[0];
        let [mine, other] = [(); 2].map(|()| Arc::new(Origin::of_stage(stage)));
        let film = || ReferenceMeans { width: 1, height: 1, means: vec![[0.5; 3]] };
        let answer = |second: &mut Second, origin: &Arc<Origin>| {
            second.films.answer(&context).give(Ok((Arc::clone(origin), Arc::new(film()))));
            second.receive();
            second.film.as_ref().is_some()
        };
        assert!(!answer(&mut second, &mine), "the comparison is over");
        second.of = Some((Other::Stage(stage), Arc::clone(&mine)));
        assert!(!answer(&mut second, &other), "another picture is compared by now");
        assert!(answer(&mut second, &mine));
    }

    #[test]
    fn the_other_stage_is_seen_by_my_camera_unless_that_is_the_difference() {
        let mut second = Second::default();
        let mut of_cameras = Vec::new();
        for stage in Stage::ALL {
            let mut mine = Document::new(Origin::of_stage(stage));
            mine.camera.look_from += glam::DVec3::new(0.25, 0.5, 0.125);
            let Some(other) = partner(stage) else { continue };
            let theirs = second.document_of(Other::Stage(other), &mine);
            if partner(stage).is_some_and(|other| differ_in_camera(&stage.recipe(), &other.recipe())) {
                of_cameras.push(stage.id);
                assert_ne!(theirs.camera, mine.camera, "{}", stage.id);
            } else {
                assert_eq!(theirs.camera, mine.camera, "{}", stage.id);
            }
        }
        assert!(of_cameras.contains(&"fov-wide") && !of_cameras.contains(&"glass-schlick"), "{of_cameras:?}");
    }

    #[test]
    fn the_book_traces_the_same_picture_by_its_own_rules() {
        let mut second = Second::default();
        for case in shown_cases() {
            let mine = Document::new(Origin::of_case(case));
            let other = Other::ByTheBook(Arc::clone(&mine.origin), Arc::clone(&mine.checked));
            let theirs = second.document_of(other, &mine);
            assert_eq!(theirs.rules().surface, SurfaceRule::Book, "{}", case.id);
            assert_eq!(
                (theirs.camera, theirs.settings, theirs.stop),
                (mine.camera, mine.settings, mine.stop)
            );
        }
    }
}
