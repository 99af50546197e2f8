//! Keeping pictures, and the question whether two pictures differ only by noise: the statistics of `weekender compare`, on
//! a thread. The list of kept pictures is in the model.

use super::Tracing;
use super::second::{Other, OtherId};
use super::tracer::Tracer;
use crate::app::commands::Verdict;
use crate::app::model::changes::Changed;
use crate::app::model::{Kept, Model, Partner, Wish};
use crate::app::toolkit::{Answers, Query};
use crate::comparison::{Picture, compare};
use crate::film::Film;
use crate::job::recipe::Recipe;
use eframe::egui::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::channel;

/// The other picture, and the run and the samples of this one.
type Sides = (OtherId, u64, u64);

#[derive(Default)]
pub struct KeptActions {
    pub verdict: Query<Sides, Verdict>,
    pub copied: Answers<Kept>,
    /// Pictures of files, to compare with.
    pub files: Answers<Kept>,
    /// The picture is to be kept.
    pub wanted: Wish<()>,
    /// The picture is to be tested against this partner.
    pub asked: Wish<Partner>,
}

impl KeptActions {
    /// Copies the traced film if that was asked for and it has samples. The answer arrives in `copied`. Compares two films
    /// of the same samples once both are done.
    pub fn follow(&mut self, context: &Context, model: &Model, tracing: &Tracing, changed: Changed) {
        self.verdict.follow();
        let document = &model.document;
        let has_samples = tracing.main.has_samples(document);
        if let Some(Ok(())) = self.wanted.take(document, has_samples) {
            let (document, answer) = (document.clone(), self.copied.promise(context));
            tracing.main.inspect(move |film| {
                let copy = film.try_copy().map_err(|error| error.to_string());
                answer.give_from("keep", move || copy.map(|film| Kept::new(document, film)));
            });
        }
        let is_other = |asked: &Partner| model.view.mode().is_none() || *asked != model.view.partner;
        if changed.partner && self.asked.open().is_some_and(is_other) {
            self.asked = Wish::default();
        }
        if !has_samples {
            return;
        }
        if let Some(other) = tracing.other(model).filter(Other::is_ready) {
            let is_over = |tracer: &Tracer| tracer.status().phase.is_over();
            let samples = |tracer: &Tracer| tracer.status().samples_per_pixel;
            let is_due = matches!(other, Other::Traced(partner, tracer, _)
                if partner.has_same_samples()
                    && is_over(tracer)
                    && is_over(&tracing.main)
                    && (samples(tracer) == samples(&tracing.main) || document.stop.seconds.is_some()));
            let sides = sides(&other, tracing);
            let is_asked = matches!(self.asked.take(document, true), Some(Ok(_)));
            if is_asked || is_due && self.verdict.asked != Some(sides) {
                self.ask(context, model, tracing, sides);
            }
        }
    }

    /// Reads the picture of a file, to compare with.
    pub fn read(&mut self, context: &Context, model: &Model, path: PathBuf) {
        let transfer = model.document.rules().transfer;
        self.files.ask("compare", context, move || Kept::read(&path, transfer));
    }

    /// Compares the other picture with the traced one. An earlier question is forgotten.
    fn ask(&mut self, context: &Context, model: &Model, tracing: &Tracing, sides: Sides) {
        self.verdict = Query::default();
        let Some(other) = tracing.other(model) else { return };
        let Some(answer) = self.verdict.ask(context, sides) else { return };
        let (sender, other_film) = channel();
        let theirs = other.document().map(|document| document.recipe());
        let has_same_samples = other.id().0.has_same_samples()
            || other.document().is_some_and(|other| other.has_same_film(&model.document));
        let of_file = match other {
            Other::Kept(kept) => kept.picture.clone(),
            Other::Traced(..) => None,
        };
        other.inspect(move |film| _ = sender.send(film.try_copy()));
        let mine = model.document.recipe();
        tracing.main.inspect(move |film| match film.try_copy() {
            Ok(film) => answer.give_from("compare", move || {
                let other_film = other_film.recv().map_err(|_| "it has no picture yet".to_owned())?;
                let other_film = other_film.map_err(|error| error.to_string())?;
                let theirs = of_file.map_or_else(|| picture("other", theirs, other_film), Ok)?;
                compared(&[theirs, picture("traced", Some(mine), film)?], has_same_samples)
            }),
            Err(error) => answer.give(Err(error.to_string())),
        });
    }

    /// The verdict on the difference of the two pictures, or that it is awaited.
    pub fn verdict(&self, model: &Model, tracing: &Tracing) -> Option<Verdict> {
        let (id, run, _) = sides(&tracing.other(model)?, tracing);
        let (asked, of_run, _) = self.verdict.asked?;
        if (asked.0, asked.1, of_run) != (id.0, id.1, run) {
            return None;
        }
        let said = |headline, words: &str| Verdict { is_equal: None, headline, words: words.to_owned() };
        Some(match &self.verdict {
            Query { fault: Some(reason), .. } => said("Not compared:", reason),
            Query { answer: Some(verdict), .. } => verdict.clone(),
            _ => said("Comparing\u{2026}", ""),
        })
    }
}

fn sides(other: &Other<'_>, tracing: &Tracing) -> Sides {
    let status = tracing.main.status();
    (other.id(), status.run, status.samples_per_pixel)
}

/// Deviations of noise that hardly any block exceeds.
const CLEAR: f64 = 4.0;

/// Pictures of the same samples differ by less than this share of their noise.
const ROUNDING: f64 = 0.3;

fn picture(name: &str, recipe: Option<Recipe>, film: Film) -> Result<Picture, String> {
    Picture::of_rendered(name.to_owned(), recipe.as_ref(), Arc::new(film)).map_err(|error| error.to_string())
}

fn compared(sides: &[Picture; 2], has_same_samples: bool) -> Result<Verdict, String> {
    let comparison = compare::compare_sides(sides).map_err(|error| error.to_string())?;
    let is_equal = comparison.is_equal();
    let share_of_noise = comparison.times_noise();
    let (headline, words) = match &comparison.unclear {
        _ if is_equal && comparison.is_same => ("Equal to the bit.", String::new()),
        _ if is_equal && has_same_samples && share_of_noise < ROUNDING => {
            let pixels = sides[0].pixels.iter().zip(&sides[1].pixels);
            let differing = pixels.filter(|(a, b)| a != b).count();
            let share = 100.0 * differing as f64 / sides[0].pixels.len().max(1) as f64;
            let noise = 100.0 * share_of_noise;
            ("Only rounding.", format!("{share:.1} % of the pixels differ, by {noise:.1} % of the noise."))
        }
        _ if is_equal => ("Only noise.", "Nothing differs by more than chance.".to_owned()),
        Some(_) => ("Too early to tell.", "Both need more samples.".to_owned()),
        None => {
            let blocks = &comparison.test.blocks;
            let clear = blocks.iter().filter(|block| block.largest() > CLEAR).count();
            let share = (100 * clear).div_ceil(blocks.len().max(1));
            let words = match clear {
                0 => "No block differs clearly alone, but all of them together do.".to_owned(),
                _ => format!("{share} % of the blocks differ clearly."),
            };
            ("More than noise.", words)
        }
    };
    Ok(Verdict { is_equal: Some(is_equal), headline, words })
}
