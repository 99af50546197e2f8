//! The question before the window closes while a picture is still rendered to be saved.

use super::outcome::Outcome;
use crate::app::toolkit::widgets::{hint, primary};
use eframe::egui::{Align, Layout, Ui};

/// Draws the dialog about the file of this name.
pub(super) fn ui(name: &str, ui: &mut Ui) -> Outcome {
    ui.heading("Not saved yet");
    hint(ui, &format!("The picture for {name} is still being rendered."));
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.spacing_mut().interact_size.y = 32.0;
        let saves = ui.add(primary("Save, then close")).clicked();
        let leaves = ui.button("Close without it").clicked();
        match ui.button("Cancel").clicked() {
            _ if saves || leaves => Outcome::Leave { saves },
            true => Outcome::Close,
            false => Outcome::Stay,
        }
    })
    .inner
}
