//! A kept film on the screen, for tests of what asks films.

use super::{FilmId, Query, Subject, run};
use crate::app::model::{Document, Kept, Origin, ViewState};
use crate::app::tracing::Tracing;
use crate::film::{Film, PixelSum};
use crate::progressive::Status;
use crate::stages::Stage;
use eframe::egui::Context;
use std::sync::Arc;
use std::sync::mpsc::channel;

/// Everything that a film on the screen needs.
pub struct OnScreen {
    live: Document,
    tracing: Tracing,
    view: ViewState,
}

impl OnScreen {
    /// Shows a kept film of a stage.
    pub fn new(film: Film) -> Self {
        OnScreen::of(Document::new(Origin::of_stage(Stage::find("metal").unwrap())), film)
    }

    /// Shows a kept film of a document.
    pub fn of(document: Document, film: Film) -> Self {
        let mut view = ViewState::default();
        let place = view.kept.add(Kept::new(document, film, Arc::default(), None));
        view.look(Some(place));
        let live = Document::new(Origin::usual());
        OnScreen { live, tracing: Tracing::new().unwrap(), view }
    }

    /// The film.
    pub fn subject(&self) -> Subject<'_> {
        Subject::new(&self.view, &self.live, &self.tracing)
    }

    /// Does this before the film answers anything, and waits until everything that it asks has been answered.
    pub fn before_answers<T>(&self, act: impl FnOnce(&Subject<'_>) -> T) -> T {
        let (open, gate) = channel::<()>();
        run(move || _ = gate.recv());
        let done = act(&self.subject());
        let (answer, answers) = channel();
        run(move || answer.send(()).unwrap());
        drop(open);
        answers.recv().unwrap();
        done
    }
}

/// A film of 4x2 pixels with this many samples, black but for the last pixel, whose values sum up to `sum`.
pub fn small_film(samples: u64, sum: f64) -> Film {
    let mut film = Film::new(4, 2, 1);
    film.halves_mut()[0][7] = PixelSum([(sum * f64::from(1 << 24)) as u64; 3]);
    film.record(0..samples, 0).unwrap();
    film
}

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
    let (screen, context) = (OnScreen::new(small_film(5, 0.5)), Context::default());
    let mut query = Query::default();
    let count = |film: &Film| Some(film.sample_count());
    for key in [1, 2] {
        screen.before_answers(|subject| {
            assert!(query.ask(&context, subject, key, count));
            assert!(!query.ask(&context, subject, key + 1, count), "the one before is open");
        });
        assert_eq!((query.take(), query.take()), (Some(5), None));
        screen.before_answers(|subject| assert!(!query.ask(&context, subject, key, count), "it is known"));
    }
    screen.before_answers(|subject| assert!(query.ask(&context, subject, 3, |_| None)));
    assert_eq!(query.take(), None);
    screen.before_answers(|subject| assert!(query.ask(&context, subject, 4, count)));
}
