//! Kept films: their pictures, the question whether one differs from the traced picture by noise alone, and the film on
//! the screen, which is the traced one or a kept one. What is kept is in the model.

#[cfg(test)]
pub mod tests;
mod verdict;

pub use verdict::Verdict;

use super::answers::{Answers, caught};
use super::model::{Document, Kept, ViewState};
use super::texture::Texture;
use super::tracer::Shown;
use super::tracing::Tracing;
use crate::denoise::Denoised;
use crate::film::Film;
use crate::progressive::{Status, View};
use eframe::egui::Context;
use std::sync::mpsc::{SendError, Sender, channel};
use std::sync::{Arc, LazyLock, Weak};

type Work = Box<dyn FnOnce() + Send>;

/// Does work on a kept film, which may take longer than a frame, after the work that was asked for before.
pub fn run(work: impl FnOnce() + Send + 'static) {
    static WORKER: LazyLock<Sender<Work>> = LazyLock::new(|| {
        let (sender, receiver) = channel::<Work>();
        // Whoever asked learns of a panic from the answer that never came.
        let work = move || receiver.iter().for_each(|work| _ = caught(work));
        // Without a thread, sending fails.
        let _ = std::thread::Builder::new().name("kept".to_owned()).spawn(work);
        sender
    });
    if let Err(SendError(work)) = WORKER.send(Box::new(work)) {
        let _ = caught(work);
    }
}

#[derive(Default)]
pub struct KeptActions {
    /// The pictures of the kept films that are shown.
    pub picture: KeptPicture,
    pub verdict: Verdict,
    pub copied: Answers<Kept>,
    /// The picture is to be kept as soon as it has samples.
    pub is_wanted: bool,
}

impl KeptActions {
    /// Copies the traced film if that was asked for and it has samples. The answer arrives in `copied`.
    pub fn follow(&mut self, context: &Context, document: &Document, tracing: &Tracing) {
        let Tracing { main, seconds_before, .. } = tracing;
        if !self.is_wanted || !main.has_samples(document) {
            return;
        }
        self.is_wanted = false;
        let (document, status, seconds_before) =
            (document.clone(), Arc::clone(main.status()), *seconds_before);
        let answer = self.copied.promise(context);
        main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give(copy.map(|film| Kept::new(document, film, status, seconds_before)));
        });
    }
}

struct Held {
    of: Weak<Kept>,
    view: View,
    shown: Shown,
}

/// The pictures of kept films that were shown. They stay, so that a flip between two doesn't flicker.
#[derive(Default)]
pub struct KeptPicture {
    held: Vec<Held>,
    /// The kept picture, the view, and three bytes per pixel.
    answers: Answers<(Arc<Kept>, View, Vec<u8>)>,
}

impl KeptPicture {
    /// The newest picture of `kept`.
    pub fn shown(&self, kept: &Kept) -> Option<&Shown> {
        self.held.iter().find(|held| held.of.as_ptr() == std::ptr::from_ref(kept)).map(|held| &held.shown)
    }

    /// Takes the picture that was resolved, and has the film resolved in `view` if that is another one.
    pub fn follow(&mut self, context: &Context, kept: &Arc<Kept>, view: &View) {
        while let Some(Ok((of, view, rgb8))) = self.answers.take() {
            self.hold(&of, view, &rgb8);
        }
        self.held.retain(|held| held.of.strong_count() > 0);
        let is_known = |held: &Held| held.of.as_ptr() == Arc::as_ptr(kept) && held.view.is_same(view);
        if self.answers.is_open() || self.held.iter().any(is_known) {
            return;
        }
        let answer = self.answers.answer(context);
        let (kept, view) = (Arc::clone(kept), view.clone());
        run(move || {
            let rgb8 = view.resolve(&kept.film, kept.document.rules().transfer, None);
            answer.give(Ok((kept, view, rgb8)));
        });
    }

    fn hold(&mut self, kept: &Arc<Kept>, view: View, rgb8: &[u8]) {
        let of = Arc::downgrade(kept);
        let place = self.held.iter().position(|held| held.of.ptr_eq(&of));
        let earlier = place.map(|place| self.held.swap_remove(place).shown.texture);
        let texture = Texture::new(kept.size(), rgb8, earlier);
        let (document, run) = (kept.document.clone(), kept.status.run);
        let shown = Shown { texture, samples: kept.samples(), divisor: 1, document, run };
        self.held.push(Held { of, view, shown });
    }
}

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
            Some(denoised) => run(move || look(&denoised.film)),
            None => self.inspect(look),
        }
    }

    /// Runs `look` with the film on another thread.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        match self.kept {
            Some(kept) => {
                let film = Arc::clone(&kept.film);
                run(move || look(&film));
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
