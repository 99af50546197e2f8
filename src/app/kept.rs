//! Keeping pictures, and the question whether a kept one and the traced one differ only by noise: the statistics of
//! `weekender compare`, on a thread. The list of kept pictures is in the model.

use super::answers::Answers;
use super::model::{Document, Kept};
use super::theme;
use super::tracer::Tracer;
use super::tracing::Tracing;
use crate::film::Film;
use crate::job::recipe::Recipe;
use crate::pictures::{Picture, compare};
use eframe::egui::{Context, RichText, Ui};
use std::sync::Arc;

#[derive(Default)]
pub struct KeptActions {
    pub verdict: Verdict,
    pub copied: Answers<Kept>,
    /// The picture is to be kept as soon as it has samples.
    pub is_wanted: bool,
}

impl KeptActions {
    /// Copies the traced film if that was asked for and it has samples. The answer arrives in `copied`.
    pub fn follow(&mut self, context: &Context, document: &Document, tracing: &Tracing) {
        if !self.is_wanted || !tracing.main.has_samples(document) {
            return;
        }
        self.is_wanted = false;
        let (document, answer) = (document.clone(), self.copied.promise(context));
        let (seconds, context) = (tracing.seconds(), context.clone());
        tracing.main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give_from("keep", move || copy.map(|film| Kept::new(&context, document, film, seconds)));
        });
    }
}

/// Deviations of noise that hardly any block exceeds.
const CLEAR: f64 = 4.0;

/// The answer in two sentences.
pub struct Answer {
    is_equal: bool,
    pub headline: &'static str,
    pub words: String,
}

/// The answer about a kept picture, or that it is awaited.
#[derive(Default)]
pub struct Verdict {
    /// The kept picture and the run of the render that it is compared with.
    of: Option<(u64, u64)>,
    /// None until it is there; else the answer, or why there is none.
    pub answer: Option<Result<Answer, String>>,
    answers: Answers<Answer>,
}

impl Verdict {
    /// Compares a kept picture with the one that `main` traces for `live`. An earlier question is forgotten.
    pub fn ask(&mut self, context: &Context, kept: &Arc<Kept>, (live, main): (&Document, &Tracer)) {
        let of = Some((kept.number, main.status().run));
        *self = Verdict { of, ..Verdict::default() };
        let (kept, recipe) = (Arc::clone(kept), live.recipe());
        let answer = self.answers.promise(context);
        main.inspect(move |film| match film.try_copy() {
            Ok(film) => answer.give_from("compare", move || compared(&kept, recipe, film)),
            Err(error) => answer.give(Err(error.to_string())),
        });
    }

    /// Takes the answer.
    pub fn receive(&mut self) {
        self.answer = self.answers.take().or(self.answer.take());
    }

    /// Draws the answer, if it is about this kept picture and this run. Returns whether it is.
    pub fn ui(&self, ui: &mut Ui, kept: u64, run: u64) -> bool {
        if self.of != Some((kept, run)) {
            return false;
        }
        let colours = theme::colours(ui);
        let (color, headline, words) = match &self.answer {
            None => (colours.weak, "Comparing\u{2026}", ""),
            Some(Err(reason)) => (colours.bad, "Not compared:", reason.as_str()),
            Some(Ok(Answer { is_equal, headline, words })) => {
                let color = if *is_equal { colours.good } else { colours.warn };
                (color, *headline, words.as_str())
            }
        };
        ui.label(RichText::new(headline).small().color(color));
        ui.label(RichText::new(words).small());
        true
    }
}

fn compared(kept: &Kept, recipe: Recipe, film: Film) -> Result<Answer, String> {
    let picture = |name: &str, recipe: Recipe, film| {
        Picture::of_rendered(name.to_owned(), &recipe, film).map_err(|error| error.to_string())
    };
    let sides = [
        picture("kept", kept.document.recipe(), Arc::clone(&kept.film))?,
        picture("traced", recipe, Arc::new(film))?,
    ];
    let comparison = compare::compare_sides(&sides).map_err(|error| error.to_string())?;
    let is_equal = comparison.is_equal();
    let (headline, words) = match &comparison.unclear {
        _ if is_equal && comparison.is_same => ("Identical to the bit.", String::new()),
        _ if is_equal => ("Only noise.", "Nothing differs by more than chance.".to_owned()),
        Some(_) => ("Too early to tell.", "Both need more samples.".to_owned()),
        None => {
            let blocks = &comparison.test.blocks;
            let clear = blocks.iter().filter(|block| block.largest() > CLEAR).count();
            let share = (100 * clear).div_ceil(blocks.len().max(1));
            ("More than noise.", format!("{share} % of the blocks differ clearly."))
        }
    };
    Ok(Answer { is_equal, headline, words })
}
