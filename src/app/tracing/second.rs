//! The second picture for the wipe and the difference: another stage, the same picture by the book's own arithmetic, or a
//! picture that was kept.

use super::tracer::{Shown, Tracer, Want};
use crate::app::model::{Document, Kept, Mode, Origin, Other, ViewState, differ_in_camera};
use crate::app::toolkit::{Answers, Texture};
use crate::film::Film;
use crate::progressive::{ReferenceMeans, View};
use eframe::egui::Context;
use std::sync::Arc;

/// The second picture.
#[derive(Default)]
pub struct Second {
    /// `None` until another picture is traced.
    pub tracer: Option<Tracer>,
    /// The picture that was traced last.
    pub of: Option<(Other, Arc<Origin>)>,
    /// Its film when it was last read.
    film: Option<Arc<ReferenceMeans>>,
    films: Answers<Arc<ReferenceMeans>>,
    /// Kept pictures by number and view, which a thread makes. All stay, so that a flip between two does not flicker.
    resolved: Vec<(u64, View, Shown)>,
    /// The kept picture, the view, and three bytes per pixel.
    resolving: Answers<(Arc<Kept>, View, Vec<u8>)>,
}

/// The film of the second picture.
#[derive(Clone, Copy)]
pub enum OtherFilm<'a> {
    Kept(&'a Kept),
    Traced(&'a Tracer, &'a Shown),
}

impl OtherFilm<'_> {
    pub fn document(&self) -> &Document {
        match self {
            OtherFilm::Kept(kept) => &kept.document,
            OtherFilm::Traced(_, shown) => &shown.document,
        }
    }

    /// Tells films and their states apart.
    pub fn id(&self) -> (u64, u64) {
        match self {
            OtherFilm::Kept(kept) => (kept.number, u64::MAX),
            OtherFilm::Traced(_, shown) => (shown.run, shown.samples),
        }
    }

    /// Runs `look` with the film, on the render thread if there is one.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        match self {
            OtherFilm::Kept(kept) => look(&kept.film),
            OtherFilm::Traced(tracer, _) => tracer.inspect(look),
        }
    }
}

impl Second {
    /// The newest second picture.
    pub fn shown(&self, view: &ViewState) -> Option<&Shown> {
        match view.compared_kept() {
            Some(kept) => {
                let resolved = self.resolved.iter().find(|(number, ..)| *number == kept.number);
                resolved.map(|(_, _, shown)| shown)
            }
            None => self.tracer.as_ref().and_then(Tracer::shown),
        }
    }

    /// The second picture, to read its numbers.
    pub fn film<'a>(&'a self, view: &'a ViewState) -> Option<OtherFilm<'a>> {
        match view.compared_kept() {
            Some(kept) => Some(OtherFilm::Kept(kept)),
            None => self.tracer.as_ref().and_then(|tracer| Some(OtherFilm::Traced(tracer, tracer.shown()?))),
        }
    }

    /// The film of the second picture, if it is known.
    pub fn means<'a>(&'a self, view: &'a ViewState) -> Option<&'a Arc<ReferenceMeans>> {
        view.compared_kept().map(|kept| &kept.means).or(self.film.as_ref())
    }

    /// Makes the second picture, if one is needed; `want` is what the main picture renders. Returns whether there is one.
    pub fn follow(&mut self, context: &Context, view: &ViewState, want: &Want<'_>) -> bool {
        if let Some(Ok(film)) = self.films.take() {
            self.film = Some(film);
        }
        let other = view.compared(want.document);
        if other.is_none() || view.mode() != Some(Mode::Difference) {
            self.film = None;
        }
        let Some(other) = other else {
            self.tracer.iter_mut().for_each(Tracer::abandon);
            self.follow_kept(context, view);
            return view.compared_kept().is_some();
        };
        let document = self.document_of(other, want.document);
        if self.tracer.is_none() {
            // Without a thread there is no second picture, but everything else works.
            self.tracer = Tracer::new().ok();
            self.tracer.iter().for_each(|tracer| tracer.wake(context));
        }
        let Some(tracer) = &mut self.tracer else { return false };
        let is_new = tracer.poll(context).is_some();
        // Both pictures have the same stop condition, so that they do not differ in their noise.
        let (stop, tone) = (document.stop, view.tone.of_picture());
        let outcome = tracer.want(&Want { document: &document, stop, view: tone, ..*want }, None);
        let is_due = view.mode() == Some(Mode::Difference) && (is_new || self.film.is_none());
        let has_film = tracer.is_full(&document) && tracer.has_picture(&document);
        if is_due && has_film && !self.films.is_open() {
            let answer = self.films.answer(context);
            tracer.inspect(move |film| answer.give(Ok(Arc::new(ReferenceMeans::of(film)))));
        }
        outcome.is_ok()
    }

    /// Takes kept pictures that were made, and has the shown one made in another view.
    fn follow_kept(&mut self, context: &Context, view: &ViewState) {
        while let Some(Ok((of, in_view, rgb8))) = self.resolving.take() {
            let place = self.resolved.iter().position(|(number, ..)| *number == of.number);
            let earlier = place.map(|place| self.resolved.swap_remove(place).2.texture);
            let texture = Texture::new(of.size(), &rgb8, earlier);
            let document = of.document.clone();
            let shown = Shown { texture, samples: of.samples(), divisor: 1, document, run: 0 };
            self.resolved.push((of.number, in_view, shown));
        }
        self.resolved.retain(|(number, ..)| view.kept.iter().any(|kept| kept.number == *number));
        let (Some(kept), in_view) = (view.compared_kept(), view.tone.of_picture()) else { return };
        let is_known = |(number, of, _): &(u64, View, Shown)| *number == kept.number && of.is_same(&in_view);
        if !self.resolving.is_open() && !self.resolved.iter().any(is_known) {
            let kept = Arc::clone(kept);
            self.resolving.ask("kept", context, move || {
                let rgb8 = in_view.resolve(&kept.film, kept.document.rules().transfer, None);
                Ok((kept, in_view, rgb8))
            });
        }
    }

    fn document_of(&mut self, other: Other, mine: &Document) -> Document {
        if self.of.as_ref().is_some_and(|(before, _)| *before != other) {
            // A late answer about the film of before is lost with its slot.
            (self.of, self.film, self.films) = (None, None, Answers::default());
        }
        let (_, origin) = self.of.get_or_insert_with(|| {
            let origin = Arc::new(other.origin());
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::{differ_in_camera, partner};
    use crate::measure::stress::shown_cases;
    use crate::stages::{Stage, SurfaceRule};

    #[test]
    fn a_film_is_taken_only_for_the_picture_that_is_compared() {
        let (mut second, context) = (Second::default(), Context::default());
        let mine = Document::new(Origin::of_stage(&Stage::ALL[0]));
        second.document_of(Other::Stage(&Stage::ALL[0]), &mine);
        let late = second.films.answer(&context);
        second.document_of(Other::Stage(&Stage::ALL[1]), &mine);
        late.give(Ok(Arc::new(ReferenceMeans { width: 1, height: 1, means: vec![[0.5; 3]] })));
        assert!(second.films.take().is_none(), "another picture is compared meanwhile");
    }

    #[test]
    fn the_other_stage_shares_the_camera_unless_cameras_differ() {
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
