//! The panel at the left: one file a group of controls.

mod camera;
mod lens;
mod output;
mod render;
mod stop;

use super::window::Window;
use eframe::egui::{self, RichText, Ui};

/// A group of controls.
struct Group {
    name: &'static str,
    /// Draws it.
    ui: fn(&mut Window, &mut Ui),
    /// How it is made as the stage has it, if a stage has anything to say in it.
    reset: Option<Reset>,
}

/// How a group is made as the stage has it.
struct Reset {
    /// Whether anything in it differs from the stage.
    is_changed: fn(&Window) -> bool,
    reset: fn(&mut Window),
}

const GROUPS: [Group; 5] = [camera::GROUP, lens::GROUP, render::GROUP, stop::GROUP, output::GROUP];

pub fn ui(window: &mut Window, ui: &mut Ui) {
    if let Some(reason) = window.invalid.clone() {
        let text = RichText::new(reason).color(ui.visuals().error_fg_color);
        ui.add(egui::Label::new(text).wrap());
        ui.add_space(4.0);
    }
    for group in &GROUPS {
        let id = ui.make_persistent_id(("group", group.name));
        let state = egui::collapsing_header::CollapsingState::load_with_default_open(ui.ctx(), id, true);
        state
            .show_header(ui, |ui| {
                ui.label(RichText::new(group.name).strong());
                let Some(Reset { is_changed, reset }) = &group.reset else { return };
                let is_changed = is_changed(window);
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    let button = ui
                        .add_enabled(is_changed, egui::Button::new("Reset").small())
                        .on_hover_text("As the stage has it")
                        .on_disabled_hover_text("Nothing here differs from the stage")
                        .accessible_name(format!("Reset {}", group.name.to_lowercase()));
                    if button.clicked() {
                        reset(window);
                    }
                });
            })
            .body_unindented(|ui| {
                ui.add_space(2.0);
                (group.ui)(window, ui);
            });
        ui.add_space(6.0);
    }
}
