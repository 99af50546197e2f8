//! A card in a corner of the picture: what the window is, and three things to try.

use super::command::Command;
use super::corner_card::corner_card;
use super::facts::Facts;
use super::model::first_steps::{FirstSteps, Step};
use super::places::Place;
use super::theme;
use crate::stages::Stage;
use eframe::egui::{self, Button, Color32, Rect, RichText, Sense, Stroke, Ui, vec2};
use std::time::{Duration, Instant};

/// For how long the card stays when everything has been done.
const FAREWELL: Duration = Duration::from_secs(6);

/// The card.
#[derive(Default)]
pub struct Card {
    all_done: Option<Instant>,
}

impl Card {
    /// Draws the card in the upper right corner of `over`.
    pub fn ui(&mut self, ui: &Ui, over: Rect, facts: &Facts, commands: &mut Vec<Command>) {
        if !facts.model.has_first_steps {
            self.all_done = None;
            return;
        }
        let steps = &facts.model.remembered.first_steps;
        if steps.has_all() {
            let left = FAREWELL.saturating_sub(self.all_done.get_or_insert_with(Instant::now).elapsed());
            if left.is_zero() {
                commands.push(Command::FirstSteps);
                return;
            }
            ui.ctx().request_repaint_after(left);
        }
        corner_card(ui, over, Place::FirstSteps, "First steps", |ui| content(ui, steps, facts, commands));
    }
}

fn content(ui: &mut Ui, steps: &FirstSteps, facts: &Facts, commands: &mut Vec<Command>) {
    let about = "Every picture of Ray Tracing in One Weekend, rendered while you watch.";
    ui.add(egui::Label::new(about).wrap());
    ui.add_space(4.0);
    for step in Step::ALL {
        hint(ui, steps.has(step), &words(step, facts));
    }
    if steps.has_all() {
        let weak = ui.visuals().weak_text_color();
        let bye = "That is all. Help > First steps shows this again.";
        ui.add(egui::Label::new(RichText::new(bye).color(weak)).wrap());
    }
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        if let Some(first) = Stage::ALL.first().filter(|first| facts.document().stage() != Some(*first)) {
            let label = format!("Start the book at {}", first.section);
            let label = RichText::new(label).color(ui.visuals().selection.stroke.color);
            let button = Button::new(label).fill(theme::accent(ui));
            if ui.add(button).on_hover_text(first.what_is_new).clicked() {
                commands.push(Command::Stage(first));
            }
        }
        let close = ui.button("Close").on_hover_text("Escape does this too; the Help menu brings it back");
        if close.accessible_name("Close the first steps").clicked() {
            commands.push(Command::FirstSteps);
        }
    });
}

/// What to do for a step in the stage that is shown.
fn words(step: Step, facts: &Facts) -> String {
    let document = facts.document();
    // The first stages have nothing to orbit or to click.
    let later = |is_possible: bool, from: &str| {
        let section = Stage::find(from).ok().filter(|_| !is_possible).map(|stage| stage.section);
        section.map_or_else(String::new, |section| format!(" (from section {section} on)"))
    };
    let has_rays = facts.no_rays().is_none();
    match step {
        Step::Orbit => format!("Drag the picture to look from elsewhere{}", later(has_rays, "sky")),
        Step::Change => {
            let has_spheres = has_rays && !document.scene().spheres.is_empty();
            let later = later(has_spheres, "red-sphere");
            format!("Click a sphere, then drag it or change its material{later}")
        }
        Step::Leaf => "Press Page Up for the previous stage, Page Down for the next".to_owned(),
    }
}

/// A line with a tick, or the place for one.
fn hint(ui: &mut Ui, is_done: bool, text: &str) {
    const RADIUS: f32 = 7.0;
    let visuals = ui.visuals();
    let (weak, tick) = (visuals.weak_text_color(), visuals.selection.stroke.color);
    let (fill, edge, colour) = if is_done {
        (theme::accent(ui), theme::accent(ui), weak)
    } else {
        (Color32::TRANSPARENT, weak, visuals.text_color())
    };
    ui.horizontal_top(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(2.0 * RADIUS + 2.0, 2.0 * RADIUS + 2.0), Sense::hover());
        let painter = ui.painter();
        painter.circle(rect.center(), RADIUS, fill, Stroke::new(1.0, edge));
        if is_done {
            let mark = [[-3.2, 0.2], [-0.9, 2.6], [3.4, -2.8]].map(|[x, y]| rect.center() + vec2(x, y));
            painter.line(mark.to_vec(), Stroke::new(1.5, tick));
        }
        let label = ui.add(egui::Label::new(RichText::new(text).color(colour)).wrap());
        if is_done {
            // Where AccessKit keeps the text of a label.
            let done = format!("Done: {text}");
            label.ctx.accesskit_node_builder(label.id, |node| node.set_value(done));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{dressed, facts_of};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    struct Shown {
        card: Card,
        facts: Facts,
        commands: Vec<Command>,
    }

    fn shown(words: &str, over: Rect) -> Harness<'static, Shown> {
        let mut facts = facts_of(words);
        facts.model.has_first_steps = true;
        let draw = move |ui: &mut Ui, Shown { card, facts, commands }: &mut Shown| {
            card.ui(ui, over, facts, commands);
        };
        let shown = Shown { card: Card::default(), facts, commands: Vec::new() };
        let mut harness = dressed([700.0, 500.0]).build_ui_state(draw, shown);
        harness.run_steps(3);
        harness
    }

    const ROOM: Rect = Rect { min: egui::pos2(20.0, 10.0), max: egui::pos2(680.0, 490.0) };

    #[test]
    fn buttons_lead_to_the_first_stage_and_close_the_card() {
        let mut harness = shown("--stage glass-schlick", ROOM);
        let first = &Stage::ALL[0];
        harness.get_by_label(&format!("Start the book at {}", first.section)).click();
        harness.run_steps(2);
        assert_eq!(std::mem::take(&mut harness.state_mut().commands), [Command::Stage(first)]);
        harness.get_by_label("Close the first steps").click();
        harness.run_steps(2);
        assert_eq!(harness.state().commands, [Command::FirstSteps]);
        let harness = shown(&format!("--stage {}", first.id), ROOM);
        assert!(harness.query_by_label_contains("Start the book").is_none(), "it is shown already");
    }
}
