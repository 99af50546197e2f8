//! The lines of the tracer that are new in a stage, in three languages, and what their words mean.

use super::quoted::excerpts_between;
use crate::app::commands::Snapshot;
use crate::app::panels::right::scrolling;
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{About, hint, small, switch, tip};
use crate::excerpt::Excerpt;
use crate::stages::Stage;
use eframe::egui::{Frame, Grid, Label, Margin, RichText, Sides, Ui};

/// Meanings of words in the code that are not in the book.
const WORDS: [(&str, &str); 18] = [
    ("coin", "a random number from 0 to 1"),
    ("f0", "the share that is reflected head on: 4 % for glass"),
    ("fma", "fma(a, b, c) is a · b + c, rounded only once"),
    ("mul_add", "a.mul_add(b, c) is a · b + c, rounded only once"),
    ("select", "one of two values, chosen without a branch; the condition comes last in WGSL, first in Rust"),
    ("splat", "the same number in every lane"),
    ("simd", "the level of vector instructions that the processor has"),
    ("mask", "one yes or no for each lane"),
    ("throughput", "the share of its light that a path still carries"),
    ("radiance", "the light that a path has gathered"),
    ("attenuation", "the share of light that is left after all bounces so far"),
    ("scramble", "makes other numbers of a sequence without spoiling how evenly they spread"),
    ("inverse_index", "one divided by the refraction index"),
    ("sine2", "the square of a sine"),
    ("refracted_sine2", "the square of the sine of the refracted angle: above 1 there is no such angle"),
    ("chord", "the part of a ray that is inside of the sphere"),
    ("T_MIN", "hits nearer than this do not count, so that a ray leaves the sphere that it starts on"),
    ("HUGE_VAL", "infinity, in C"),
];

/// The languages by the endings of their files.
const LANGUAGES: [(&str, &str, &str); 3] = [
    ("c", "C", "The book\u{2019}s program in plain C, one ray at a time"),
    ("wgsl", "WGSL", "The program of the graphics card; reads much like the book\u{2019}s C++"),
    ("rs", "Rust", "The program of the processor, for many lanes at once"),
];

/// The code of one stage.
#[derive(Default)]
pub struct Code {
    /// The stage whose excerpts these are.
    stage: Option<&'static Stage>,
    excerpts: Vec<Excerpt>,
    /// The chosen language.
    language: Option<&'static str>,
}

impl Code {
    pub fn ui(&mut self, ui: &mut Ui, snapshot: &Snapshot) {
        let stage = snapshot.document().stage();
        if stage != self.stage {
            self.excerpts = stage.map(excerpts_of).unwrap_or_default();
            self.stage = stage;
        }
        scrolling(ui, |ui| match stage {
            None => _ = hint(ui, "This picture is not a stage of the book, so there is no code to show."),
            Some(_) if self.excerpts.is_empty() => {
                _ = hint(ui, "This stage needs no new code: only its scene and settings are new.");
            }
            Some(stage) => self.stage_ui(ui, stage),
        });
    }

    fn stage_ui(&mut self, ui: &mut Ui, stage: &Stage) {
        let is_there = |(ending, ..): &(&str, &str, &str)| {
            self.excerpts.iter().any(|excerpt| excerpt.language() == *ending)
        };
        let there = LANGUAGES.into_iter().filter(is_there);
        let options: Vec<_> = there.map(|(ending, name, help)| (ending, About::new(name, help))).collect();
        let chosen = options.iter().find(|(ending, _)| Some(*ending) == self.language);
        let mut shown = chosen.unwrap_or(&options[0]).0;
        Sides::new().height(24.0).show(
            ui,
            |ui| ui.label(RichText::new(format!("New in {}", stage.section)).strong()),
            |ui| {
                if let Some(chosen) = switch(ui, 48.0, shown, &options) {
                    (self.language, shown) = (Some(chosen), chosen);
                }
            },
        );
        let excerpts = || self.excerpts.iter().filter(|excerpt| excerpt.language() == shown);
        excerpts().for_each(|excerpt| excerpt_ui(ui, excerpt));
        words_ui(ui, excerpts());
    }
}

/// The code that is new since the stage before, or else that of the chapter.
fn excerpts_of(stage: &'static Stage) -> Vec<Excerpt> {
    let earlier = std::iter::successors(stage.previous(), |stage| stage.previous())
        .find(|earlier| earlier.section != stage.section);
    let new = excerpts_between(earlier.map(|earlier| earlier.section), stage.section);
    if new.is_empty() { excerpts_between(None, stage.section) } else { new }
}

fn words_ui<'a>(ui: &mut Ui, excerpts: impl Iterator<Item = &'a Excerpt>) {
    let texts: Vec<&str> = excerpts.map(|excerpt| excerpt.text.as_str()).collect();
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let is_used = |(name, _): &&(&str, &str)| {
        texts.iter().any(|text| text.split(|c| !is_word(c)).any(|word| word == *name))
    };
    let used: Vec<_> = WORDS.iter().filter(is_used).collect();
    if used.is_empty() {
        return;
    }
    let colours = theme::colours(ui);
    ui.add_space(4.0);
    small(ui, "Words");
    let width = ui.available_width() - 120.0;
    Grid::new("words").num_columns(2).min_col_width(104.0).spacing([8.0, 4.0]).show(ui, |ui| {
        for (name, meaning) in used {
            ui.label(RichText::new(*name).color(colours.strong));
            ui.scope(|ui| {
                ui.set_max_width(width);
                ui.add(Label::new(*meaning).wrap());
            });
            ui.end_row();
        }
    });
}

fn excerpt_ui(ui: &mut Ui, excerpt: &Excerpt) {
    let colours = theme::colours(ui);
    let place = format!("{}, line {}", excerpt.file, excerpt.first);
    Sides::new().shrink_left().truncate().show(
        ui,
        |ui| small(ui, place),
        |ui| {
            let copy = ui.link(RichText::new("Copy").small());
            if tip(ui, copy, "Copies these lines", None).clicked() {
                ui.copy_text(excerpt.text.clone());
            }
        },
    );
    let well = Frame::new().fill(colours.well).stroke(ui.visuals().window_stroke).corner_radius(4);
    well.inner_margin(Margin::same(8)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.add(Label::new(RichText::new(excerpt.text.trim_end()).monospace().line_height(Some(18.0))).wrap());
    });
}
