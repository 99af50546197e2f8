//! Whether two pictures differ only by noise: the statistics of `weekender compare`, on a thread.

use super::Subject;
use crate::app::answers::Answers;
use crate::app::model::kept::Kept;
use crate::app::theme;
use crate::film::Film;
use crate::job::recipe::Recipe;
use crate::pictures::{self, compare};
use eframe::egui::{self, Align2, RichText, Sense, TextStyle, vec2};
use std::sync::Arc;

/// A picture to compare.
struct Picture {
    name: String,
    recipe: Recipe,
    film: Arc<Film>,
}

/// What was found.
struct Found {
    /// The verdict in a few words.
    headline: &'static str,
    is_equal: bool,
    /// The text that `weekender compare` prints.
    text: String,
}

/// The finding about two pictures, or that it is awaited.
#[derive(Default)]
pub struct Verdict {
    names: Option<[String; 2]>,
    found: Option<Result<Found, String>>,
    /// Of the last question.
    number: u64,
    answers: Answers<(u64, Result<Found, String>)>,
}

impl Verdict {
    /// Compares a kept picture with the one on the screen. `names` are those of both, in this order.
    pub fn ask(
        &mut self,
        context: &egui::Context,
        kept: &Arc<Kept>,
        subject: &Subject<'_>,
        names: [String; 2],
    ) {
        self.number += 1;
        self.found = None;
        let [first, second] = names.clone();
        self.names = Some(names);
        let kept = Picture { name: first, recipe: kept.document.recipe(), film: Arc::clone(&kept.film) };
        let (recipe, number) = (subject.document().recipe(), self.number);
        let answer = self.answers.answer_or(context, move |reason| (number, Err(reason)));
        let shared = subject.shared_film();
        // The live film goes on, so it is copied first.
        subject.inspect(move |film| {
            let copy = shared.map_or_else(|| film.try_copy().map(Arc::new), Ok);
            match copy {
                Ok(film) => {
                    let shown = Picture { name: second, recipe, film };
                    answer.give_from("compare", move || (number, found([kept, shown])));
                }
                Err(error) => answer.give((number, Err(error.to_string()))),
            }
        });
    }

    /// Takes the finding.
    pub fn receive(&mut self) {
        while let Some((number, found)) = self.answers.take() {
            if number == self.number && self.names.is_some() {
                self.found = Some(found);
            }
        }
    }

    /// Whether a finding is shown or awaited.
    pub fn is_open(&self) -> bool {
        self.names.is_some()
    }

    /// Closes the finding.
    pub fn close(&mut self) {
        (self.names, self.found) = (None, None);
    }

    /// The verdict in a few words, and the text that `weekender compare` prints, or why there is none.
    pub fn words(&self) -> Option<Result<(&str, &str), &str>> {
        self.found.as_ref().map(|found| match found {
            Ok(found) => Ok((found.headline, found.text.as_str())),
            Err(reason) => Err(reason.as_str()),
        })
    }

    /// Draws the finding.
    pub fn ui(&mut self, context: &egui::Context) {
        let Some([first, second]) = &self.names else { return };
        let (mut is_open, mut is_closed) = (true, false);
        let room = context.content_rect();
        egui::Window::new("Is it only noise?")
            .id(egui::Id::unique("verdict"))
            .open(&mut is_open)
            .pivot(Align2::CENTER_CENTER)
            .default_pos(room.center())
            .collapsible(false)
            .resizable(false)
            .show(context, |ui| {
                ui.set_width((room.width() - 60.0).min(640.0));
                ui.add(egui::Label::new(RichText::new(format!("{first}  and  {second}")).weak()).wrap());
                ui.add_space(4.0);
                match &self.found {
                    None => {
                        ui.horizontal(|ui| {
                            ui.spinner();
                            ui.label("Comparing");
                        });
                    }
                    Some(Err(reason)) => {
                        ui.add(egui::Label::new(
                            RichText::new(format!("Not compared: {reason}"))
                                .color(ui.visuals().error_fg_color),
                        ));
                    }
                    Some(Ok(found)) => {
                        let colour =
                            if found.is_equal { theme::accent(ui) } else { ui.visuals().warn_fg_color };
                        ui.label(RichText::new(found.headline).heading().color(colour));
                        ui.add_space(4.0);
                        let height = (room.height() - 240.0).max(80.0);
                        egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
                            text(ui, &found.text);
                        });
                        ui.add_space(4.0);
                        ui.horizontal(|ui| {
                            let help = "To the clipboard, as weekender compare prints it";
                            if ui.button("Copy").on_hover_text(help).clicked() {
                                context.copy_text(found.text.clone());
                            }
                            is_closed = ui.button("Close").clicked();
                        });
                    }
                }
            });
        if !is_open || is_closed {
            self.close();
        }
    }
}

/// Draws the lines of a comparison: a label, and words that may need several lines.
fn text(ui: &mut egui::Ui, text: &str) {
    const LABELS: f32 = 76.0;
    for line in text.lines() {
        let (label, words) = line.split_once(' ').unwrap_or((line, ""));
        ui.horizontal_top(|ui| {
            let size = vec2(LABELS, ui.text_style_height(&TextStyle::Body));
            let (place, _) = ui.allocate_exact_size(size, Sense::hover());
            let (font, colour) = (TextStyle::Body.resolve(ui.style()), ui.visuals().weak_text_color());
            ui.painter().text(place.min, Align2::LEFT_TOP, label, font, colour);
            ui.add(egui::Label::new(words.trim()).wrap());
        });
    }
}

fn found(pictures: [Picture; 2]) -> Result<Found, String> {
    let [first, second] = pictures.map(|Picture { name, recipe, film }| {
        pictures::Picture::of_rendered(name, recipe, film).map_err(|error| error.to_string())
    });
    let sides = [first?, second?];
    let comparison = compare::compare_sides(&sides).map_err(|error| error.to_string())?;
    let headline = match (comparison.is_equal(), comparison.is_same) {
        (true, true) => "Identical to the bit",
        (true, false) => "Only noise",
        (false, _) if comparison.unclear.is_some() => "Cannot tell",
        (false, _) => "More than noise",
    };
    Ok(Found { headline, is_equal: comparison.is_equal(), text: compare::text(&sides, &comparison) })
}

#[cfg(test)]
mod tests {
    use super::on_screen::{OnScreen, small_film};
    use crate::app::*;

    #[test]
    fn the_answer_to_an_earlier_question_is_not_shown() {
        let context = egui::Context::default();
        let mut verdict = Verdict { names: Some(Default::default()), number: 2, ..Verdict::default() };
        verdict.answers.answer(&context).give((1, Err("earlier".to_owned())));
        verdict.receive();
        assert_eq!(verdict.words(), None);
        verdict.answers.answer(&context).give((2, Err("mine".to_owned())));
        verdict.receive();
        assert_eq!(verdict.words(), Some(Err("mine")));
        verdict.close();
        verdict.answers.answer(&context).give((2, Err("late".to_owned())));
        verdict.receive();
        assert_eq!((verdict.is_open(), verdict.words()), (false, None));
    }

    #[test]
    fn a_comparison_that_cannot_be_made_is_told_of_and_not_waited_for() {
        let (screen, context) = (OnScreen::new(small_film(1, 0.5)), egui::Context::default());
        let document = screen.subject().document().clone();
        let kept = Arc::new(Kept::new(document, small_film(1, 0.5), Arc::default(), None));
        let mut verdict = Verdict::default();
        // Nobody ever asks the film.
        let asked = verdict.answers.answer_or(&context, |reason| (1, Err(reason)));
        (verdict.number, verdict.names) = (1, Some(Default::default()));
        drop(asked);
        verdict.receive();
        assert_eq!(verdict.words(), Some(Err("nothing has done it; try again")));
        verdict.ask(&context, &kept, &screen.subject(), Default::default());
        assert_eq!(verdict.answers.wait().map(|(number, _)| number), Some(2));
    }
}
