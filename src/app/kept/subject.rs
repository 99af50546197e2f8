//! The film on the screen: the live one, or one that was kept.

use crate::app::answers::Answers;
use crate::app::model::{Document, Kept, ViewState};
use crate::app::tracing::Tracing;
use crate::denoise::Denoised;
use crate::film::Film;
use crate::progressive::Status;
use eframe::egui::Context;
use std::sync::Arc;

/// Tells films apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmId {
    /// The film of a run of the render thread.
    Live(u64),
    /// The film of a kept picture.
    Kept(u64),
    /// The denoised picture of a film, by its samples.
    Denoised(u64),
}

/// The film on the screen.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    live: &'a Document,
    tracing: &'a Tracing,
    kept: Option<&'a Arc<Kept>>,
    pub denoised: Option<&'a Arc<Denoised>>,
}

impl<'a> Subject<'a> {
    /// What `view` looks at: the film that is traced for `live`, or a kept one.
    pub fn new(view: &'a ViewState, live: &'a Document, tracing: &'a Tracing) -> Self {
        let subject = Subject { live, tracing, kept: view.kept.shown(), denoised: None };
        Subject { denoised: view.denoised_of(subject.raw_id()), ..subject }
    }

    /// Whether it is a kept film.
    pub fn is_kept(&self) -> bool {
        self.kept.is_some()
    }

    /// The document that it shows.
    pub fn document(&self) -> &'a Document {
        self.kept.map_or(self.live, |kept| &kept.document)
    }

    /// Which picture it is.
    pub fn film_id(&self) -> FilmId {
        self.denoised.map_or(self.raw_id(), |denoised| FilmId::Denoised(denoised.film.sample_count()))
    }

    /// Which film it is, denoised or not.
    pub fn raw_id(&self) -> FilmId {
        self.kept.map_or(FilmId::Live(self.tracing.main.status().run), |kept| FilmId::Kept(kept.number))
    }

    /// The status of its render.
    pub fn status(&self) -> &'a Arc<Status> {
        self.kept.map_or(self.tracing.main.status(), |kept| &kept.status)
    }

    /// Tracing time of its samples from before that render, if known.
    pub fn seconds_before(&self) -> Option<f64> {
        self.kept.map_or(self.tracing.seconds_before, |kept| kept.seconds_before)
    }

    /// Samples per pixel of the film.
    pub fn samples(&self) -> u64 {
        self.kept.map_or(self.tracing.main.status().samples_per_pixel, |kept| kept.samples())
    }

    /// Samples per pixel of the film's newest picture; 0 as long as only that of an earlier film is there.
    pub fn shown_samples(&self) -> u64 {
        let run = self.tracing.main.status().run;
        let of_live =
            || self.tracing.main.shown().filter(|shown| shown.run == run).map_or(0, |shown| shown.samples);
        self.kept.map_or_else(of_live, |kept| kept.samples())
    }

    /// Whether it is the film of its document at full size.
    pub fn is_full(&self) -> bool {
        self.kept.is_some() || self.tracing.main.is_full(self.live)
    }

    /// Whether it is the film of its document at full size, and has samples.
    pub fn has_samples(&self) -> bool {
        self.kept.is_some() || self.tracing.main.has_samples(self.live)
    }

    /// Runs `look` with what is shown, the film or its denoised picture, on another thread.
    pub fn inspect_shown(&self, look: impl FnOnce(&Film) + Send + 'static) {
        match self.denoised.map(Arc::clone) {
            Some(denoised) => super::run(move || look(&denoised.film)),
            None => self.inspect(look),
        }
    }

    /// Runs `look` with the film on another thread.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        match self.kept {
            Some(kept) => {
                let film = Arc::clone(&kept.film);
                super::run(move || look(&film));
            }
            None => self.tracing.main.inspect(look),
        }
    }
}

/// A question about the film on the screen, which is asked again when `K` has changed, one at a time.
pub struct Query<K, T> {
    pub asked: Option<K>,
    answers: Answers<T>,
}

impl<K, T> Default for Query<K, T> {
    fn default() -> Self {
        Query { asked: None, answers: Answers::default() }
    }
}

impl<K: PartialEq, T: Send + 'static> Query<K, T> {
    /// Takes the newest answer.
    pub fn take(&mut self) -> Option<T> {
        std::iter::from_fn(|| self.answers.take()).last().and_then(Result::ok)
    }

    /// Asks about `key`, unless that was asked last, or the question before is open. `look` finds the answer, if any, in the
    /// film. Returns whether it was asked.
    pub fn ask(
        &mut self,
        context: &Context,
        subject: &Subject<'_>,
        key: K,
        look: impl FnOnce(&Film) -> Option<T> + Send + 'static,
    ) -> bool {
        if self.answers.is_open() || self.asked.as_ref() == Some(&key) {
            return false;
        }
        self.asked = Some(key);
        let answer = self.answers.answer(context);
        subject
            .inspect_shown(move |film| look(film).into_iter().for_each(|found| answer.give_one(Ok(found))));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::stages::Stage;
    use std::sync::mpsc::channel;

    #[test]
    fn a_kept_film_takes_the_place_of_the_live_one() {
        let mut tracing = Tracing::new().unwrap();
        tracing.seconds_before = Some(2.0);
        let (live, mut view) = (Document::new(Origin::usual()), ViewState::default());
        let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let mut film = Film::new(4, 2, 1);
        film.record(0..7, 0).unwrap();
        let status = Status { run: 3, ..Status::default() };
        let place = view.kept.add(Kept::new(document, film, Arc::new(status), Some(5.0)));
        let kept = Arc::clone(view.kept.get(place).unwrap());
        let subject = Subject::new(&view, &live, &tracing);
        assert!(std::ptr::eq(subject.document(), &live) && !subject.is_kept() && !subject.has_samples());
        assert_eq!((subject.film_id(), subject.seconds_before()), (FilmId::Live(0), Some(2.0)));
        view.look(Some(place));
        let subject = Subject::new(&view, &live, &tracing);
        assert!(std::ptr::eq(subject.document(), &kept.document));
        assert!(subject.is_kept() && subject.is_full() && subject.has_samples());
        assert_eq!((subject.film_id(), subject.status().run), (FilmId::Kept(kept.number), 3));
        assert_eq!((subject.samples(), subject.shown_samples(), subject.seconds_before()), (7, 7, Some(5.0)));
        let (answer, answers) = channel();
        subject.inspect(move |film| answer.send(film.sample_count()).unwrap());
        assert_eq!(answers.recv().unwrap(), 7);
    }

    #[test]
    fn a_question_is_asked_again_when_its_subject_has_changed() {
        use crate::app::kept::tests::{OnScreen, small_film};
        let (screen, context) = (OnScreen::new(small_film(5, 0.5)), Context::default());
        let mut query = Query::default();
        let count = |film: &Film| Some(film.sample_count());
        for key in [1, 2] {
            screen.before_answers(|subject| {
                assert!(query.ask(&context, subject, key, count));
                assert!(!query.ask(&context, subject, key + 1, count), "the one before is open");
            });
            assert_eq!((query.take(), query.take()), (Some(5), None));
            screen
                .before_answers(|subject| assert!(!query.ask(&context, subject, key, count), "it is known"));
        }
        screen.before_answers(|subject| assert!(query.ask(&context, subject, 3, |_| None)));
        assert_eq!(query.take(), None);
        screen.before_answers(|subject| assert!(query.ask(&context, subject, 4, count)));
    }
}
