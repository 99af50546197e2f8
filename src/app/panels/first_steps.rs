//! The card under the picture: what the window is, and three things to try.

use crate::app::commands::{Command, PanelContext};
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{command_button, primary, sign_button, tip};
use crate::stages::Stage;
use eframe::egui::{self, Frame, Label, Margin, RichText, Role, Sides, Stroke, Ui, WidgetInfo, vec2};

/// Narrower cards are higher, points.
const WIDE: f32 = 620.0;

const STEPS: [&str; 3] = [
    "Drag the picture to look around it. Home returns.",
    "Click a sphere, then drag it or change its material.",
    "Page Up and Page Down turn the pages of the book.",
];

/// Draws the card, if it is shown, at the bottom of `ui`.
pub fn ui(ui: &mut Ui, cx: &PanelContext) {
    if !cx.model.has_first_steps {
        return;
    }
    let is_wide = ui.available_width() >= WIDE;
    let height = if is_wide { 148.0 } else { 176.0 };
    if ui.available_height() < 2.0 * height {
        // The picture comes first.
        return;
    }
    let around = Frame::new()
        .fill(theme::colours(ui).surround)
        .inner_margin(Margin { bottom: 8, ..Margin::symmetric(8, 0) });
    let card = Frame::new()
        .fill(theme::colours(ui).panel)
        .stroke(Stroke::new(1.0, theme::colours(ui).line))
        .corner_radius(8)
        .inner_margin(15);
    let panel = egui::Panel::bottom("first steps").exact_size(height).show_separator_line(false);
    panel.frame(around).show(ui, |ui| {
        card.show(ui, |ui| {
            ui.set_min_size(ui.available_size());
            content(ui, is_wide, cx);
        });
    });
}

fn content(ui: &mut Ui, is_wide: bool, cx: &PanelContext) {
    Sides::new().height(20.0).shrink_left().truncate().show(
        ui,
        |ui| {
            ui.label(RichText::new("First steps").size(16.0).strong());
            if is_wide {
                ui.weak("Every picture of Ray Tracing in One Weekend, rendered while you watch.");
            }
        },
        |ui| {
            let close = sign_button(ui, "×", 20.0, "Close first steps");
            if tip(ui, close, "Help > First steps brings this back", None).clicked() {
                cx.send(Command::FirstSteps);
            }
        },
    );
    ui.columns(STEPS.len(), |uis| {
        uis.iter_mut().enumerate().for_each(|(number, ui)| step(ui, number, cx.model.steps_done[number]));
    });
    ui.horizontal(|ui| {
        if let Some(first) = Stage::ALL.first().filter(|first| cx.document().stage() != Some(first)) {
            let response = ui.add(primary(format!("Start the book at {}", first.section)));
            if tip(ui, response, first.what_is_new, None).clicked() {
                cx.send(Command::Stage(first));
            }
        }
        command_button(ui, cx, Command::CheckPicture, "Check my picture…");
    });
}

/// A step behind its number, or behind a tick once it was done.
fn step(ui: &mut Ui, number: usize, is_done: bool) {
    ui.horizontal_top(|ui| {
        let text = |text: RichText| Label::new(text.line_height(Some(20.0))).wrap();
        let accent = theme::colours(ui).accent;
        let number_ui = ui.add(text(RichText::new((number + 1).to_string()).strong().color(accent)));
        if is_done {
            let (at, stroke) = (number_ui.rect.center(), Stroke::new(2.0, theme::colours(ui).good));
            ui.painter().rect_filled(number_ui.rect, 0.0, theme::colours(ui).panel);
            let tick = [vec2(-5.0, 0.0), vec2(-1.0, 4.0), vec2(5.0, -5.0)].map(|to| at + to);
            ui.painter().line(tick.to_vec(), stroke);
            number_ui.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{}, done", number + 1)));
        }
        ui.add(text(RichText::new(STEPS[number])));
    });
}
