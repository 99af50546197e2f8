//! Controls for saving the picture.

use crate::app::command::Command;
use crate::output::OutputFormat;
use eframe::egui::{self, Ui};

pub(super) fn ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (name, command) in [
            ("PNG", Command::Save(OutputFormat::Png)),
            ("PPM", Command::Save(OutputFormat::P6)),
            ("EXR film", Command::Save(OutputFormat::Exr)),
            ("Scene", Command::SaveScene),
        ] {
            let response = ui.button(name).on_hover_text(command.help());
            if response.accessible_name(format!("Save {name}")).clicked() {
                commands.push(command);
            }
        }
    });
    let command = Command::CopyCommand;
    let width = ui.available_width();
    let button = egui::Button::new(command.name()).min_size(egui::vec2(width, 0.0));
    if ui.add(button).on_hover_text(command.help()).clicked() {
        commands.push(command);
    }
}
