//! Keeping pictures, and the question whether a kept one and the traced one differ only by noise: the statistics of
//! `weekender compare`, on a thread. The list of kept pictures is in the model.

use super::Tracing;
use super::tracer::Tracer;
use crate::app::model::{Document, Kept};
use crate::app::toolkit::{Answers, Query, theme};
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

/// The answer about a kept picture and a run of the render, or that it is awaited.
#[derive(Default)]
pub struct Verdict(pub Query<(u64, u64), Answer>);

impl Verdict {
    /// Compares a kept picture with the one that `main` traces for `live`. An earlier question is forgotten.
    pub fn ask(&mut self, context: &Context, kept: &Arc<Kept>, (live, main): (&Document, &Tracer)) {
        *self = Verdict::default();
        let Some(answer) = self.0.ask(context, (kept.number, main.status().run)) else { return };
        let (kept, recipe) = (Arc::clone(kept), live.recipe());
        main.inspect(move |film| match film.try_copy() {
            Ok(film) => answer.give_from("compare", move || compared(&kept, recipe, film)),
            Err(error) => answer.give(Err(error.to_string())),
        });
    }

    /// Draws the answer, if it is about this kept picture and this run. Returns whether it is.
    pub fn ui(&self, ui: &mut Ui, kept: u64, run: u64) -> bool {
        if self.0.asked != Some((kept, run)) {
            return false;
        }
        let colours = theme::colours(ui);
        let (color, headline, words) = match &self.0 {
            Query { fault: Some(reason), .. } => (colours.bad, "Not compared:", reason.as_str()),
            Query { answer: Some(Answer { is_equal, headline, words }), .. } => {
                let color = if *is_equal { colours.good } else { colours.warn };
                (color, *headline, words.as_str())
            }
            _ => (colours.weak, "Comparing\u{2026}", ""),
        };
        ui.label(RichText::new(headline).small().color(color));
        ui.label(RichText::new(words).small());
        true
    }
}

fn compared(kept: &Kept, recipe: Recipe, film: Film) -> Result<Answer, String> {
    let picture = |name: &str, recipe: Recipe, film| {
        Picture::of_rendered(name.to_owned(), Some(&recipe), film).map_err(|error| error.to_string())
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
