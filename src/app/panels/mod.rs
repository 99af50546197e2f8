//! The left panel, with one file for each group of controls.

mod camera;
mod lens;
mod output;
mod render;
mod reset;
mod spheres;
mod stop;

use super::command::Command;
use super::facts::Facts;
use super::model::document::Document;
use super::model::edit::Edit;
use super::model::remembered::Remembered;
use super::spheres::Selected;
use super::tips::{self, Side};
use eframe::egui::{self, RichText, Ui};
use reset::Reset;

/// Draws the groups. For a new user those about rendering are folded at first.
pub fn ui(
    ui: &mut Ui,
    (document, selected): (&mut Document, Option<&Selected>),
    remembered: &mut Remembered,
    (facts, is_new): (&Facts, bool),
    (edits, commands): (&mut Vec<Edit>, &mut Vec<Command>),
) {
    if let Some(reason) = &facts.invalid {
        let text = RichText::new(reason).color(ui.visuals().error_fg_color);
        ui.add(egui::Label::new(text).wrap());
        ui.add_space(4.0);
    }
    group(ui, ("Spheres", true), Some(&spheres::RESET), document, |ui, _| {
        spheres::ui(ui, selected, facts, edits, commands);
    });
    group(ui, ("Camera", true), Some(&camera::RESET), document, |ui, document| {
        camera::ui(ui, &mut document.camera, facts);
    });
    group(ui, ("Lens", true), Some(&lens::RESET), document, |ui, document| {
        lens::ui(ui, &mut document.camera, facts);
    });
    group(ui, ("Render", !is_new), Some(&render::RESET), document, |ui, document| {
        render::ui(ui, &mut document.settings, remembered, facts);
    });
    group(ui, ("Stop", !is_new), Some(&stop::RESET), document, |ui, document| {
        stop::ui(ui, &mut document.stop, facts);
    });
    group(ui, ("Output", !is_new), Some(&output::RESET), document, |ui, document| {
        output::ui(ui, document, facts, commands);
    });
}

/// A collapsible group of controls, at first open or folded. `reset` is `None` if the stage has no values for the group.
fn group(
    ui: &mut Ui,
    (name, is_open): (&str, bool),
    reset: Option<&Reset>,
    document: &mut Document,
    body: impl FnOnce(&mut Ui, &mut Document),
) {
    let id = ui.make_persistent_id(("group", name));
    let state = egui::collapsing_header::CollapsingState::load_with_default_open(ui.ctx(), id, is_open);
    let mut is_pressed = false;
    let mut header = state.show_header(ui, |ui| {
        is_pressed = heading(ui, name, id);
        let Some(Reset { is_changed, reset }) = reset else { return };
        let is_changed = is_changed(document);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let button = ui.add_enabled(is_changed, egui::Button::new("Reset").small());
            let (help, reason) = ("Reset to the stage's values", "Nothing here differs from the stage");
            let button = tips::explain(ui, button, Side::Beside, help, Some(reason))
                .accessible_name(format!("Reset {}", name.to_lowercase()));
            if button.clicked() {
                reset(document);
            }
        });
    });
    if is_pressed {
        header.toggle();
    }
    header.body_unindented(|ui| {
        ui.add_space(2.0);
        body(ui, document);
    });
    ui.add_space(6.0);
}

/// The name of a group. Returns whether it was clicked, or the place beside it, which folds the group as its triangle does.
fn heading(ui: &mut Ui, name: &str, id: egui::Id) -> bool {
    let label = ui.add(egui::Label::new(RichText::new(name).strong()).selectable(false)).rect;
    let half = 0.5 * ui.spacing().interact_size.y;
    let (middle, right) = (label.center().y, ui.max_rect().right());
    let row = egui::Rect::from_x_y_ranges(label.left()..=right, middle - half..=middle + half);
    // The Tab key leads to the triangle.
    let response = ui.interact(row, id.with("heading"), egui::Sense::CLICK);
    response.on_hover_cursor(egui::CursorIcon::PointingHand).clicked()
}
