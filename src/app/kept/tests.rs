//! A kept film on the screen, for tests of what asks films.

use super::{Subject, run};
use crate::app::model::{Document, Kept, Origin, ViewState};
use crate::app::tracing::Tracing;
use crate::film::{Film, PixelSum};
use crate::stages::Stage;
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
