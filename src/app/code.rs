//! The lines of the tracer that are new in a stage, in a window of their own.

use super::command::Command;
use super::facts::Facts;
use crate::page::companion::{Excerpt, excerpts_between};
use crate::stages::Stage;
use eframe::egui::{self, Align2, FontId, RichText, Ui};

/// Size of the code's letters, in points.
const CODE_SIZE: f32 = 11.5;

/// The code of one stage.
#[derive(Default)]
pub struct Code {
    /// The stage whose excerpts these are.
    stage: Option<&'static Stage>,
    excerpts: Vec<Excerpt>,
}

impl Code {
    /// Draws the window.
    pub fn ui(&mut self, ui: &Ui, facts: &Facts, commands: &mut Vec<Command>) {
        let stage = facts.document().stage();
        if stage != self.stage {
            self.excerpts = stage.map(excerpts_of).unwrap_or_default();
            self.stage = stage;
        }
        let mut is_open = true;
        let title = stage.map_or("Code".to_owned(), |stage| format!("Code of {}", stage.section));
        egui::Window::new(title)
            .id(egui::Id::unique("code"))
            .open(&mut is_open)
            .pivot(Align2::CENTER_CENTER)
            .default_pos(ui.ctx().content_rect().center())
            .default_size([720.0, 440.0])
            .show(ui.ctx(), |ui| match (stage, self.excerpts.as_slice()) {
                (None, _) => _ = ui.label("This picture is not a stage of the book."),
                (Some(_), []) => {
                    _ = ui.label("This stage needs no new code: its scene and settings are new.")
                }
                (Some(_), excerpts) => {
                    egui::ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
                        excerpts.iter().for_each(|excerpt| excerpt_ui(ui, excerpt));
                    });
                }
            });
        if !is_open {
            commands.push(Command::Code);
        }
    }
}

/// The code that is new since the stage before.
fn excerpts_of(stage: &'static Stage) -> Vec<Excerpt> {
    let earlier = std::iter::successors(stage.previous(), |stage| stage.previous())
        .find(|earlier| earlier.section != stage.section);
    excerpts_between(earlier.map(|earlier| earlier.section), stage.section)
}

fn excerpt_ui(ui: &mut Ui, excerpt: &Excerpt) {
    let weak = ui.visuals().weak_text_color();
    ui.label(RichText::new(format!("{}, line {}", excerpt.file, excerpt.first)).small().color(weak));
    let code = RichText::new(excerpt.text.trim_end()).font(FontId::monospace(CODE_SIZE));
    ui.add(egui::Label::new(code).wrap_mode(egui::TextWrapMode::Extend));
    ui.add_space(10.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_of_a_stage_is_what_is_new_since_the_section_before() {
        let texts = |id: &str| {
            let excerpts = excerpts_of(Stage::find(id).unwrap());
            excerpts.iter().map(|excerpt| format!("{} {}", excerpt.file, excerpt.first)).collect::<Vec<_>>()
        };
        let [far, near] = ["view-distant", "view-close"].map(|id| Stage::find(id).unwrap());
        assert_eq!(far.section, near.section);
        assert_eq!(texts("view-distant"), texts("view-close"), "two stages of one section");
        assert!(!texts("glass-schlick").is_empty());
        let first = &Stage::ALL[0];
        let count = excerpts_between(None, first.section).len();
        assert_eq!(texts(first.id).len(), count, "nothing was there before the first stage");
    }
}
